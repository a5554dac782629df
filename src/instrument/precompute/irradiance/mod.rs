//! Irradiance by normal, `E(n) = ∫ L(l) max(n·l, 0) dl`: radiance × sr; over π the radiance of a
//! white Lambert surface.

#[cfg(feature = "gpu")]
pub mod pass;
pub mod reference;
