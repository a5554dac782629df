//! The metric of structural similarity; [`map`] holds its formula.

pub(super) mod map;

use super::mean::pixel_mean;
use super::{Better, Metric, Space};
use map::WINDOW_SIGMA;

/// Mean of the SSIM map, in [-1, 1]; 1 for equal images.
pub static SSIM: Metric = Metric {
    space: Space::Display,
    better: Better::Higher,
    parameters: &[("window", 11.0), ("sigma", WINDOW_SIGMA), ("k1", 0.01), ("k2", 0.03)],
    error: |score| 1.0 - score,
    ..Metric::linear(
        "ssim",
        "mean structural similarity (Wang et al. 2004) of the 8-bit luma, 11x11 Gaussian window, sigma 1.5",
        |comparison, pixels| {
            let map = comparison.ssim();
            pixel_mean(pixels, |pixel| map.data[pixel])
        },
    )
};
