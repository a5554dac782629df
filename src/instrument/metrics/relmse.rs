//! Relative mean square error \[Rousselle11\].
//!
//! One firefly can decide it: in an image of 5,000 pixels one moved it from 0.018 to 428.
//! `tone_mapped_mse` bounds each pixel.

use super::mean::pixel_mean;
use super::{Epsilon, Metric, NoiseEffect, Pooling};

/// `mean d² / (r² + ε)`; the floor is `mean se² / (r² + ε)`.
pub static RELMSE: Metric = Metric {
    version: 2,
    parameters: &[("epsilon_share", Epsilon::SHARE)],
    power: 2.0,
    pooling: Pooling::Mean,
    noise: NoiseEffect::Adds,
    noise_floor: |noise| Some(noise.mean(|r, se| noise.epsilon().relative(se * se, r))),
    noise_slope: Some(|epsilon, difference, r| {
        let square = epsilon.relative(difference * difference, r);
        -2.0 * epsilon.relative(difference + r * square, r)
    }),
    ..Metric::linear(
        "relmse",
        "mean d^2 / (r^2 + 0.01 m^2), m the mean luminance of the environment as it lights the \
         scene",
        |comparison, pixels| {
            let squares = comparison.relative_squares();
            pixel_mean(pixels, |pixel| squares[pixel])
        },
    )
};
