//! Identities of whole frames: mirrors, orientation, rotation, linearity, the background.

use crate::compare::{Worst, absolute, relative};
use crate::harness::{
    constant_environment, golden_environment, lobe_sphere, render_by_seeds, request, scene, with_pipeline,
};
use crate::methods::{EXACT, radiance, sights};
use glam::{DQuat, DVec3};
use splitsum::brdf::MODELS;
use splitsum::environment::{Environment, Placement};
use splitsum::pipeline::{Frame, RenderRequest};
use splitsum::pixels::RgbImage;
use splitsum::precompute::dfg::reference::dfg;
use splitsum::precompute::exact_quadrature;
use splitsum::precompute::prefilter::{Kernel, reference::prefilter};
use splitsum::scene::{Camera, CameraKind, MaterialOverride, Scene};
use splitsum::shade::{Diffuse, METHODS, Method};
use splitsum::spelling::Listed;
use std::f64::consts::TAU;
use std::sync::Arc;

fn method(name: &str) -> &'static Method {
    Method::listed(name)
}

/// A smooth map without suns: `1 + 0.5 d.x + 0.3 d.y d.z`, other shares in green and blue.
pub fn smooth_environment() -> Arc<Environment> {
    let size = [256, 128];
    let image = RgbImage::from_fn(size[0], size[1], |x, y| {
        let uv = glam::DVec2::new((f64::from(x) + 0.5) / 256.0, (f64::from(y) + 0.5) / 128.0);
        let d = splitsum::math::equirect::direction_from_uv(uv);
        [1.0 + 0.5 * d.x + 0.3 * d.y * d.z, 1.0 - 0.4 * d.y, 1.0 + 0.6 * d.z].map(|l| l as f32)
    });
    Arc::new(Environment::from_image("smooth", image))
}

#[test]
fn split_sum_factors_exactly_where_the_view_is_the_normal() {
    // At v = n the map's assumption holds, so the product is that of the two exact integrals. 4096 samples of a map with a sun.
    with_pipeline(|pipeline| {
        let environment = smooth_environment();
        let exact = exact_quadrature(&environment.image);
        for model in MODELS {
            let mut base = request(&environment, lobe_sphere(0.25), CameraKind::Ortho, [5, 5]);
            base.shading.brdf = *model;
            let sight = sights(&base, 1).into_iter().find(|sight| sight.pixel == [2, 2]).unwrap();
            assert_eq!(sight.surface.n, sight.surface.v);
            let frame = pipeline.render(&base).unwrap();
            let mean = prefilter(&exact, Kernel::cosine(*model), sight.surface.alpha, sight.surface.n, EXACT).value;
            let albedo = dfg(*model, base.shading.masking_shadowing, 1.0, sight.surface.alpha).albedo();
            let mut worst = Worst::new(format!("{} at v = n", model.name()), relative(4e-3));
            worst.add_rgb(radiance(&frame, sight.pixel), mean * albedo, || "the middle pixel".into());
            worst.check();
        }
    });
}

#[test]
fn turning_environment_and_camera_together_changes_nothing() {
    with_pipeline(|pipeline| {
        let environment = golden_environment();
        // A quarter turn to larger u is exact in the map: about +y by -90 degrees, since phi = 2 pi (0.5 - u).
        let shifted = RgbImage::from_fn(512, 256, |x, y| environment.image.get((x + 384) % 512, y));
        let shifted = Arc::new(Environment::from_image("shifted", shifted));
        let turn = DQuat::from_rotation_y(-TAU / 4.0);
        for method in METHODS.iter().filter(|method| method.name != "none") {
            for kind in [CameraKind::Ortho, CameraKind::Perspective] {
                let still = RenderRequest {
                    reference_samples: 4096,
                    background: true,
                    ..request(&environment, scene("sphere", MaterialOverride::default()), kind, [16, 16]).shaded(|s| {
                        s.method = method;
                        s.samples = 1024;
                        s.diffuse = Diffuse::listed("sh9");
                    })
                };
                let turned = RenderRequest {
                    environment: shifted.clone(),
                    camera: Camera {
                        eye: turn * still.camera.eye,
                        right: turn * still.camera.right,
                        up: turn * still.camera.up,
                        forward: turn * still.camera.forward,
                        ..still.camera
                    },
                    ..still.clone()
                };
                // The same by the parameter: the environment turned back again under the still camera.
                let rotated = RenderRequest {
                    environment: shifted.clone(),
                    ..still.shaded(|s| s.placement = Placement { rotation_deg: 90.0, orientation: 0 })
                };
                let [a, b, c] = [&still, &turned, &rotated].map(|request| pipeline.render(request).unwrap());
                let name = format!("{} {kind:?}", method.name);
                // The frame about a direction does not turn with it, so points fall on other azimuths of each pixel's lobe. What changes is
                // the method's own error at this count of samples; lookups of the prefiltered map have none.
                let is_drawn = method.uses_point_set || still.shaded(|s| s.method = method).has_reference_term();
                let own_error = relative(if is_drawn { 0.15 } else { 1e-5 });
                let mut camera = Worst::new(format!("{name} camera turned"), own_error);
                let mut map = Worst::new(format!("{name} map turned back"), relative(2e-4));
                let rgb = |frame: &Frame, i: usize| DVec3::from_array(frame.radiance.data[i].map(f64::from));
                for i in 0..a.radiance.data.len() {
                    camera.add_rgb(rgb(&b, i), rgb(&a, i), || format!("pixel {i}"));
                    map.add_rgb(rgb(&c, i), rgb(&b, i), || format!("pixel {i}"));
                }
                [camera, map].into_iter().for_each(Worst::check);
            }
        }
    });
}

