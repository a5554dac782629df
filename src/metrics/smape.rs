//! Symmetric mean absolute percentage error, as a fraction.

use super::mean::{pixel_mean, rgb_mean};
use super::noise::MEAN_ABS_ERROR;
use super::{Epsilon, Metric, Pooling};

/// `mean |d| / (|t| + |r| + ε)`, below 1, so a firefly moves it by at most one pixel's share.
pub static SMAPE: Metric = Metric {
    version: 2,
    pooling: Pooling::Mean,
    parameters: &[("epsilon_share", Epsilon::SHARE)],
    // To first order in se / r.
    noise_floor: |noise| {
        let epsilon = noise.epsilon().beside_magnitude();
        Some(noise.mean(|r, se| se * MEAN_ABS_ERROR / (2.0 * r + epsilon)))
    },
    ..Metric::linear("smape", "mean |d| / (|t| + |r| + 0.01 m), m as in relmse; below 1", |comparison, pixels| {
        let epsilon = comparison.epsilon().beside_magnitude();
        pixel_mean(pixels, |pixel| {
            let [t, r] = comparison.radiance(pixel);
            rgb_mean(|c| (t[c] - r[c]).abs() / (t[c].abs() + r[c].abs() + epsilon))
        })
    })
};
