//! Irradiance by normal: `E(n) = ∫ L(l) max(n·l, 0) dl`, radiance × sr. Divided by π it is the radiance of a Lambert
//! surface of albedo 1.

#[cfg(feature = "gpu")]
pub mod pass;
pub mod reference;
