//! Nine spherical-harmonic coefficients of the environment's radiance: `L_lm = ∫ L(l) Y_lm(l) dl`.
//!
//! Basis, order and signs are those of `math::spherical_harmonics`, in world axes. Irradiance follows as `E(n) = Σ A_l L_lm Y_lm(n)`;
//! degree 2 keeps it within a few percent for broad light and is off by +6 % at the peak, and negative beyond 110°, for a point light.
//!
//! The integral over a map has three readings: the sum of source document 0, `Σ L Y sin θ 2π²/(W H)` at texel centres, which the device
//! computes; texels as constant patches with their exact solid angle; and the bilinear map that lookups and the reference see.

#[cfg(feature = "gpu")]
pub mod pass;
pub mod reference;

/// By what the coefficients are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// The device's sum over texels.
    Texels,
    /// The integral of the bilinear map, in f64.
    Exact,
}
