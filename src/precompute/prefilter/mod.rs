//! The prefiltered environment: the first factor of the split sum, by direction and perceptual roughness.
//!
//! With `n = v = r` and the weight `n_dot_l` [Karis13]:
//!
//! `P(r, alpha) = ∫ L(l) D(h) n_dot_l dl / ∫ D(h) n_dot_l dl`, `h = normalize(r + l)`,
//!
//! since half vectors of density `D n_dot_h` give l of density `D n_dot_h / (4 v·h) = D/4` at `v = n`. There is one map for each model.
//! Level k holds perceptual roughness `k / (level_count - 1)`; level 0 is the mirror, the environment itself.

pub mod pass;
pub mod reference;

use crate::brdf::{alpha_from_perceptual_roughness, perceptual_roughness_from_alpha};

/// Microfacet width that level `mip` (real, for lookups between levels) holds. Inverse: [`mip_from_alpha`].
pub fn alpha_from_mip(mip: f64, level_count: u32) -> f64 {
    alpha_from_perceptual_roughness(mip / last_mip(level_count))
}

/// Inverse of [`alpha_from_mip`].
pub fn mip_from_alpha(alpha: f64, level_count: u32) -> f64 {
    perceptual_roughness_from_alpha(alpha) * last_mip(level_count)
}

/// A chain of one level would have no rough end to divide by.
fn last_mip(level_count: u32) -> f64 {
    assert!(level_count >= 2, "a prefiltered map needs at least 2 levels, not {level_count}");
    f64::from(level_count - 1)
}
