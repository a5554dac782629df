//! Peak signal-to-noise ratio of the 8-bit display images.

use super::mean::{pixel_mean, rgb_mean};
use super::{Better, Displayed, Metric, Space};

/// Largest 8-bit code value.
const PEAK: f64 = 255.0;

/// `10 log10(255² / mean d²)` in dB, `d` in code values; infinite for equal images.
pub static PSNR: Metric = Metric {
    space: Space::Display,
    better: Better::Higher,
    parameters: &[("peak", PEAK)],
    // Root mean square difference over the peak.
    error: |score| 10f64.powf(-score / 20.0),
    ..Metric::linear(
        "psnr",
        "10 log10(255^2 / mean d^2) in dB of the 8-bit display values; inf when equal",
        |comparison, pixels| {
            let [test, reference] = comparison.display().map(Displayed::image);
            let mse = pixel_mean(pixels, |pixel| {
                let (t, r) = (test.data[pixel].map(f64::from), reference.data[pixel].map(f64::from));
                rgb_mean(|c| (t[c] - r[c]).powi(2))
            });
            10.0 * (PEAK * PEAK / mse).log10()
        },
    )
};
