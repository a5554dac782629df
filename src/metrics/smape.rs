//! Symmetric mean absolute percentage error, as a fraction.

use super::mean::{pixel_mean, rgb_mean};
use super::noise::MEAN_ABS_ERROR;
use super::{Comparison, Description, Epsilon, Metric, ReferenceNoise};

/// `mean |d| / (|t| + |r| + ε)`, below 1, so a firefly moves it by at most one pixel's share.
pub struct Smape;

impl Metric for Smape {
    fn description(&self) -> &'static Description {
        const DESCRIPTION: Description = Description {
            version: 2,
            parameters: &[("epsilon_share", Epsilon::SHARE)],
            ..Description::linear("smape", "mean |d| / (|t| + |r| + 0.01 m), m as in relmse; below 1")
        };
        &DESCRIPTION
    }

    fn evaluate(&self, comparison: &Comparison, pixels: &[usize]) -> f64 {
        let epsilon = comparison.epsilon().beside_magnitude();
        pixel_mean(pixels, |pixel| {
            let [t, r] = comparison.radiance(pixel);
            rgb_mean(|c| (t[c] - r[c]).abs() / (t[c].abs() + r[c].abs() + epsilon))
        })
    }

    /// `mean se sqrt(2/π) / (2r + ε)`, to first order in se / r.
    fn noise_floor(&self, noise: &ReferenceNoise) -> Option<f64> {
        let epsilon = noise.epsilon().beside_magnitude();
        Some(noise.mean(|r, se| se * MEAN_ABS_ERROR / (2.0 * r + epsilon)))
    }
}
