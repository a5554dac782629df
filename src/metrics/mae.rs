//! Mean absolute error.

use super::mean::{pixel_mean, rgb_mean};
use super::noise::MEAN_ABS_NORMAL;
use super::{Better, Comparison, Description, Metric, ReferenceNoise, Space};

/// `mean |d|`, in radiance.
pub struct Mae;

impl Metric for Mae {
    fn description(&self) -> &'static Description {
        &Description {
            name: "mae",
            space: Space::Linear,
            better: Better::Lower,
            version: 1,
            parameters: &[],
            formula: "mean |d|, in units of radiance",
            power: 1.0,
        }
    }

    fn evaluate(&self, comparison: &Comparison, pixels: &[usize]) -> f64 {
        pixel_mean(pixels, |pixel| {
            let [t, r] = comparison.radiance(pixel);
            rgb_mean(|c| (t[c] - r[c]).abs())
        })
    }

    /// `mean se sqrt(2/π)`.
    fn noise_floor(&self, noise: &ReferenceNoise) -> Option<f64> {
        Some(noise.mean(|_, se| se * MEAN_ABS_NORMAL))
    }
}
