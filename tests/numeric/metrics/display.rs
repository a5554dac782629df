//! FLIP against the authors' program, PSNR and SSIM against scikit-image.

use super::{LINEAR_CURVE, Rng, assert_relative, radiance_of_code, score, whole};
use splitsum::base::names::Listed;
use splitsum::base::pixels::{GrayImage, Rgb8Image, RgbImage};
use splitsum::instrument::metrics::{Comparison, Epsilon, METRICS, Metric, PIXELS_PER_DEGREE};

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

/// The images of scikit-image's numbers, 40 x 30 display values of at most 250:
///
/// ```python
/// y, x, c = np.meshgrid(np.arange(30), np.arange(40), np.arange(3), indexing="ij")
/// r = (7*x + 13*y + 50*c + (x*y) % 17) % 251
/// t = np.minimum(250, (r*9) // 10 + (5*x + 3*y + 11*c) % 23)
/// ```
fn test_and_reference() -> [RgbImage; 2] {
    let code = |x: u32, y: u32, c: usize| (7 * x + 13 * y + 50 * c as u32 + (x * y) % 17) % 251;
    let changed = |x: u32, y: u32, c: usize| {
        let changed = code(x, y, c) * 9 / 10 + (5 * x + 3 * y + 11 * c as u32) % 23;
        changed.min(250)
    };
    let image = |code: &dyn Fn(u32, u32, usize) -> u32| {
        RgbImage::from_fn(40, 30, |x, y| {
            std::array::from_fn(|c| radiance_of_code(f64::from(code(x, y, c))))
        })
    };
    [image(&changed), image(&code)]
}

/// What scikit-image 0.24.0 prints, as `float`:
///
/// - `peak_signal_noise_ratio(r, t, data_range=255)`
/// - `structural_similarity(r, t, data_range=255, channel_axis=2, gaussian_weights=True, sigma=1.5,
///   use_sample_covariance=False)`, which leaves out the 5 outermost pixels
/// - the same with `full=True`, images black off the disc `(x - 19)² + (y - 14)² <= 81`, mean of
///   the map over the disc
const SCIKIT_PSNR: f64 = 28.121873567943908;
const SCIKIT_SSIM_INNER: f64 = 0.9661331418064373;
const SCIKIT_SSIM_OF_DISC: f64 = 0.9772170979405683;

#[test]
fn psnr_and_ssim_equal_scikit_image() {
    let [test, reference] = test_and_reference();
    let found = score(&test, &reference, &whole(&test), "psnr");
    assert_relative(found, SCIKIT_PSNR, 1e-12, "psnr");
    // The pixels whose windows are inside count in the upper bin.
    let inner = GrayImage::from_fn(40, 30, |x, y| {
        if (5..35).contains(&x) && (5..25).contains(&y) {
            0.9
        } else {
            0.1
        }
    });
    let mask = whole(&test);
    let comparison =
        Comparison::new(&test, &reference, &mask, LINEAR_CURVE, Epsilon::ABSOLUTE).unwrap();
    let bins = comparison
        .evaluate_bins(&inner, &[0.0, 0.5, 1.0], &[Metric::listed("ssim")])
        .unwrap();
    assert_eq!(bins[1].pixel_count, 30 * 20);
    assert_relative(bins[1].values[0].1, SCIKIT_SSIM_INNER, 1e-12, "ssim inside");
    let disc = GrayImage::from_fn(40, 30, |x, y| {
        let [dx, dy] = [i64::from(x) - 19, i64::from(y) - 14];
        if dx * dx + dy * dy <= 81 { 1.0 } else { 0.0 }
    });
    let found = score(&test, &reference, &disc, "ssim");
    assert_relative(found, SCIKIT_SSIM_OF_DISC, 1e-12, "ssim of a disc");
}

#[test]
fn ssim_of_flat_images_is_its_factor_of_luminance() {
    // Without variance every window, at the edge too, has (2 t r + C1) / (t² + r² + C1).
    let flat = |code: f64| RgbImage::filled(7, 3, [radiance_of_code(code); 3]);
    let [t, r, c1] = [100.0, 140.0, (0.01f64 * 255.0).powi(2)];
    let found = score(&flat(t), &flat(r), &whole(&flat(t)), "ssim");
    let expected = (2.0 * t * r + c1) / (t * t + r * r + c1);
    assert_relative(found, expected, 1e-9, "flat");
}

#[test]
fn a_better_score_is_a_smaller_error() {
    let [test, reference] = test_and_reference();
    let halfway = RgbImage::from_fn(40, 30, |x, y| {
        std::array::from_fn(|c| 0.5 * (test.get(x, y)[c] + reference.get(x, y)[c]))
    });
    let mask = whole(&test);
    for metric in METRICS {
        let error = |image: &RgbImage| metric.error(score(image, &reference, &mask, metric.name));
        assert!(error(&halfway) < error(&test), "{}", metric.name);
    }
    let decibels = score(&test, &reference, &mask, "psnr");
    let rmse_of_codes = 255.0 * Metric::listed("psnr").error(decibels);
    assert_relative(
        20.0 * (255.0 / rmse_of_codes).log10(),
        decibels,
        1e-12,
        "the error of psnr is the root mean square over the peak",
    );
}