#[test]
fn radiance_is_linear_in_the_environment() {
    with_pipeline(|pipeline| {
        let environment = golden_environment();
        for method in METHODS {
            let one = RenderRequest {
                reference_samples: 64,
                background: true,
                ..request(&environment, scene("spheres", MaterialOverride::default()), CameraKind::Ortho, [24, 16])
                    .shaded(|s| (s.method, s.diffuse) = (method, Diffuse::listed("reference")))
            };
            // A power of two is exact in every product.
            let four = one.shaded(|s| s.environment_scale = 4.0);
            let (one, four) = (pipeline.render(&one).unwrap(), pipeline.render(&four).unwrap());
            let scaled = one.radiance.map(|l| l.map(|x| 4.0 * x));
            assert_eq!(four.radiance, scaled, "{}", method.name);
            assert_eq!(
                four.standard_error,
                one.standard_error.map(|e| e.map(|l| l.map(|x| 4.0 * x))),
                "{}",
                method.name
            );
            assert!(one.radiance.data.iter().flatten().any(|&x| x > 0.5));
        }
    });
}

#[test]
fn white_light_on_a_white_diffuse_sphere_is_white() {
    with_pipeline(|pipeline| {
        let white = MaterialOverride { albedo: Some([1.0; 3]), ..MaterialOverride::default() };
        for (name, tolerance) in [("sh9", 4.1e-4), ("irradiance-map", 1e-5), ("reference", 0.0)] {
            let request = request(&constant_environment([1.0; 3]), scene("sphere", white), CameraKind::Ortho, [9, 9])
                .shaded(|s| (s.method, s.diffuse) = (method("none"), Diffuse::listed(name)));
            let frame = render_by_seeds(pipeline, &request);
            // SH9 sums 32 rows at texel centres: pi^2 / (24 32^2) = 4e-4, and as much again in degree 2.
            // The reference is held to its own standard error.
            let mut worst = Worst::new(format!("{name} of white light"), absolute(1.0));
            for sight in sights(&request, 1) {
                let [x, y] = sight.pixel;
                let sigma = frame.standard_error.as_ref().map_or(0.0, |error| f64::from(error.get(x, y)[0]));
                let off = (radiance(&frame, sight.pixel) - 1.0) / (2.0 * tolerance + 5.0 * sigma);
                worst.add_rgb(off, DVec3::ZERO, || format!("{x} {y}"));
            }
            worst.check();
        }
    });
}

/// In the scene `design` the mean over the pixels is the mean over the sphere: a mirror under a constant and under a linear map shows 1, and
/// a turn of the map changes nothing.
#[test]
fn a_mirror_in_the_design_shows_the_mean_of_the_map() {
    with_pipeline(|pipeline| {
        let size = [64, 64];
        let environment = smooth_environment();
        for rotation in [0.0, 50.0] {
            let request = request(&environment, mirror_design(), CameraKind::Ortho, size).shaded(|s| {
                s.method = method("sampled-unfiltered");
                s.samples = 16;
                s.placement = Placement { orientation: 0, rotation_deg: rotation };
            });
            let frame = pipeline.render(&request).unwrap();
            assert!(frame.mask.data.iter().all(|mask| *mask == 1.0));
            for (c, expected) in [1.0; 3].into_iter().enumerate() {
                let mean = frame.radiance.data.iter().map(|rgb| f64::from(rgb[c])).sum::<f64>() / 4096.0;
                assert!((mean - expected).abs() < 5e-3, "channel {c} at {rotation} degrees: {mean}");
            }
        }
    });
}

/// The narrowest lobe, F = 1, no diffuse albedo.
fn mirror_design() -> Scene {
    let black = Some([0.0; 3]);
    scene("design", MaterialOverride { alpha: Some(0.001), f0: Some([1.0; 3]), albedo: black, metallic: None })
}
