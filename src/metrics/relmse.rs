//! Relative mean square error \[Rousselle11\], plain and trimmed.
//!
//! The plain form is the headline for HDR images, but one firefly can decide it: in an image of 5,000 pixels a single one
//! moved it from 0.018 to 428. The trimmed form drops the largest errors and so hides rare, true ones. Report both.

use super::mean::pixel_mean;
use super::{Comparison, Description, Epsilon, Metric, ReferenceNoise};

/// One pixel in this many is dropped by the trimmed form; a selection of fewer pixels loses none.
const TRIM_ONE_IN: usize = 1000;

/// `mean d² / (r² + ε)`.
pub struct RelMse;

/// The same without the 0.1 % of pixels with the largest error.
pub struct TrimmedRelMse;

impl Metric for RelMse {
    fn description(&self) -> &'static Description {
        const DESCRIPTION: Description = Description {
            version: 2,
            parameters: &[("epsilon_share", Epsilon::SHARE)],
            power: 2.0,
            ..Description::linear(
                "relmse",
                "mean d^2 / (r^2 + 0.01 m^2), m the mean luminance of the environment as it lights the scene",
            )
        };
        &DESCRIPTION
    }

    fn evaluate(&self, comparison: &Comparison, pixels: &[usize]) -> f64 {
        let squares = comparison.relative_squares();
        pixel_mean(pixels, |pixel| squares[pixel])
    }

    /// `mean se² / (r² + ε)`.
    fn noise_floor(&self, noise: &ReferenceNoise) -> Option<f64> {
        Some(mean(&noise.relative_squares()))
    }
}

impl Metric for TrimmedRelMse {
    fn description(&self) -> &'static Description {
        const DESCRIPTION: Description = Description {
            version: 2,
            parameters: &[("epsilon_share", Epsilon::SHARE), ("trimmed_fraction", 1e-3)],
            power: 2.0,
            ..Description::linear(
                "relmse_trimmed",
                "relmse without the floor(pixels/1000) pixels of largest RGB-mean error, over the remaining count",
            )
        };
        &DESCRIPTION
    }

    fn evaluate(&self, comparison: &Comparison, pixels: &[usize]) -> f64 {
        let squares = comparison.relative_squares();
        trimmed_mean(pixels.iter().map(|&pixel| squares[pixel]).collect())
    }

    /// The trimmed mean of the expected square of each pixel. The pixels that are dropped in truth are those where the noise
    /// came out largest, so this is slightly too high (by 1 to 2 %).
    fn noise_floor(&self, noise: &ReferenceNoise) -> Option<f64> {
        Some(trimmed_mean(noise.relative_squares()))
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Mean without the `len / TRIM_ONE_IN` largest values.
fn trimmed_mean(mut values: Vec<f64>) -> f64 {
    let kept = values.len() - values.len() / TRIM_ONE_IN;
    if kept < values.len() {
        values.select_nth_unstable_by(kept, f64::total_cmp);
        values.truncate(kept);
    }
    mean(&values)
}
