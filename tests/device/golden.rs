//! Whole images of the reference against Mitsuba 3.9.1 (independent code, its own noise of 0.12 to 0.16 %).
//!
//! `tests/golden/mitsuba` holds every second pixel of both axes of three of eight images. `SPLITSUM_GOLDEN_DIR` names a folder with the
//! full set (`mitsuba/*.exr`, 128 x 128): then all eight are compared, and with `GOLDEN=update` the three are made from it.

use crate::harness::{golden_environment, lobe_sphere, request, scene, with_pipeline};
use splitsum::brdf::Brdf;
use splitsum::pipeline::RenderRequest;
use splitsum::pixels::{Pixels, exr};
use splitsum::scene::{CameraKind, MaterialOverride};
use splitsum::shade::{Diffuse, Method};
use splitsum::spelling::Listed;
use std::path::{Path, PathBuf};

/// Side of the images, pixels.
const SIDE: u32 = 128;

/// Samples a pixel: 0.8 % of noise at alpha 0.05, 0.3 % at alpha 1.
const SAMPLES: u32 = 4096;

/// One image: file stem, model or `diffuse`, alpha, Mitsuba's noise relative to the image's mean.
struct Golden {
    stem: &'static str,
    model: &'static str,
    alpha: f64,
    noise: f64,
}

const fn golden(stem: &'static str, model: &'static str, alpha: f64, noise: f64) -> Golden {
    Golden { stem, model, alpha, noise }
}

/// In the repository.
const KEPT: [Golden; 3] = [
    golden("ortho_analytic_ggx_a0.20", "ggx", 0.2, 0.001_491),
    golden("ortho_analytic_beckmann_a0.60", "beckmann", 0.6, 0.001_416),
    golden("persp_analytic_ggx_a0.20", "ggx", 0.2, 0.001_550),
];
/// Only in the full set.
const OTHERS: [Golden; 5] = [
    golden("ortho_analytic_ggx_a0.05", "ggx", 0.05, 0.001_220),
    golden("ortho_analytic_ggx_a0.60", "ggx", 0.6, 0.001_280),
    golden("ortho_analytic_ggx_a1.00", "ggx", 1.0, 0.001_029),
    golden("ortho_analytic_beckmann_a0.20", "beckmann", 0.2, 0.001_626),
    golden("ortho_analytic_diffuse", "diffuse", 1.0, 0.001_585),
];

fn golden_request(golden: &Golden) -> RenderRequest {
    let kind = if golden.stem.starts_with("persp") { CameraKind::Perspective } else { CameraKind::Ortho };
    let size = [SIDE, SIDE];
    if golden.model == "diffuse" {
        let white = MaterialOverride { albedo: Some([1.0; 3]), f0: Some([0.0; 3]), ..MaterialOverride::default() };
        return RenderRequest {
            reference_samples: SAMPLES,
            ..request(&golden_environment(), scene("sphere", white), kind, size).shaded(|s| {
                s.method = Method::listed("none");
                s.diffuse = Diffuse::listed("reference");
            })
        };
    }
    RenderRequest {
        reference_samples: SAMPLES,
        ..request(&golden_environment(), lobe_sphere(golden.alpha), kind, size).shaded(|s| {
            s.method = Method::listed("reference");
            s.brdf = <dyn Brdf>::listed(golden.model);
        })
    }
}

#[test]
fn the_reference_meets_images_of_another_renderer() {
    const RELATIVE_RMSE: f64 = 0.01;
    let full = std::env::var_os("SPLITSUM_GOLDEN_DIR").map(|folder| PathBuf::from(folder).join("mitsuba"));
    if let Some(folder) = full.as_ref().filter(|_| std::env::var("GOLDEN").is_ok_and(|value| value == "update")) {
        keep_every_second_pixel(folder);
    }
    let all: Vec<&Golden> = if full.is_some() { KEPT.iter().chain(&OTHERS).collect() } else { KEPT.iter().collect() };
    let folder = full.clone().unwrap_or_else(|| PathBuf::from("tests/golden/mitsuba"));
    with_pipeline(|pipeline| {
        for golden in all {
            let path = folder.join(format!("{}.exr", golden.stem));
            let expected = exr::read(&path).unwrap_or_else(|error| panic!("{error}")).rgb;
            let step = SIDE / expected.width;
            let frame = pipeline.render(&golden_request(golden)).unwrap();
            let sigma = frame.standard_error.as_ref().unwrap();
            let (mut square, mut own, mut mean, mut count) = (0.0, 0.0, 0.0, 0.0);
            for (x, y) in (0..expected.height).flat_map(|y| (0..expected.width).map(move |x| (x, y))) {
                let (column, row) = (x * step, y * step);
                // Mitsuba's sphere may miss or hit where the ray grazes the rim.
                if frame.n_dot_v.get(column, row) < 0.02 {
                    continue;
                }
                let (a, b, s) = (frame.radiance.get(column, row), expected.get(x, y), sigma.get(column, row));
                for c in 0..3 {
                    square += f64::from(a[c] - b[c]).powi(2);
                    own += f64::from(s[c]).powi(2);
                    mean += f64::from(b[c]);
                    count += 1.0;
                }
            }
            let mean = mean / count;
            let (rmse, own) = ((square / count).sqrt() / mean, (own / count).sqrt() / mean);
            let noise = own.hypot(golden.noise);
            println!("{}: relative RMSE {rmse:.5}, own noise {own:.5}, both {noise:.5}", golden.stem);
            assert!(count > 0.6 * f64::from(3 * expected.width * expected.height), "{}: mask", golden.stem);
            assert!(rmse < RELATIVE_RMSE, "{}: relative RMSE {rmse}", golden.stem);
            // Thousands of errors, but those of the few pixels that mirror the sun weigh most.
            assert!(
                (0.7..1.4).contains(&(rmse / noise)),
                "{}: {rmse} is not explained by noise of {noise}",
                golden.stem
            );
        }
    });
}

fn keep_every_second_pixel(full: &Path) {
    for golden in KEPT {
        let name = format!("{}.exr", golden.stem);
        let image = exr::read(&full.join(&name)).unwrap().rgb;
        let channels = ["R", "G", "B"].into_iter().zip(0..).map(|(channel, c): (&str, usize)| {
            (channel.to_owned(), Pixels::from_fn(SIDE / 2, SIDE / 2, |x, y| image.get(2 * x, 2 * y)[c]))
        });
        exr::write_channels(&Path::new("tests/golden/mitsuba").join(&name), channels.collect()).unwrap();
    }
}
