//! The split sum, looked up along `normalize(mix(n, r, t))`, `t = (1 - alpha) (√(1 - alpha) + alpha)`.
//!
//! The original is Frostbite's [Lagarde14, listing 22]. Bevy has it as `radiance_sample_direction` (`light_probe/environment_map.wesl`, 2026).

use super::Method;
use super::split_sum::shifted;
use crate::shade::twin::Twin;

pub const METHOD: Method = shifted(
    "split-sum-frostbite",
    "Frostbite's shifted lookup [Lagarde14, listing 22]; Bevy's, too",
    Twin::Estimator(|surface, light, _| light.split_sum_between(surface, share_of_r)),
);

/// t of the module's text, by n·v and alpha.
fn share_of_r(_: f64, alpha: f64) -> f64 {
    let smoothness = 1.0 - alpha;
    smoothness * (smoothness.sqrt() + alpha)
}
