//! Analytic lights against the f64 BRDF.

use crate::compare::{Worst, relative};
use crate::harness::{constant_environment, incident, request, scene, with_pipeline};
use crate::methods::{radiance, sights};
use glam::DVec3;
use splitsum::brdf::{MODELS, MaskingShadowing, eval};
use splitsum::math::frame::Frame;
use splitsum::pipeline::RenderRequest;
use splitsum::scene::{CameraKind, Light, LightKind, MaterialOverride};
use splitsum::shade::{Diffuse, Method};
use splitsum::spelling::Listed;
use std::f64::consts::PI;

fn lights() -> Vec<Light> {
    let light = |kind, position_or_direction, color| Light { kind, position_or_direction, color };
    vec![
        light(LightKind::Directional, DVec3::new(0.48, 0.6, 0.64), [3.0, 2.0, 1.0]),
        light(LightKind::Point, DVec3::new(-2.0, 1.0, 1.5), [5.0, 10.0, 20.0]),
    ]
}

#[test]
fn lights_match_the_f64_brdf() {
    with_pipeline(|pipeline| {
        for model in MODELS {
            for &masking_shadowing in MaskingShadowing::all() {
                for alpha in [0.05, 0.6] {
                    // Metallic 1 has no diffuse term, and the environment is black: only the lobe remains.
                    let material = MaterialOverride {
                        albedo: Some([0.9, 0.5, 0.2]),
                        metallic: Some(1.0),
                        alpha: Some(alpha),
                        f0: None,
                        ..MaterialOverride::default()
                    };
                    let request = RenderRequest {
                        lights: lights(),
                        ..request(
                            &constant_environment([0.0; 3]),
                            scene("sphere", material),
                            CameraKind::Perspective,
                            [20, 20],
                        )
                        .shaded(|s| (s.brdf, s.masking_shadowing) = (*model, masking_shadowing))
                    };
                    let frame = pipeline.render(&request).unwrap();
                    // A normal known to 1e-7 and a lobe of alpha 0.05, whose D changes by 4 tan / alpha^2 a radian.
                    let mut worst =
                        Worst::new(format!("{} {masking_shadowing:?} {alpha} lights", model.name()), relative(1e-4));
                    let texels = crate::gbuffer_twin::gbuffer(&request.scene, &request.camera, request.size);
                    let mut lit = 0;
                    for sight in sights(&request, 1) {
                        let s = sight.surface;
                        let position = texels.position_mask.get(sight.pixel[0], sight.pixel[1]);
                        let position = DVec3::new(position[0], position[1], position[2]);
                        let frame_of_n = Frame::from_normal(s.n);
                        let expected: DVec3 = lights()
                            .iter()
                            .map(|light| {
                                let (l, irradiance) = incident(light, position);
                                let (v, l) = (frame_of_n.to_local(s.v), frame_of_n.to_local(l));
                                eval(s.model, v, l, s.alpha, s.f0, s.masking) * l.z.max(0.0) * irradiance
                            })
                            .sum();
                        lit += usize::from(expected.x > 0.01);
                        // At the terminator both are 0 up to the rounding of n_dot_l.
                        if expected.max_element() > 1e-6 && s.n.dot(s.v) > 0.02 {
                            worst.add_rgb(radiance(&frame, sight.pixel), expected, || format!("{:?}", sight.pixel));
                        }
                    }
                    assert!(lit > 2, "{lit} pixels are lit");
                    worst.check();
                }
            }
        }
    });
}

#[test]
fn lights_without_a_specular_term_are_lambert() {
    with_pipeline(|pipeline| {
        let material =
            MaterialOverride { albedo: Some([0.9, 0.5, 0.2]), metallic: Some(0.5), ..MaterialOverride::default() };
        let request = RenderRequest {
            lights: lights()[..1].to_vec(),
            ..request(&constant_environment([0.0; 3]), scene("sphere", material), CameraKind::Ortho, [20, 20]).shaded(
                |s| {
                    s.method = Method::listed("none");
                    s.diffuse = Diffuse::listed("none");
                },
            )
        };
        let frame = pipeline.render(&request).unwrap();
        let mut worst = Worst::new("Lambert", relative(2e-5));
        for sight in sights(&request, 1) {
            let n_dot_l = sight.surface.n.dot(DVec3::new(0.48, 0.6, 0.64)).max(0.0);
            if n_dot_l == 0.0 || n_dot_l > 0.01 {
                let expected = 0.5 * DVec3::new(0.9, 0.5, 0.2) * DVec3::new(3.0, 2.0, 1.0) * n_dot_l / PI;
                worst.add_rgb(radiance(&frame, sight.pixel), expected, || format!("{:?}", sight.pixel));
            }
        }
        worst.check();
    });
}
