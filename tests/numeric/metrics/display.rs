//! Perceptual metrics: SSIM from its definition, FLIP against the authors' programs.

use super::{LINEAR_CURVE, Random, assert_relative, noisy_pair, radiance_of_code, score, whole};
use splitsum::metrics::{Comparison, PIXELS_PER_DEGREE};
use splitsum::pixels::{GrayImage, Rgb8Image, RgbImage};

/// SSIM from its definition: a direct double sum over each window, Rec. 601 luma.
fn mean_ssim(test: &Rgb8Image, reference: &Rgb8Image, mask: &GrayImage) -> f64 {
    let luma = |[r, g, b]: [u8; 3]| 0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b);
    let (c1, c2) = (6.5025, 58.5225);
    let (mut sum, mut count) = (0.0, 0.0);
    for (cx, cy) in (0..test.height as i32).flat_map(|y| (0..test.width as i32).map(move |x| (x, y))) {
        if mask.get(cx as u32, cy as u32) == 0.0 {
            continue;
        }
        let mut window = Vec::new();
        for (x, y) in (cy - 5..=cy + 5).flat_map(|y| (cx - 5..=cx + 5).map(move |x| (x, y))) {
            if x >= 0 && y >= 0 && x < test.width as i32 && y < test.height as i32 {
                let weight = (-f64::from((x - cx).pow(2) + (y - cy).pow(2)) / (2.0 * 1.5 * 1.5)).exp();
                let at = |image: &Rgb8Image| luma(image.get(x as u32, y as u32));
                window.push((weight, at(test), at(reference)));
            }
        }
        let total: f64 = window.iter().map(|sample| sample.0).sum();
        let mean = |term: &dyn Fn(f64, f64) -> f64| window.iter().map(|&(w, t, r)| w * term(t, r)).sum::<f64>() / total;
        let (mt, mr) = (mean(&|t, _| t), mean(&|_, r| r));
        let (vt, vr) = (mean(&|t, _| (t - mt).powi(2)), mean(&|_, r| (r - mr).powi(2)));
        let covariance = mean(&|t, r| (t - mt) * (r - mr));
        sum += (2.0 * mt * mr + c1) * (2.0 * covariance + c2) / ((mt * mt + mr * mr + c1) * (vt + vr + c2));
        count += 1.0;
    }
    sum / count
}

#[test]
fn ssim_equals_its_definition() {
    let [test, reference] = noisy_pair(17, 14);
    // Every third pixel comes from elsewhere, so that structure is lost and the score is far from 1.
    let test = RgbImage::from_fn(17, 14, |x, y| if (x + y) % 3 == 0 { test.get(16 - x, y) } else { test.get(x, y) });
    let mask = GrayImage::from_fn(17, 14, |x, y| if (x + 2 * y) % 7 == 0 { 0.0 } else { 1.0 });
    let black_outside = |image: &RgbImage| {
        Rgb8Image::from_fn(17, 14, |x, y| {
            if mask.get(x, y) == 1.0 { LINEAR_CURVE.apply_rgb8(image.get(x, y)) } else { [0; 3] }
        })
    };
    let expected = mean_ssim(&black_outside(&test), &black_outside(&reference), &mask);
    assert!((0.1..0.95).contains(&expected), "{expected} would not tell a wrong map from a right one");
    assert_relative(score(&test, &reference, &mask, "ssim"), expected, 1e-10, "ssim");
}

#[test]
fn ssim_of_constants_is_their_luminance_term() {
    let [reference, test] = [100.0, 120.0].map(|code| RgbImage::filled(30, 30, [radiance_of_code(code); 3]));
    let expected = (2.0 * 100.0 * 120.0 + 6.5025) / (100.0 * 100.0 + 120.0 * 120.0 + 6.5025);
    assert_relative(score(&test, &reference, &whole(&test), "ssim"), expected, 1e-9, "ssim");
}

type Codes = splitsum::pixels::Pixels<[f64; 3]>;

/// The error map of the authors' first program, which filters with whole two-dimensional kernels.
fn map_of_the_authors(test: &Rgb8Image, reference: &Rgb8Image) -> Vec<f32> {
    let upload =
        |image: &Rgb8Image| nv_flip::FlipImageRgb8::with_data(image.width, image.height, image.data.as_flattened());
    nv_flip::flip(upload(reference), upload(test), PIXELS_PER_DEGREE).to_vec()
}

#[test]
fn flip_equals_the_authors_program_pixel_by_pixel() {
    assert_relative(f64::from(PIXELS_PER_DEGREE), 3840f64.to_radians(), 1e-6, "0.7 m, 3840 pixels, 0.7 m");
    let mut random = Random(3);
    // Stripes and blocks under a ramp; the test image has another contrast, blur in a corner and speckles, some narrower than the filters.
    for (width, height) in [(64, 48), (5, 70), (1, 1), (33, 3)] {
        let code = |value: f64| value.clamp(0.0, 250.0).round();
        let reference = Codes::from_fn(width, height, |x, y| {
            let block = if (x / 7 + y / 4) % 2 == 0 { 90.0 } else { 0.0 };
            [20.0 + 2.0 * f64::from(x) + block, 160.0 - block, 4.0 * f64::from(y)]
        });
        let test = Codes::from_fn(width, height, |x, y| {
            let speckle = if random.next() < 0.1 { 80.0 } else { 0.0 };
            reference.get(x, y).map(|value| 0.9 * value + 10.0 + speckle)
        });
        let [test, reference] = [test, reference].map(|image| image.map(|pixel| pixel.map(code)));
        let codes = |image: &Codes| image.map(|pixel| pixel.map(|code| code as u8));
        let radiance = |image: &Codes| image.map(|pixel| pixel.map(radiance_of_code));
        let (linear_test, linear_reference) = (radiance(&test), radiance(&reference));
        let mask = whole(&linear_test);
        let comparison =
            Comparison::new(&linear_test, &linear_reference, &mask, LINEAR_CURVE, splitsum::metrics::Epsilon::ABSOLUTE)
                .unwrap();
        let expected = map_of_the_authors(&codes(&test), &codes(&reference));
        for (pixel, (found, expected)) in comparison.flip_map().data.iter().zip(expected).enumerate() {
            assert!((found - expected).abs() < 2e-4, "{width}x{height}, pixel {pixel}: {found} instead of {expected}");
        }
    }
}
