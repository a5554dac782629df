//! The scene `design`: its frames have their stated properties, and means over its pixels are means
//! over the sphere.

use glam::DVec3;
use splitsum::base::math::design::frame;
use splitsum::instrument::brdf::{ior_from_f0, reflect};
use splitsum::instrument::gbuffer::design::gbuffer;
use splitsum::instrument::scene::{Camera, CameraKind, MaterialOverride, Scene};
use splitsum::instrument::shade::coat::COAT_RENDERERS;
use std::path::Path;

const SIZE: [u32; 2] = [96, 96];

/// Normal, view and reflected direction of every pixel.
fn frames() -> Vec<[DVec3; 3]> {
    let count = SIZE[0] * SIZE[1];
    (0..count)
        .map(|i| frame(i, count))
        .map(|[n, v]| [n, v, reflect(v, n)])
        .collect()
}

fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    values.clone().sum::<f64>() / values.count() as f64
}

#[test]
fn the_gbuffer_holds_the_frames_and_the_camera_finds_their_views() {
    let scene = Scene::load("design", Path::new(".")).unwrap();
    let texels = gbuffer(&scene, SIZE);
    assert!(texels.mask().data.iter().all(|mask| *mask == 1.0));
    for kind in [CameraKind::Ortho, CameraKind::Perspective] {
        let camera = Camera::for_scene(kind, &scene, SIZE);
        let n_dot_v = texels.n_dot_v(&camera);
        for (i, [n, v, _]) in frames().into_iter().enumerate() {
            let [x, y, z, _] = texels.position_mask.data[i].map(f64::from);
            assert!(
                camera.v_at(DVec3::new(x, y, z)).distance(v) < 1e-7,
                "pixel {i}"
            );
            assert!(
                (f64::from(n_dot_v.data[i]) - n.dot(v)).abs() < 1e-6,
                "pixel {i}"
            );
        }
    }
}

#[test]
fn frames_are_orthonormal_where_they_must_be() {
    for (i, [n, v, r]) in frames().into_iter().enumerate() {
        assert!(
            [n, v, r].iter().all(|d| (d.length() - 1.0).abs() < 1e-12),
            "pixel {i}"
        );
        assert!(
            (n.dot(v) - n.dot(r)).abs() < 1e-12 && n.dot(v) > 0.0,
            "pixel {i}"
        );
        assert!(
            n.cross(v).dot(r).abs() < 1e-12,
            "pixel {i}: one plane of incidence"
        );
    }
}

/// Closed forms: 1 for a constant map, 0 for a linear map and for a product of two different
/// coordinates, 1/3 for a square.
#[test]
fn means_over_pixels_are_means_over_the_sphere_in_every_range_of_n_dot_v() {
    let frames = frames();
    // The lattice has its heights at the middles of bands of equal area.
    assert!(mean(frames.iter().map(|[.., r]| r.y)).abs() < 1e-9);
    let all = (0.0, 1.0, 1e-3);
    // A tenth of the pixels is a third as even.
    let tenths = (0..10).map(|k| (0.1 * f64::from(k), 0.1 * f64::from(k + 1), 0.02));
    for (low, high, tolerance) in [all].into_iter().chain(tenths) {
        let own: Vec<DVec3> = frames
            .iter()
            .filter(|[n, v, _]| (low..high).contains(&n.dot(*v)))
            .map(|[.., r]| *r)
            .collect();
        let share = own.len() as f64 / frames.len() as f64;
        assert!(
            (share - (high - low)).abs() < 1e-3,
            "n_dot_v {low} to {high} has {share} of the pixels"
        );
        for axis in 0..3 {
            let next = (axis + 1) % 3;
            let [linear, product, square] = [
                mean(own.iter().map(|r| r[axis])),
                mean(own.iter().map(|r| r[axis] * r[next])),
                mean(own.iter().map(|r| r[axis] * r[axis])) - 1.0 / 3.0,
            ];
            assert!(
                linear.abs() < tolerance && product.abs() < tolerance && square.abs() < tolerance,
                "n_dot_v {low} to {high}, axis {axis}: {linear} {product} {square}"
            );
        }
    }
}

