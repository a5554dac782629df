//! Root mean square error.

use super::mean::{pixel_mean, rgb_mean};
use super::{Metric, NoiseEffect, Pooling};

/// `sqrt(mean d²)`, in radiance.
pub static RMSE: Metric = Metric {
    pooling: Pooling::RootMean,
    noise: NoiseEffect::Adds,
    noise_floor: |noise| Some(noise.mean(|_, se| se * se).sqrt()),
    noise_slope: Some(|_, difference, _| -2.0 * difference),
    ..Metric::linear(
        "rmse",
        "sqrt(mean d^2), in units of radiance",
        |comparison, pixels| {
            let square = |pixel| {
                let [t, r] = comparison.radiance(pixel);
                rgb_mean(|c| (t[c] - r[c]).powi(2))
            };
            pixel_mean(pixels, square).sqrt()
        },
    )
};
