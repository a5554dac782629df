//! Peak signal-to-noise ratio of display values.

use super::mean::{pixel_mean, rgb_mean};
use super::{Better, Metric, Space};

/// The largest display value.
pub(super) const PEAK: f64 = 255.0;

/// `10 log10(255² / mean d²)`, dB, d of 8-bit display values; infinite for equal images. Its error
/// is the root mean square of d over the peak.
pub static PSNR: Metric = Metric {
    space: Space::Display,
    better: Better::Higher,
    parameters: &[("peak", PEAK)],
    error: |decibels| 10f64.powf(-decibels / 20.0),
    ..Metric::linear(
        "psnr",
        "10 log10(255^2 / mean d^2) dB, d the difference of the 8-bit display values, mean over \
         the mask and RGB; infinite for equal images",
        |comparison, pixels| {
            let [test, reference] = comparison.codes();
            let mean_square = pixel_mean(pixels, |pixel| {
                let [t, r] = [test, reference].map(|image| image.data[pixel].map(f64::from));
                rgb_mean(|c| (t[c] - r[c]).powi(2))
            });
            10.0 * (PEAK * PEAK / mean_square).log10()
        },
    )
};
