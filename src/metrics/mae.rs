//! Mean absolute error.

use super::mean::{pixel_mean, rgb_mean};
use super::noise::MEAN_ABS_ERROR;
use super::{Comparison, Description, Metric, ReferenceNoise};

/// `mean |d|`, in radiance.
pub struct Mae;

impl Metric for Mae {
    fn description(&self) -> &'static Description {
        const DESCRIPTION: Description = Description::linear("mae", "mean |d|, in units of radiance");
        &DESCRIPTION
    }

    fn evaluate(&self, comparison: &Comparison, pixels: &[usize]) -> f64 {
        pixel_mean(pixels, |pixel| {
            let [t, r] = comparison.radiance(pixel);
            rgb_mean(|c| (t[c] - r[c]).abs())
        })
    }

    /// `mean se sqrt(2/π)`.
    fn noise_floor(&self, noise: &ReferenceNoise) -> Option<f64> {
        Some(noise.mean(|_, se| se * MEAN_ABS_ERROR))
    }
}
