//! Relative mean square error \[Rousselle11\], plain and trimmed.
//!
//! One firefly can decide the plain form: in an image of 5,000 pixels one moved it from 0.018 to 428. The trimmed form
//! hides rare, true errors.

use super::mean::pixel_mean;
use super::{Epsilon, Metric, Pooling};

/// The trimmed form drops one pixel in this many.
const TRIM_ONE_IN: usize = 1000;

/// `mean d² / (r² + ε)`; the floor is `mean se² / (r² + ε)`.
pub static RELMSE: Metric = Metric {
    version: 2,
    parameters: &[("epsilon_share", Epsilon::SHARE)],
    power: 2.0,
    pooling: Pooling::Mean,
    noise_floor: |noise| Some(mean(&noise.relative_squares())),
    ..Metric::linear(
        "relmse",
        "mean d^2 / (r^2 + 0.01 m^2), m the mean luminance of the environment as it lights the scene",
        |comparison, pixels| {
            let squares = comparison.relative_squares();
            pixel_mean(pixels, |pixel| squares[pixel])
        },
    )
};

/// The same without the 0.1 % of pixels with the largest error.
pub static TRIMMED: Metric = Metric {
    version: 2,
    parameters: &[("epsilon_share", Epsilon::SHARE), ("trimmed_fraction", 1e-3)],
    power: 2.0,
    // Trims expected squares, which is 1 to 2 % too high: in truth the noisiest pixels are dropped.
    noise_floor: |noise| Some(trimmed_mean(noise.relative_squares())),
    ..Metric::linear(
        "relmse_trimmed",
        "relmse without the floor(pixels/1000) pixels of largest RGB-mean error, over the remaining count",
        |comparison, pixels| {
            let squares = comparison.relative_squares();
            trimmed_mean(pixels.iter().map(|&pixel| squares[pixel]).collect())
        },
    )
};

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Averages without the `len / TRIM_ONE_IN` largest values.
fn trimmed_mean(mut values: Vec<f64>) -> f64 {
    let kept = values.len() - values.len() / TRIM_ONE_IN;
    if kept < values.len() {
        values.select_nth_unstable_by(kept, f64::total_cmp);
        values.truncate(kept);
    }
    mean(&values)
}
