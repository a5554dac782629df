//! Irradiance by normal: `E(n) = ∫ L(l) max(n·l, 0) dl`, radiance × sr. Divided by π it is what a Lambert surface of albedo 1 shows.
//!
//! The map is equirectangular with the project's texel mapping (see `math::equirect`).

#[cfg(feature = "gpu")]
pub mod pass;
pub mod reference;
