//! Nine spherical-harmonic coefficients of the environment's radiance: `L_lm = ∫ L(l) Y_lm(l) dl`.
//!
//! Basis, order and signs follow `math::spherical_harmonics`, in world axes. Irradiance is `E(n) =
//! Σ A_l L_lm Y_lm(n)`. Degree 2 keeps it within a few per cent for broad light; for a point light
//! it errs by +6 % at the peak and is negative beyond 110°.
//!
//! The integral over a map can be read in three ways. The device computes two of them
//! ([`Projection`]): texels as constant patches, with the exact integrals of the harmonics over
//! each texel, and the sum `Σ L Y sin θ 2π²/(W H)` at texel centres \[Kim22\]. The third is the
//! bilinear map of lookups and the reference.

#[cfg(feature = "gpu")]
pub mod pass;
pub mod reference;

use crate::base::glsl::constants::{SH9_AT_CENTRES, SH9_OVER_TEXELS};

/// Width and height of the equirectangular texture of irradiance over π, as source document 0's:
/// a bilinear lookup errs by 4e-5 rms of the brightest irradiance, and by at most 1.2e-3, at the
/// poles (`tests/numeric/diffuse.rs`).
pub const TEXTURE_SIZE: [u32; 2] = [400, 200];

/// How a texel counts in the coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Projection {
    /// By the integrals of the harmonics over the texel. A constant map has its constant irradiance
    /// at every size.
    OverTexels = SH9_OVER_TEXELS,
    /// By the harmonics at its centre, times sin θ 2π²/(W H) \[Kim22\]: a constant map of 8 x 4
    /// texels errs by 6 %, one of 512 x 256 by 1e-5.
    AtCentres = SH9_AT_CENTRES,
}
