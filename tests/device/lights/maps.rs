//! Lights that stand for a map, against the reference under it.

use super::{plastic, under};
use crate::harness::{constant_environment, render_by_seeds, request, scene, with_pipeline};
use crate::methods::{radiance, sights};
use crate::symmetry::smooth_environment;
use glam::{DVec2, DVec3};
use splitsum::base::math::equirect::direction_from_uv;
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::{Compensation, MODELS, MaskingShadowing};
use splitsum::instrument::pipeline::{Frame, RenderRequest};
use splitsum::instrument::scene::{CameraKind, Light, MaterialOverride};
use splitsum::instrument::shade::{Diffuse, Method};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Lights of a map: one for each texel, with its radiance times its solid angle.
fn lights_of_map(width: u32, height: u32, radiance: impl Fn(DVec3) -> [f32; 3]) -> Vec<Light> {
    let mut lights = Vec::new();
    for y in 0..height {
        let [top, bottom] = [y, y + 1].map(|row| PI * f64::from(row) / f64::from(height));
        let solid_angle = TAU / f64::from(width) * (top.cos() - bottom.cos());
        for x in 0..width {
            let uv = DVec2::new(
                (f64::from(x) + 0.5) / f64::from(width),
                (f64::from(y) + 0.5) / f64::from(height),
            );
            let l = direction_from_uv(uv);
            let color = radiance(l).map(|channel| (f64::from(channel) * solid_angle) as f32);
            lights.push(Light::directional(-l, color));
        }
    }
    lights
}

fn relative_rms(found: &Frame, expected: &Frame) -> f64 {
    let mut sums = [0.0; 2];
    let pixels = found.radiance.data.iter().zip(&expected.radiance.data);
    for ((found, expected), mask) in pixels.zip(&expected.mask.data) {
        for c in 0..3 {
            let off = f64::from(found[c] - expected[c]) * f64::from(*mask);
            sums[0] += off * off;
            sums[1] += f64::from(expected[c]).powi(2) * f64::from(*mask);
        }
    }
    (sums[0] / sums[1]).sqrt()
}

/// One directional light for each texel of a 64x32 map gives the image of the reference under it.
/// They differ by the size of a texel, so more at half the size, and by the reference's noise.
#[test]
fn lights_of_a_map_give_its_image() {
    let environment = smooth_environment();
    let map = |l: DVec3| environment.radiance(l).as_vec3().to_array();
    with_pipeline(|pipeline| {
        for model in MODELS {
            let sphere = scene("sphere", plastic(0.4));
            let plain = request(&environment, sphere.clone(), CameraKind::Ortho, [15; 2]);
            let plain = RenderRequest {
                reference_samples: 1 << 14,
                ..plain
            }
            .shaded(|s| {
                s.brdf = *model;
                s.method = Method::listed("reference");
                s.diffuse = Diffuse::listed("reference");
            });
            let reference = render_by_seeds(pipeline, &plain);
            let off = [16, 32].map(|height| {
                let lit = sphere.lit_by(lights_of_map(2 * height, height, map));
                let dark = RenderRequest {
                    environment: constant_environment([0.0; 3]),
                    scene: Arc::new(lit),
                    ..plain.clone()
                };
                relative_rms(&pipeline.render(&dark).unwrap(), &reference)
            });
            println!("{}: {off:?} of the integral", model.name());
            assert!(off[1] < 1e-3 && off[1] < 0.6 * off[0], "{off:?}");
        }
    });
}

/// 4,096 lights of radiance 1 are a furnace: a white surface that loses no light shows 1.
#[test]
fn the_lights_of_a_constant_map_are_a_furnace() {
    // Equal areas: rows of equal height, staggered columns.
    const SIDE: u32 = 64;
    let lights: Vec<Light> = (0..SIDE * SIDE)
        .map(|i| {
            let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(SIDE * SIDE);
            let azimuth = TAU * (f64::from(i) * 0.618_033_988_749_895).fract();
            let across = (1.0 - z * z).sqrt();
            let l = DVec3::new(across * azimuth.cos(), z, across * azimuth.sin());
            let solid_angle = 2.0 * TAU / f64::from(SIDE * SIDE);
            Light::directional(-l, [solid_angle as f32; 3])
        })
        .collect();
    with_pipeline(|pipeline| {
        for model in MODELS {
            for compensation in Compensation::all() {
                let material = MaterialOverride {
                    alpha: Some(0.6),
                    f0: Some([1.0; 3]),
                    albedo: Some([0.0; 3]),
                    ..MaterialOverride::default()
                };
                let request = under(lights.clone(), scene("sphere", material), 9).shaded(|s| {
                    (s.brdf, s.compensation) = (*model, *compensation);
                    // No albedo above 1, which only the scaling could correct.
                    s.masking_shadowing = MaskingShadowing::SmithExact;
                });
                let frame = pipeline.render(&request).unwrap();
                let (mut worst, mut lost) = (0.0f64, 0.0f64);
                for sight in sights(&request, 1) {
                    let off = radiance(&frame, sight.pixel).x - 1.0;
                    worst = worst.max(off.abs());
                    lost = lost.max(-off);
                }
                let case = format!("{} {compensation:?}: off by {worst}", model.name());
                println!("{case}");
                match compensation {
                    Compensation::None => assert!(lost > 0.02, "{case}"),
                    _ => assert!(worst < 5e-3, "{case}"),
                }
            }
        }
    });
}
