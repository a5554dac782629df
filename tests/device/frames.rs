//! Sequences of frames on the device: sums of parts, convergence, and what motion and options may
//! change.

use crate::harness::{golden_environment, lobe_sphere, render_by_seeds, request, with_pipeline};
use crate::symmetry::smooth_environment;
use glam::DVec3;
use splitsum::base::math::sequence::{FramePoints, PixelPoints};
use splitsum::base::names::Listed;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::environment::Environment;
use splitsum::instrument::environment::layout::LAYOUTS;
use splitsum::instrument::metrics::tone_mapped_curve;
use splitsum::instrument::pipeline::{Frame, Pipeline, RenderRequest};
use splitsum::instrument::scene::{CameraKind, Orbit};
use splitsum::instrument::shade::frames::{Accumulation, Frames, History, Motion};
use splitsum::instrument::shade::{Method, Shading};
use std::sync::Arc;

/// Frames of one visible-normal sample each on a sphere.
fn sequence(size: u32, frames: Frames) -> RenderRequest {
    let plain = request(
        &golden_environment(),
        lobe_sphere(0.3),
        CameraKind::Ortho,
        [size; 2],
    );
    plain.shaded(|s| (s.method, s.samples, s.frames) = (Method::listed("sampled-vndf"), 1, frames))
}

/// Largest difference over the mean, and root mean square difference over the mean.
fn apart(a: &Frame, b: &Frame) -> [f64; 2] {
    images_apart(&a.radiance, &b.radiance)
}

fn images_apart(a: &RgbImage, b: &RgbImage) -> [f64; 2] {
    let texels = || a.data.iter().flatten().zip(b.data.iter().flatten());
    let mean = texels().map(|(_, b)| f64::from(*b)).sum::<f64>() / texels().count() as f64;
    let difference = || texels().map(|(a, b)| f64::from(a - b).abs() / mean);
    let square = difference().map(|d| d * d).sum::<f64>() / texels().count() as f64;
    [difference().fold(0.0, f64::max), square.sqrt()]
}

/// Mean square difference that motion makes in the frames without noise.
fn lag(pipeline: &mut Pipeline, request: &RenderRequest) -> f64 {
    let [own, still] = [request.shading.frames.motion, Motion::Still].map(|motion| {
        pipeline
            .render(&request.shaded(|s| s.frames.motion = motion))
            .unwrap()
            .steadiness
            .unwrap()
    });
    images_apart(&own.without_noise, &still.without_noise)[1].powi(2)
}

#[test]
fn the_mean_over_frames_of_r2_is_one_image_of_all_their_samples() {
    with_pipeline(|pipeline| {
        for (method, samples) in [
            ("sampled-vndf", 1),
            ("sampled", 4),
            ("sampled-unfiltered", 2),
        ] {
            let frames = Frames {
                count: 16,
                points: FramePoints::R2,
                ..Frames::default()
            };
            let change = |s: &mut Shading| {
                (s.method, s.samples, s.point_set) = (Method::listed(method), samples, 2)
            };
            let own = sequence(24, frames).shaded(change);
            // In this layout a texel has one solid angle, so a bias makes samples as wide as in the
            // whole.
            let own = own.shaded(|s| s.precompute.layout = &LAYOUTS[1]);
            let added = pipeline.render(&own.shaded(|s| s.lod_bias = -2.0)).unwrap();
            let whole = pipeline
                .render(&own.shaded(|s| (s.samples, s.frame) = (16 * samples, Some(0))))
                .unwrap();
            assert!(
                apart(&added, &whole)[0] < 2e-5,
                "{method}: {:?}",
                apart(&added, &whole)
            );
        }
    });
}

#[test]
fn the_first_frame_of_white_points_is_an_image_with_scrambled_points() {
    with_pipeline(|pipeline| {
        let own = sequence(
            16,
            Frames {
                count: 4,
                ..Frames::default()
            },
        );
        let first = pipeline.render(&own.of_frame(0)).unwrap();
        let alone =
            own.shaded(|s| (s.frames, s.pixel_points) = (Frames::default(), PixelPoints::Owen));
        assert_eq!(first.radiance, pipeline.render(&alone).unwrap().radiance);
        assert!(first.steadiness.is_none());
    });
}

/// The squared error against the reference falls as 1/k, so nothing but noise is left, however many
/// frames. Blue noise and R2 err less.
#[test]
fn the_squared_error_of_the_mean_falls_as_one_over_the_frames() {
    with_pipeline(|pipeline| {
        let smooth = request(
            &smooth_environment(),
            lobe_sphere(0.5),
            CameraKind::Ortho,
            [48; 2],
        );
        let own = smooth.shaded(|s| {
            (s.method, s.samples, s.lod_bias) = (Method::listed("sampled-vndf"), 1, -16.0)
        });
        let exact = own.shaded(|s| s.method = Method::listed("reference"));
        let exact = render_by_seeds(
            pipeline,
            &RenderRequest {
                reference_samples: 65536,
                ..exact
            },
        );
        let mut error = |count, points| {
            let frames = Frames {
                count,
                points,
                ..Frames::default()
            };
            apart(
                &pipeline.render(&own.shaded(|s| s.frames = frames)).unwrap(),
                &exact,
            )[1]
        };
        let counts = [4, 16, 64, 256];
        let logs = counts.map(|count| {
            [
                f64::from(count).ln(),
                2.0 * error(count, FramePoints::Owen).ln(),
            ]
        });
        let mean = |of: &dyn Fn(&[f64; 2]) -> f64| logs.iter().map(of).sum::<f64>() / 4.0;
        let (x, y) = (mean(&|log| log[0]), mean(&|log| log[1]));
        let slope = mean(&|log| (log[0] - x) * (log[1] - y)) / mean(&|log| (log[0] - x).powi(2));
        assert!((slope + 1.0).abs() < 0.05, "{slope}");
        let [white, r2, blue] = FramePoints::all()
            .map(|points| error(32, *points))
            .collect::<Vec<_>>()
            .try_into()
            .unwrap();
        assert!(
            r2 < 0.7 * white && blue < 0.9 * white,
            "{white}, {r2}, {blue}"
        );
    });
}

