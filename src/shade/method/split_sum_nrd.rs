//! The split sum, looked up along `normalize(mix(n, r, t))`, `t = (1 - n·v)^10.8649 (1 - k) + k, k = 0.298475 ln(39.4115 - 39.0029 √alpha)`.
//!
//! A fit to the peak of GGX with correlated masking [Lagarde14, listing 21], kept in NRD (`_NRD_GetSpecularDominantFactor`, `NRD.hlsli`), a
//! denoiser that follows the reflected point by it. Its roughness is the perceptual one.

use super::Method;
use super::split_sum::shifted;
use crate::brdf::perceptual_roughness_from_alpha;
use crate::shade::twin::Twin;

pub const METHOD: Method = shifted(
    "split-sum-nrd",
    "the shift of NRD: a fit over n.v and roughness [Lagarde14, listing 21]",
    Twin::Estimator(|surface, light, _| light.split_sum_between(surface, share_of_r)),
);

/// t of the module's text, by n·v and alpha.
fn share_of_r(n_dot_v: f64, alpha: f64) -> f64 {
    let k = 0.298475 * (39.4115 - 39.0029 * perceptual_roughness_from_alpha(alpha)).ln();
    // Rounding may leave n·v above 1.
    ((1.0 - n_dot_v).max(0.0).powf(10.8649) * (1.0 - k) + k).clamp(0.0, 1.0)
}
