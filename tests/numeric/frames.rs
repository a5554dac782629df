//! Sequences of frames: identities of points, of sums and of reprojection, and the spectrum of the
//! mask.

use crate::gbuffer_twin::gbuffer;
use glam::{DMat3, DVec2, DVec3};
use splitsum::base::math::blue_noise::{DEPTH, SIDE, value};
use splitsum::base::math::sequence::{FramePoints, R2_OF_FRAMES, frame_shift, hash, shifted};
use splitsum::base::pixels::Pixels;
use splitsum::instrument::gbuffer::Surfaces;
use splitsum::instrument::pipeline::reprojection::{Sums, View};
use splitsum::instrument::scene::{Camera, CameraKind, Orbit, Projection, Scene};
use splitsum::instrument::shade::frames::{Accumulation, Frames, History};
use std::f64::consts::TAU;
use std::sync::Arc;

fn view(
    camera: Camera,
    size: [u32; 2],
    surface: impl Fn(u32, u32) -> Option<[DVec3; 2]>,
    turn: DMat3,
) -> Arc<View> {
    let texels = |index: usize| {
        Pixels::from_fn(size[0], size[1], |x, y| {
            surface(x, y).map_or([0.0; 4], |vectors| {
                vectors[index].extend(1.0).as_vec4().to_array()
            })
        })
    };
    let surfaces = Surfaces {
        position_mask: texels(0),
        normal_alpha: texels(1),
    };
    Arc::new(View {
        camera,
        environment_from_world: turn,
        surfaces: Arc::new(surfaces),
    })
}

fn plane(yaw_deg: f64, size: [u32; 2]) -> Arc<View> {
    let camera = Camera {
        eye: DVec3::Z * 4.0,
        right: DVec3::X,
        up: DVec3::Y,
        forward: DVec3::NEG_Z,
        projection: Projection::Ortho { half_height: 1.0 },
        near: 1.0,
        far: 8.0,
    };
    let camera = camera.orbited(
        Orbit {
            yaw_deg,
            ..Orbit::default()
        },
        &Scene::sphere(),
    );
    let surface = |x: u32, y: u32| {
        let (origin, ray) = camera.ray(x, y, size);
        Some([origin - ray * (origin.z / ray.z), DVec3::Z])
    };
    view(camera, size, surface, DMat3::IDENTITY)
}

fn white(pixel: usize, frame: usize) -> f64 {
    f64::from(hash(pixel as u32 ^ hash(frame as u32 + 1))) / 2f64.powi(32)
}

#[test]
fn frames_of_r2_are_the_parts_of_one_set_and_their_mean_is_its_estimate() {
    let integrand = |p: DVec2| (3.0 * p.x).sin() * p.y + 1.0 / (0.1 + p.x);
    let of = |frame: u32, i: u32, samples: u32| {
        let shift = frame_shift(FramePoints::R2, [5, 9], frame, samples, 3);
        shifted((R2_OF_FRAMES.point)(i, 0, 0), shift)
    };
    let view = plane(0.0, [1, 1]);
    for (frames, samples) in [(64, 1), (16, 4), (32, 2)] {
        let whole: Vec<DVec2> = (0..frames * samples)
            .map(|i| of(0, i, frames * samples))
            .collect();
        let parts = (0..frames).flat_map(|frame| (0..samples).map(move |i| of(frame, i, samples)));
        assert_eq!(parts.collect::<Vec<_>>(), whole);
        let mean = |points: &[DVec2]| {
            points.iter().map(|p| integrand(*p)).sum::<f64>() / points.len() as f64
        };
        let mut sums = None;
        for part in whole.chunks(samples as usize) {
            sums = Some(Sums::added(
                sums.as_ref(),
                &Frames::default(),
                &view,
                &[DVec3::splat(mean(part))],
            ));
        }
        let (own, exact) = (sums.unwrap().means().next().unwrap().x, mean(&whole));
        // Frames of one sample add up in the order of the set.
        let allowed = if samples == 1 { 0.0 } else { 1e-15 * exact };
        assert!(
            (own - exact).abs() <= allowed,
            "{frames} frames of {samples}: {own} for {exact}"
        );
    }
}

/// White noise, 512 frames: the variance over pixels is 1/k or a/(2 - a) of one frame's, within
/// four of its standard errors.
#[test]
fn the_mean_and_the_moving_average_have_their_variances() {
    let view = plane(0.0, [64, 64]);
    let average = Frames {
        accumulation: Accumulation::Ema,
        ema_factor: 0.1,
        ..Frames::default()
    };
    for (frames, exact) in [(Frames::default(), 1.0 / 512.0), (average, 0.1 / 1.9)] {
        let mut sums = None;
        for frame in 0..512 {
            let signal: Vec<DVec3> = (0..4096)
                .map(|pixel| DVec3::splat(white(pixel, frame)))
                .collect();
            sums = Some(Sums::added(sums.as_ref(), &frames, &view, &signal));
        }
        let variance = sums
            .unwrap()
            .means()
            .map(|mean| (mean.x - 0.5).powi(2))
            .sum::<f64>()
            / 4096.0;
        let ratio = 12.0 * variance / exact;
        assert!(
            (ratio - 1.0).abs() < 4.0 * (2.0 / 4096f64).sqrt(),
            "{:?}: {ratio}",
            frames.accumulation
        );
    }
}