/// A sphere looks the same from everywhere, so a turn of camera and light as one changes nothing
/// but rounding.
#[test]
fn turning_light_and_camera_together_changes_no_sequence() {
    with_pipeline(|pipeline| {
        for motion in Motion::all() {
            let frames = Frames {
                count: 5,
                motion: *motion,
                motion_deg: 3.0,
                ..Frames::default()
            };
            let own = sequence(
                32,
                Frames {
                    accumulation: Accumulation::Ema,
                    ..frames
                },
            );
            let turned = own.shaded(|s| s.placement.rotation_deg += 90.0);
            let orbit = Orbit {
                yaw_deg: 90.0,
                ..Orbit::default()
            };
            let turned = RenderRequest {
                camera: own.camera.orbited(orbit, &own.scene),
                ..turned
            };
            let [a, b] = [&own, &turned].map(|request| pipeline.render(request).unwrap());
            assert!(apart(&a, &b)[1] < 2e-3, "{motion:?}: {:?}", apart(&a, &b));
            let [a, b] = [&own, &turned].map(|request| lag(pipeline, request));
            assert!((a - b).abs() <= 0.02 * a, "{motion:?}: {a}, {b}");
            assert_eq!(a > 0.0, *motion != Motion::Still, "{motion:?}: {a}");
        }
    });
}

/// Subtracting what does not change, or dividing by it, and undoing it afterwards.
#[test]
fn options_change_nothing_in_a_still_mean_but_the_clamp() {
    with_pipeline(|pipeline| {
        let mut of = |history| {
            pipeline
                .render(&sequence(
                    24,
                    Frames {
                        count: 8,
                        history,
                        ..Frames::default()
                    },
                ))
                .unwrap()
        };
        let plain = of(History::Plain);
        for history in History::all().filter(|history| **history != History::Clamp) {
            // A sum below the split sum is 0 in the worst case; none is here.
            assert!(apart(&of(*history), &plain)[0] < 1e-5, "{history:?}");
        }
        assert!(apart(&of(History::Clamp), &plain)[0] > 1e-3);
    });
}

/// A light that turns: reflections lag less than surfaces. So does the difference from the split
/// sum where that is good, in smooth light.
#[test]
fn control_variates_and_reflections_lag_less() {
    with_pipeline(|pipeline| {
        let frames = Frames {
            count: 16,
            motion: Motion::Light,
            motion_deg: 2.0,
            ..Frames::default()
        };
        let mut lag = |history, environment: &Arc<Environment>| {
            let own = sequence(32, Frames { history, ..frames });
            lag(
                pipeline,
                &RenderRequest {
                    environment: environment.clone(),
                    ..own
                },
            )
        };
        for (history, environment) in [
            (History::Reflected, golden_environment()),
            (History::ControlVariate, smooth_environment()),
        ] {
            let [plain, own] = [History::Plain, history].map(|history| lag(history, &environment));
            assert!(own < 0.5 * plain, "{history:?}: {own}, {plain}");
        }
    });
}

/// The last result flickers by the variance of the frames that enter it: less in a longer mean.
#[test]
fn flicker_falls_with_the_length_of_the_mean() {
    with_pipeline(|pipeline| {
        let mut flicker = |count| {
            let frame = pipeline
                .render(&sequence(
                    24,
                    Frames {
                        count,
                        ..Frames::default()
                    },
                ))
                .unwrap();
            frame.steadiness.unwrap().flicker
        };
        let [short, long] = [16, 64].map(&mut flicker);
        assert!(long > 0.0 && long < 0.2 * short, "{short}, {long}");
    });
}

/// Flicker is the variance of the last eight results, each of which ends a shorter sequence.
#[test]
fn flicker_is_the_variance_of_eight_results() {
    with_pipeline(|pipeline| {
        let of = |count| {
            sequence(
                24,
                Frames {
                    count,
                    ..Frames::default()
                },
            )
        };
        let ends: Vec<Frame> = (5..=12)
            .map(|count| pipeline.render(&of(count)).unwrap())
            .collect();
        let curve = tone_mapped_curve(of(12).epsilon());
        let mask = &ends[0].mask.data;
        let shown = |frame: &Frame, i: usize| {
            DVec3::from_array(curve.apply(frame.radiance.data[i].map(f64::from)))
        };
        let variance = |i: usize| {
            let mean = ends.iter().map(|frame| shown(frame, i)).sum::<DVec3>() / 8.0;
            ends.iter()
                .map(|frame| (shown(frame, i) - mean).length_squared())
                .sum::<f64>()
                / (3.0 * 7.0)
        };
        let whole: Vec<usize> = (0..mask.len()).filter(|i| mask[*i] == 1.0).collect();
        let expected = whole.iter().map(|i| variance(*i)).sum::<f64>() / whole.len() as f64;
        let found = ends[7].steadiness.as_ref().unwrap().flicker;
        assert!((found / expected - 1.0).abs() < 1e-5, "{found}, {expected}");
    });
}
