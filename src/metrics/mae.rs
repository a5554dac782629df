//! Mean absolute error.

use super::mean::{pixel_mean, rgb_mean};
use super::noise::MEAN_ABS_ERROR;
use super::{Metric, Pooling};

/// `mean |d|`, in radiance; the floor is `mean se √3/2`.
pub static MAE: Metric = Metric {
    pooling: Pooling::Mean,
    noise_floor: |noise| Some(noise.mean(|_, se| se * MEAN_ABS_ERROR)),
    ..Metric::linear("mae", "mean |d|, in units of radiance", |comparison, pixels| {
        pixel_mean(pixels, |pixel| {
            let [t, r] = comparison.radiance(pixel);
            rgb_mean(|c| (t[c] - r[c]).abs())
        })
    })
};
