//! The split sum, looked up along `normalize(mix(n, r, t))`, `t = (√(1 - alpha) + alpha) min(1, (1 - alpha)² + (1 - alpha) (n·v)²)`.
//!
//! `GetSpecularDominantDir` of Unity (`com.unity.render-pipelines.core/ShaderLibrary/ImageBasedLighting.hlsl`). It is Frostbite's, bent further to the
//! normal at grazing views; the original stays there behind `USE_FB_DSD`.

use super::Method;
use super::split_sum::shifted;
use crate::shade::twin::Twin;

pub const METHOD: Method = shifted(
    "split-sum-unity",
    "the shifted lookup of Unity's high-definition pipeline",
    Twin::Estimator(|surface, light, _| light.split_sum_between(surface, share_of_r)),
);

/// t of the module's text, by n·v and alpha.
fn share_of_r(n_dot_v: f64, alpha: f64) -> f64 {
    let smoothness = 1.0 - alpha;
    (smoothness.sqrt() + alpha) * (smoothness * smoothness + smoothness * n_dot_v * n_dot_v).min(1.0)
}
