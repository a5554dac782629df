//! Root mean square error.

use super::mean::{pixel_mean, rgb_mean};
use super::{Comparison, Description, Metric, ReferenceNoise};

/// `sqrt(mean d²)`, in radiance.
pub struct Rmse;

impl Metric for Rmse {
    fn description(&self) -> &'static Description {
        const DESCRIPTION: Description = Description::linear("rmse", "sqrt(mean d^2), in units of radiance");
        &DESCRIPTION
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
