//! Mean square error after a tone curve, without rounding: the difference that a display shows.
//!
//! The curve is the default one, `T(L) = (e L / (e L + 1))^(1/2.2)`. The exposure `e` is a share of
//! the reciprocal mean of the light, so scores do not depend on its brightness, and the swept tone
//! curve does not matter.

use super::mean::{pixel_mean, rgb_mean};
use super::{Epsilon, Metric, NoiseEffect, Pooling};
use crate::instrument::tonemap::{DISPLAY_GAMMA, ToneCurve};

/// The exposure times the mean luminance of the light.
const EXPOSURE: f64 = 0.5;

/// `mean (T(t) - T(r))²`.
pub static TONE_MAPPED: Metric = Metric {
    parameters: &[
        ("exposure_times_mean", EXPOSURE),
        ("display_gamma", DISPLAY_GAMMA),
    ],
    power: 2.0,
    pooling: Pooling::Mean,
    noise: NoiseEffect::Adds,
    // Gauss-Legendre quadrature with three nodes over the uniform error; the middle node has no
    // error.
    noise_floor: |noise| {
        let curve = curve(noise.epsilon());
        Some(noise.mean(|r, se| {
            let [low, middle, high] = curve.apply([(r - NODE * se).max(0.0), r, r + NODE * se]);
            NODE_WEIGHT * ((low - middle).powi(2) + (high - middle).powi(2))
        }))
    },
    ..Metric::linear(
        "tone_mapped_mse",
        "mean (T(t) - T(r))^2 after the tone curve T(L) = (e L / (e L + 1))^(1/2.2), e = 0.5 / m, \
         m as in relmse",
        |comparison, pixels| {
            let curve = curve(comparison.epsilon());
            pixel_mean(pixels, |pixel| {
                let [t, r] = comparison
                    .radiance(pixel)
                    .map(|radiance| curve.apply(radiance));
                rgb_mean(|c| (t[c] - r[c]).powi(2))
            })
        },
    )
};

/// The outer node in standard errors: √(3/5) of the largest error, √3.
const NODE: f64 = 1.341_640_786_499_874;
const NODE_WEIGHT: f64 = 5.0 / 18.0;

/// Returns the tone curve under a light.
pub fn curve(epsilon: Epsilon) -> ToneCurve {
    ToneCurve {
        exposure: (EXPOSURE / epsilon.mean()) as f32,
        ..ToneCurve::default()
    }
}