/// A signal that is linear in the position is linear in the image, so bilinear lookups find it
/// again.
#[test]
fn reprojection_is_the_identity_of_a_still_view_and_exact_on_a_plane() {
    let size = [48, 40];
    let linear = |view: &View| -> Vec<DVec3> {
        let positions = view
            .surfaces
            .position_mask
            .data
            .iter()
            .map(|&[x, y, ..]| DVec2::new(x.into(), y.into()));
        positions
            .map(|p| DVec3::new(2.0 + p.x, 3.0 - p.y, 1.0 + 0.5 * p.x + 0.25 * p.y))
            .collect()
    };
    let (before, after) = (plane(0.0, size), plane(20.0, size));
    let frames = Frames::default();
    let first = Sums::added(None, &frames, &before, &linear(&before));
    let still = Sums::added(Some(&first), &frames, &before, &vec![DVec3::ZERO; 48 * 40]);
    assert!(
        still
            .means()
            .zip(linear(&before))
            .all(|(mean, own)| mean == 0.5 * own)
    );
    let moved = Sums::added(Some(&first), &frames, &after, &linear(&after));
    let without = Sums::added(Some(&first), &frames, &after, &vec![DVec3::ZERO; 48 * 40]);
    // The view before had all pixels around these places.
    let is_inner = |i: &usize| (4..44).contains(&(i % 48)) && (1..39).contains(&(i / 48));
    let [moved, without]: [Vec<DVec3>; 2] = [&moved, &without].map(|sums| sums.means().collect());
    let own = linear(&after);
    for i in (0..48 * 40).filter(is_inner) {
        assert!(
            (moved[i] - own[i]).abs().max_element() < 1e-5,
            "{} for {}",
            moved[i],
            own[i]
        );
        assert!(
            (without[i] - 0.5 * own[i]).abs().max_element() < 1e-5,
            "{} for half of {}",
            without[i],
            own[i]
        );
    }
}

/// A pixel whose surface the frame before did not see has no history.
#[test]
fn a_surface_that_appears_has_no_history() {
    let size = [8, 8];
    let near = plane(0.0, size);
    let far = view(
        near.camera,
        size,
        |x, y| Some([near.camera.ray(x, y, size).0 - 5.0 * DVec3::Z, DVec3::Z]),
        DMat3::IDENTITY,
    );
    let camera = Camera {
        far: 9.0,
        ..near.camera
    };
    let seen = view(
        camera,
        size,
        |x, y| Some([near.camera.ray(x, y, size).0 - 4.0 * DVec3::Z, DVec3::Z]),
        DMat3::IDENTITY,
    );
    let frames = Frames::default();
    let first = Sums::added(None, &frames, &far, &[DVec3::splat(7.0); 64]);
    let second = Sums::added(Some(&first), &frames, &seen, &[DVec3::ONE; 64]);
    assert!(second.means().all(|mean| mean == DVec3::ONE));
}

#[test]
fn clamping_keeps_the_history_within_the_neighbours_of_the_frame() {
    let (size, frames) = (
        [8, 8],
        Frames {
            history: History::Clamp,
            ..Frames::default()
        },
    );
    let view = plane(0.0, size);
    let first = Sums::added(None, &frames, &view, &[DVec3::splat(9.0); 64]);
    let signal: Vec<DVec3> = (0..64)
        .map(|pixel| DVec3::splat(if pixel == 27 { 3.0 } else { 1.0 }))
        .collect();
    let means: Vec<f64> = Sums::added(Some(&first), &frames, &view, &signal)
        .means()
        .map(|mean| mean.x)
        .collect();
    // At the bright pixel 3 and 3, beside it 1 and 3, elsewhere 1 and 1.
    assert_eq!(
        [means[27], means[18], means[36], means[0]],
        [3.0, 2.0, 2.0, 1.0]
    );
}

