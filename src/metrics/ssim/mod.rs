//! The metric of structural similarity; [`map`] holds its formula.

pub(super) mod map;

use super::mean::pixel_mean;
use super::{Better, Comparison, Description, Metric, Space};
use map::WINDOW_SIGMA;

/// Mean of the SSIM map, in [-1, 1]; 1 for equal images.
pub struct Ssim;

impl Metric for Ssim {
    fn description(&self) -> &'static Description {
        const DESCRIPTION: Description = Description {
            space: Space::Display,
            better: Better::Higher,
            parameters: &[("window", 11.0), ("sigma", WINDOW_SIGMA), ("k1", 0.01), ("k2", 0.03)],
            ..Description::linear(
                "ssim",
                "mean structural similarity (Wang et al. 2004) of the 8-bit luma, 11x11 Gaussian window, sigma 1.5",
            )
        };
        &DESCRIPTION
    }

    fn evaluate(&self, comparison: &Comparison, pixels: &[usize]) -> f64 {
        let map = comparison.ssim();
        pixel_mean(pixels, |pixel| map.data[pixel])
    }

    fn error(&self, score: f64) -> f64 {
        1.0 - score
    }
}
