//! Structural similarity [Wang04] of display values, each of RGB on its own.
//!
//! Windows are Gaussian, of standard deviation 1.5 and 11 pixels a side; variances are of the whole
//! window (not divided by N - 1). A window beyond the edge sees the outermost pixels again, and
//! pixels off the mask are black, in both images.

use super::filter::Plane;
use super::mean::{pixel_mean, rgb_mean};
use super::psnr::PEAK;
use super::{Better, Metric, Space};
use crate::base::pixels::Rgb8Image;

/// Standard deviation of the window, pixels.
const SIGMA: f64 = 1.5;
const RADIUS: i32 = 5;
/// `C1 = (K1 · peak)²` and `C2 = (K2 · peak)²` keep dark and flat windows stable.
const K1: f64 = 0.01;
const K2: f64 = 0.03;

/// Mean of the map of [`similarities`], in [-1, 1]; 1 for equal images. Its error is `1 - SSIM`.
pub static SSIM: Metric = Metric {
    space: Space::Display,
    better: Better::Higher,
    parameters: &[
        ("sigma", SIGMA),
        ("window", (2 * RADIUS + 1) as f64),
        ("k1", K1),
        ("k2", K2),
        ("range", PEAK),
    ],
    error: |similarity| 1.0 - similarity,
    ..Metric::linear(
        "ssim",
        "mean over the mask and RGB of SSIM (Wang et al. 2004) of the 8-bit display values, each \
         channel on its own, in Gaussian windows; 1 for equal images, at least -1",
        |comparison, pixels| {
            let map = comparison.similarities();
            pixel_mean(pixels, |pixel| map[pixel])
        },
    )
};

/// Computes SSIM at every pixel, the mean over RGB.
pub(super) fn similarities(test: &Rgb8Image, reference: &Rgb8Image) -> Vec<f64> {
    let taps = window();
    let channels: [Vec<f64>; 3] =
        std::array::from_fn(|channel| of_channel([test, reference], channel, &taps));
    (0..test.data.len())
        .map(|pixel| rgb_mean(|channel| channels[channel][pixel]))
        .collect()
}

fn window() -> Vec<f64> {
    let weight = |offset: i32| (-0.5 * (f64::from(offset) / SIGMA).powi(2)).exp();
    let sum: f64 = (-RADIUS..=RADIUS).map(weight).sum();
    (-RADIUS..=RADIUS)
        .map(|offset| weight(offset) / sum)
        .collect()
}

/// SSIM of one channel, [Wang04] equation 13.
fn of_channel(images: [&Rgb8Image; 2], channel: usize, taps: &[f64]) -> Vec<f64> {
    let code = |image: usize, pixel: usize| f64::from(images[image].data[pixel][channel]);
    let width = images[0].width as usize;
    let mean = |value: &dyn Fn(usize) -> f64| {
        let plane = Plane::from_fn(width, images[0].data.len(), value);
        plane.filter_rows(taps).filter_columns(taps).data
    };
    let [t, r] = [0, 1].map(|image| mean(&|pixel| code(image, pixel)));
    let [tt, rr] = [0, 1].map(|image| mean(&|pixel| code(image, pixel).powi(2)));
    let tr = mean(&|pixel| code(0, pixel) * code(1, pixel));
    let [c1, c2] = [K1, K2].map(|k| (k * PEAK).powi(2));
    let similarity = |pixel: usize| {
        let [mean_t, mean_r] = [t[pixel], r[pixel]];
        let squares = mean_t * mean_t + mean_r * mean_r;
        let variances = tt[pixel] + rr[pixel] - squares;
        let covariance = tr[pixel] - mean_t * mean_r;
        (2.0 * mean_t * mean_r + c1) * (2.0 * covariance + c2) / ((squares + c1) * (variances + c2))
    };
    (0..t.len()).map(similarity).collect()
}
