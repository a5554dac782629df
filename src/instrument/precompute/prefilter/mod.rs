//! The prefiltered environment: the first factor of the split sum, by direction and perceptual
//! roughness.
//!
//! With `n = v = r` and a weight w, by default `n_dot_l` \[Karis13\]:
//!
//! `P(r, alpha) = ∫ L(l) D(h) w(l) dl / ∫ D(h) w(l) dl`, `h = normalize(r + l)`,
//!
//! since half vectors of density `D n_dot_h` give l of density `D n_dot_h / (4 v·h) = D/4` at `v =
//! n`. Each model has a map. Its [`LevelMapping`] gives the roughness of a level. Level 0 is the
//! mirror, the environment itself, unless a list gives it a width.

pub mod harmonic;
pub mod level_bias;
mod level_mapping;
#[cfg(feature = "gpu")]
pub mod pass;
pub mod reference;
mod weight;

pub use level_mapping::{LEVEL_MAPPINGS, LevelMapping, LevelRule, LevelSpacing};
pub use weight::{Kernel, WEIGHTS, Weight};
