//! Widths of the levels of engines by formulas of which no [`LevelMapping`] is one: their last level is
//! wider than the BRDF's widest.
//!
//! [`LevelMapping`]: crate::instrument::precompute::prefilter::LevelMapping

use crate::base::names::listed;

/// A formula of the width of level k of n.
#[derive(Debug)]
pub struct LevelLaw {
    pub name: &'static str,
    /// Returns alpha at `k/(n - 1)`.
    alpha: fn(f64) -> f64,
}

/// Every formula.
pub static LEVEL_LAWS: &[LevelLaw] = &[LevelLaw {
    // `mx_latlong_lod_to_alpha` of mx_generate_prefilter_env.glsl, MaterialX 1.39.5.
    name: "materialx",
    alpha: |x| if x < 0.5 { x * x } else { 2.0 * (x - 0.375) },
}];

listed!(LevelLaw, "law of level widths", LEVEL_LAWS);

impl LevelLaw {
    /// Returns the width of each of `count` levels.
    pub fn alphas(&self, count: usize) -> Vec<f64> {
        let last = (count.max(2) - 1) as f64;
        (0..count).map(|k| (self.alpha)(k as f64 / last)).collect()
    }
}
