//! Root mean square error.

use super::mean::{pixel_mean, rgb_mean};
use super::{Better, Comparison, Description, Metric, ReferenceNoise, Space};

/// `sqrt(mean d²)`, in radiance.
pub struct Rmse;

impl Metric for Rmse {
    fn description(&self) -> &'static Description {
        &Description {
            name: "rmse",
            space: Space::Linear,
            better: Better::Lower,
            version: 1,
            parameters: &[],
            formula: "sqrt(mean d^2), in units of radiance",
            power: 1.0,
        }
    }

    fn evaluate(&self, comparison: &Comparison, pixels: &[usize]) -> f64 {
        let square = |pixel| {
            let [t, r] = comparison.radiance(pixel);
            rgb_mean(|c| (t[c] - r[c]).powi(2))
        };
        pixel_mean(pixels, square).sqrt()
    }

    /// `sqrt(mean se²)`.
    fn noise_floor(&self, noise: &ReferenceNoise) -> Option<f64> {
        Some(noise.mean(|_, se| se * se).sqrt())
    }
}
