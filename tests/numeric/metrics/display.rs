//! FLIP against the authors' program.

use super::{LINEAR_CURVE, Rng, assert_relative, radiance_of_code, whole};
use splitsum::base::pixels::Rgb8Image;
use splitsum::instrument::metrics::{Comparison, PIXELS_PER_DEGREE};

type Codes = splitsum::base::pixels::Pixels<[f64; 3]>;

/// The error map of the authors' first program, which filters with whole two-dimensional kernels.
fn map_of_the_authors(test: &Rgb8Image, reference: &Rgb8Image) -> Vec<f32> {
    let upload = |image: &Rgb8Image| {
        nv_flip::FlipImageRgb8::with_data(image.width, image.height, image.data.as_flattened())
    };
    nv_flip::flip(upload(reference), upload(test), PIXELS_PER_DEGREE).to_vec()
}

#[test]
fn flip_equals_the_authors_program_pixel_by_pixel() {
    assert_relative(
        f64::from(PIXELS_PER_DEGREE),
        3840f64.to_radians(),
        1e-6,
        "0.7 m, 3840 pixels, 0.7 m",
    );
    let mut random = Rng::with_seed(3);
    // Stripes and blocks under a ramp; the test image has another contrast, blur in a corner and
    // speckles, some narrower than the filters.
    for (width, height) in [(64, 48), (5, 70), (1, 1), (33, 3)] {
        let code = |value: f64| value.clamp(0.0, 250.0).round();
        let reference = Codes::from_fn(width, height, |x, y| {
            let block = if (x / 7 + y / 4) % 2 == 0 { 90.0 } else { 0.0 };
            [
                20.0 + 2.0 * f64::from(x) + block,
                160.0 - block,
                4.0 * f64::from(y),
            ]
        });
        let test = Codes::from_fn(width, height, |x, y| {
            let speckle = if random.f64() < 0.1 { 80.0 } else { 0.0 };
            reference
                .get(x, y)
                .map(|value| 0.9 * value + 10.0 + speckle)
        });
        let [test, reference] = [test, reference].map(|image| image.map(|pixel| pixel.map(code)));
        let codes = |image: &Codes| image.map(|pixel| pixel.map(|code| code as u8));
        let radiance = |image: &Codes| image.map(|pixel| pixel.map(radiance_of_code));
        let (linear_test, linear_reference) = (radiance(&test), radiance(&reference));
        let mask = whole(&linear_test);
        let comparison = Comparison::new(
            &linear_test,
            &linear_reference,
            &mask,
            LINEAR_CURVE,
            splitsum::instrument::metrics::Epsilon::ABSOLUTE,
        )
        .unwrap();
        let expected = map_of_the_authors(&codes(&test), &codes(&reference));
        for (pixel, (found, expected)) in
            comparison.flip_map().data.iter().zip(expected).enumerate()
        {
            assert!(
                (found - expected).abs() < 2e-4,
                "{width}x{height}, pixel {pixel}: {found} instead of {expected}"
            );
        }
    }
}
