//! The split sum, looked up along `normalize(mix(n, r, t))`, `t = 1 - alpha`.
//!
//! three.js (`envmap_physical_pars_fragment.glsl.js`: the square of perceptual roughness), and Godot after it (`scene_forward_clustered.glsl`).

use super::Method;
use super::split_sum::shifted;
use crate::shade::twin::Twin;

pub const METHOD: Method = shifted(
    "split-sum-godot",
    "Godot's and three.js' shifted lookup: r to n by alpha",
    Twin::Estimator(|surface, light, _| light.split_sum_between(surface, share_of_r)),
);

/// t of the module's text, by n·v and alpha.
fn share_of_r(_: f64, alpha: f64) -> f64 {
    1.0 - alpha
}
