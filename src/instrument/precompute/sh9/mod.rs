//! Nine spherical-harmonic coefficients of the environment's radiance: `L_lm = ∫ L(l) Y_lm(l) dl`.
//!
//! Basis, order and signs follow `math::spherical_harmonics`, in world axes. Irradiance is `E(n) =
//! Σ A_l L_lm Y_lm(n)`. Degree 2 keeps it within a few per cent for broad light; for a point light
//! it errs by +6 % at the peak and is negative beyond 110°.
//!
//! The integral over a map can be read in three ways: the sum `Σ L Y sin θ 2π²/(W H)` at texel
//! centres \[Kim22\], which the device computes; texels as constant patches with exact solid
//! angles; and the bilinear map of lookups and the reference.

#[cfg(feature = "gpu")]
pub mod pass;
pub mod reference;
