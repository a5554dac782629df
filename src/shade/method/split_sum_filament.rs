//! The split sum, looked up along `normalize(mix(n, r, t))`, `t = 1 - alpha²`.
//!
//! `getSpecularDominantDirection` of Filament (`shaders/src/surface_light_indirect.fs`), which is given alpha, not perceptual roughness.

use super::Method;
use super::split_sum::shifted;
use crate::shade::twin::Twin;

pub const METHOD: Method = shifted(
    "split-sum-filament",
    "Filament's shifted lookup: r to n by alpha^2",
    Twin::Estimator(|surface, light, _| light.split_sum_between(surface, share_of_r)),
);

/// t of the module's text, by n·v and alpha.
fn share_of_r(_: f64, alpha: f64) -> f64 {
    1.0 - alpha * alpha
}
