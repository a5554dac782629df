//! Whole images of the reference against Mitsuba 3.9.1 (independent code, its own noise of 0.14 to
//! 0.16 %).
//!
//! `tests/golden/mitsuba` holds every second pixel of both axes.

use crate::harness::{golden_environment, lobe_sphere, request, with_pipeline};
use splitsum::base::names::Listed;
use splitsum::base::pixels::exr;
use splitsum::instrument::brdf::Brdf;
use splitsum::instrument::pipeline::RenderRequest;
use splitsum::instrument::scene::CameraKind;
use splitsum::instrument::shade::Method;
use std::path::Path;

/// Side of the images before every second pixel was taken.
const SIDE: u32 = 128;

/// Samples a pixel: 0.8 % of noise at alpha 0.05, 0.3 % at alpha 1.
const SAMPLES: u32 = 4096;

/// File stem, model, alpha, Mitsuba's noise relative to the image's mean.
const IMAGES: [(&str, &str, f64, f64); 3] = [
    ("ortho_analytic_ggx_a0.20", "ggx", 0.2, 0.001_491),
    ("ortho_analytic_beckmann_a0.60", "beckmann", 0.6, 0.001_416),
    ("persp_analytic_ggx_a0.20", "ggx", 0.2, 0.001_550),
];

#[test]
fn the_reference_matches_images_of_another_renderer() {
    const RELATIVE_RMSE: f64 = 0.01;
    with_pipeline(|pipeline| {
        for (stem, model, alpha, golden_noise) in IMAGES {
            let path = Path::new("tests/golden/mitsuba").join(format!("{stem}.exr"));
            let expected = exr::read(&path)
                .unwrap_or_else(|error| panic!("{error}"))
                .rgb;
            let step = SIDE / expected.width;
            let kind = if stem.starts_with("persp") {
                CameraKind::Perspective
            } else {
                CameraKind::Ortho
            };
            let request = RenderRequest {
                reference_samples: SAMPLES,
                ..request(&golden_environment(), lobe_sphere(alpha), kind, [SIDE; 2]).shaded(|s| {
                    (s.method, s.brdf) = (Method::listed("reference"), <dyn Brdf>::listed(model))
                })
            };
            let frame = pipeline.render(&request).unwrap();
            let sigma = frame.standard_error.as_ref().unwrap();
            let (mut square, mut own, mut mean, mut count) = (0.0, 0.0, 0.0, 0.0);
            for (x, y) in
                (0..expected.height).flat_map(|y| (0..expected.width).map(move |x| (x, y)))
            {
                let (column, row) = (x * step, y * step);
                // Mitsuba may miss or hit the sphere where a ray grazes the rim.
                if frame.n_dot_v.get(column, row) < 0.02 {
                    continue;
                }
                let (a, b, s) = (
                    frame.radiance.get(column, row),
                    expected.get(x, y),
                    sigma.get(column, row),
                );
                for c in 0..3 {
                    square += f64::from(a[c] - b[c]).powi(2);
                    own += f64::from(s[c]).powi(2);
                    mean += f64::from(b[c]);
                    count += 1.0;
                }
            }
            let mean = mean / count;
            let (rmse, own) = ((square / count).sqrt() / mean, (own / count).sqrt() / mean);
            let noise = own.hypot(golden_noise);
            println!("{stem}: relative RMSE {rmse:.5}, own noise {own:.5}, both {noise:.5}");
            assert!(
                count > 0.6 * f64::from(3 * expected.width * expected.height),
                "{stem}: mask"
            );
            assert!(rmse < RELATIVE_RMSE, "{stem}: relative RMSE {rmse}");
            // There are thousands of errors, but the few pixels that mirror the sun weigh most.
            assert!(
                (0.7..1.4).contains(&(rmse / noise)),
                "{stem}: {rmse} is not explained by noise of {noise}"
            );
        }
    });
}