/// On a sphere under a light that turns, the history of a reflection has the light of that
/// reflection.
#[test]
fn reflected_history_is_found_where_the_same_light_was_reflected() {
    let (size, scene) = ([64, 64], Scene::sphere());
    let camera = Camera::for_scene(CameraKind::Ortho, &scene, size);
    let seen = |turn_deg: f64| {
        let turn = DMat3::from_rotation_y(turn_deg.to_radians());
        let texels = gbuffer(&scene, &camera, size);
        let surface = |x, y| {
            let [px, py, pz, mask] = texels.position_mask.get(x, y);
            let [nx, ny, nz, _] = texels.normal_alpha.get(x, y);
            (mask == 1.0).then(|| [DVec3::new(px, py, pz), DVec3::new(nx, ny, nz)])
        };
        let light = |x: u32, y: u32| {
            surface(x, y).map_or(DVec3::ZERO, |[p, n]| {
                let v = camera.v_at(p);
                DVec3::ONE + turn * (2.0 * n.dot(v) * n - v)
            })
        };
        let signal: Vec<DVec3> = (0..64 * 64).map(|i| light(i % 64, i / 64)).collect();
        (view(camera, size, surface, turn), signal)
    };
    let [(before, old), (after, new)] = [0.0, 5.0].map(seen);
    let error = |history: History| {
        let frames = Frames {
            history,
            ..Frames::default()
        };
        let first = Sums::added(None, &frames, &before, &old);
        let second = Sums::added(Some(&first), &frames, &after, &new);
        // Away from the rim, where the reflection lies off the image.
        let inner = (0..64 * 64).filter(|i| {
            DVec2::new((i % 64) as f64, (i / 64) as f64).distance(DVec2::splat(31.5)) < 24.0
        });
        let means: Vec<DVec3> = second.means().collect();
        inner
            .map(|i| (means[i] - new[i]).abs().max_element())
            .fold(0.0, f64::max)
    };
    let [plain, reflected] = [History::Plain, History::Reflected].map(error);
    assert!(plain > 0.04 && reflected < 2e-3, "{plain}, {reflected}");
}

/// Power over white noise's at the frequencies that a filter of a few pixels, or a few frames, lets
/// through.
#[test]
fn the_mask_is_blue_in_space_and_in_time() {
    let mut values: Vec<f64> = (0..SIDE * SIDE * DEPTH)
        .map(|i| {
            value(
                [(i % SIDE) as u32, (i / SIDE % SIDE) as u32],
                (i / SIDE / SIDE) as u32,
            )
        })
        .collect();
    let power = |of: &dyn Fn(usize) -> f64, phase: &dyn Fn(usize) -> f64, count: usize| {
        let (sin, cos) = (0..count).fold((0.0, 0.0), |(sin, cos), i| {
            let (s, c) = (TAU * phase(i)).sin_cos();
            (sin + s * (of(i) - 0.5), cos + c * (of(i) - 0.5))
        });
        12.0 * (sin * sin + cos * cos) / count as f64
    };
    let mean = |powers: Vec<f64>| powers.iter().sum::<f64>() / powers.len() as f64;
    let low = (0..=8)
        .flat_map(|u: i32| (-8..=8).map(move |v: i32| (u, v)))
        .filter(|(u, v)| (1..=64).contains(&(u * u + v * v)));
    let space = low.step_by(5).map(|(u, v)| {
        let phase = |i: usize| {
            (f64::from(u) * (i % SIDE) as f64 + f64::from(v) * (i / SIDE) as f64) / SIDE as f64
        };
        power(
            &|i| value([(i % SIDE) as u32, (i / SIDE) as u32], 7),
            &phase,
            SIDE * SIDE,
        )
    });
    let time = (0..256u32)
        .flat_map(|pixel| [1.0, 2.0, 3.0].map(|u| (pixel, u)))
        .map(|(pixel, u)| {
            power(
                &|i| value([pixel % 64, 16 * (pixel / 64)], i as u32),
                &|i| u * i as f64 / DEPTH as f64,
                DEPTH,
            )
        });
    let [space, time] = [mean(space.collect()), mean(time.collect())];
    assert!(space < 0.02 && time < 0.1, "space {space}, time {time}");
    let shift = |point_set| frame_shift(FramePoints::Blue, [5, 9], 2, 4, point_set);
    assert_ne!(shift(0), shift(1), "sets differ");
    // The mask repeats: its last frame is followed by the first.
    let together = |frame: usize| {
        let is_in = |i: usize, frame: usize| values[frame % DEPTH * SIDE * SIDE + i] < 0.3;
        (0..SIDE * SIDE)
            .filter(|i| is_in(*i, frame) && is_in(*i, frame + 1))
            .count()
    };
    let most = (0..DEPTH - 1).map(together).max().unwrap();
    assert!(
        together(DEPTH - 1) <= most,
        "{} against {most}",
        together(DEPTH - 1)
    );
    values.sort_by(f64::total_cmp);
    let count = values.len() as f64;
    assert!(
        values
            .iter()
            .enumerate()
            .all(|(rank, own)| *own == (rank as f64 + 0.5) / count),
        "each rank once"
    );
}