/// The plane of incidence turns about r evenly, at every n·v: no direction of the tangent plane is
/// preferred.
#[test]
fn planes_of_incidence_are_turned_evenly() {
    for low in [0.0, 0.25, 0.5, 0.75] {
        let own: Vec<[DVec3; 3]> = frames()
            .into_iter()
            .filter(|[n, v, _]| (low..low + 0.25).contains(&n.dot(*v)))
            .collect();
        for k in 1..=2 {
            let turned = |part: fn(f64) -> f64| {
                mean(own.iter().map(|[n, _, r]| {
                    let across = (*n - *r * n.dot(*r)).normalize();
                    let [x, y] = [
                        r.any_orthonormal_vector(),
                        r.cross(r.any_orthonormal_vector()),
                    ];
                    part(f64::from(k) * across.dot(y).atan2(across.dot(x)))
                }))
            };
            let [cos, sin] = [turned(f64::cos), turned(f64::sin)];
            assert!(
                cos.abs() < 0.02 && sin.abs() < 0.02,
                "n_dot_v from {low}, degree {k}: {cos} {sin}"
            );
        }
    }
}

#[test]
fn a_metal_reflects_its_albedo() {
    let [f0, albedo] = [[0.04, 0.1, 0.2], [0.9, 0.5, 0.3]];
    let material = MaterialOverride {
        f0: Some(f0),
        albedo: Some(albedo),
        metallic: Some(0.25),
        ..MaterialOverride::default()
    };
    let texels = gbuffer(
        &Scene::load("design", Path::new("."))
            .unwrap()
            .apply(&material),
        [4, 4],
    );
    for texel in &texels.f0_material.data {
        let off = (0..3)
            .map(|c| (texel[c] - (0.75 * f0[c] + 0.25 * albedo[c])).abs())
            .fold(0.0, f32::max);
        assert!(off < 1e-6, "{texel:?}");
    }
}

/// Below a coat the design has the F0 and the alpha of the renderer's law, as any other scene.
#[test]
fn the_base_below_a_coat_is_the_renderers() {
    let material = MaterialOverride {
        albedo: Some([0.5, 0.25, 1.0]),
        metallic: Some(1.0),
        alpha: Some(0.16),
        coat: Some(1.0),
        coat_alpha: Some(0.36),
        ..MaterialOverride::default()
    };
    let coated = Scene::load("design", Path::new("."))
        .unwrap()
        .apply(&material);
    for renderer in COAT_RENDERERS {
        let texels = gbuffer(&coated.below_coat(renderer.base), [4, 4]);
        let f0 = texels.f0_material.data[5];
        let alpha = texels.normal_alpha.data[5][3];
        // Below a whole coat of index 1.5, an index n reflects ((n - 1.5)/(n + 1.5))².
        let lowered = |f0: f32| {
            let index = (1.0 + f0.sqrt()) / (1.0 - f0.sqrt());
            ((index - 1.5) / (index + 1.5)).powi(2)
        };
        let (expected_f0, expected_alpha) = match renderer.name {
            "filament" => (lowered(0.5), 0.36),
            "unity" => (
                lowered(0.5),
                0.16 / f32::sqrt(0.16 * 0.16 + (1.0 - 0.16 * 0.16) / 2.25),
            ),
            "babylon" => (lowered(0.5), 0.16),
            _ => (0.5, 0.16),
        };
        let off = [(f0[0] - expected_f0).abs(), (alpha - expected_alpha).abs()];
        // The polynomials are fits.
        assert!(
            off[0] < 2.5e-3 && off[1] < 1e-6,
            "{}: {f0:?} {alpha}",
            renderer.name
        );
    }
}

/// Both fits of F0 below a coat are within 0.005 of the Fresnel equations from F0 0.04, the coat's
/// own index, on.
#[test]
fn lowered_f0_fits_the_fresnel_equations() {
    for renderer in COAT_RENDERERS
        .iter()
        .filter(|renderer| renderer.base.f0[2] != 0.0)
    {
        for i in 0..=95 {
            let f0 = 0.04 + 0.01 * f64::from(i);
            let index = ior_from_f0(f0);
            let exact = ((index - 1.5) / (index + 1.5)).powi(2);
            let found = renderer.base.f0_below(DVec3::splat(f0), 1.0).x;
            assert!(
                (found - exact).abs() < 5e-3,
                "{} {f0}: {found} {exact}",
                renderer.name
            );
        }
    }
}
