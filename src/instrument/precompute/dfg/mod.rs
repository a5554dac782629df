//! Directional albedo of a BRDF model for Schlick's Fresnel: the second factor of the split sum.
//!
//! `∫ f n_dot_l dl = f0 A + B` with `f90 = 1` [Karis13, eq. 8]. With `D(h) n_dot_h` as density of h
//! and `Fc = (1 - v·h)⁵`,
//!
//! `A = E[(1 - Fc) W]`, `B = E[Fc W]`, `W = G2(v, l) (v·h) / (n_dot_v n_dot_h)`, `l = reflect(-v,
//! h)`, W = 0 for `n_dot_l <= 0`.
//!
//! `A + B` is the directional albedo of single scattering for F = 1. Each model and masking has a
//! table, with n_dot_v along x and alpha along y; [`DfgAxes`] defines the positions of its texels.

mod albedos;
pub mod chebyshev;
#[cfg(feature = "gpu")]
pub mod pass;
pub mod reference;

pub use albedos::Albedos;

use crate::base::glsl::constants::{ALPHA_MIN, COSINE_MIN};
use crate::base::pixels::Pixels;
use crate::base::pixels::lookup::{Wrap, bilinear};
use crate::instrument::brdf::{alpha_from_perceptual_roughness, perceptual_roughness_from_alpha};
use glam::DVec2;

/// Positions of a table's texels. The discriminants are `glsl::constants::DFG_AXES_*`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DfgAxes {
    /// Evenly in the fourth roots of n_dot_v and alpha, from the smallest shaded values to 1, both
    /// ends included: A and B bend most where both are small, and no lookup lies beyond the
    /// outermost texels.
    #[default]
    FourthRoots = 0,
    /// Evenly in n_dot_v and perceptual roughness, at texel centres, as in engines. Lookups at the
    /// edges are clamped.
    Centres = 1,
}

impl DfgAxes {
    /// Returns `(n_dot_v, alpha)` at a position in texels (centres at half integers). Inverse:
    /// [`Self::texel`].
    pub fn parameters(self, texel: DVec2, side: u32) -> DVec2 {
        match self {
            Self::FourthRoots => {
                let low = Self::least_roots();
                let roots = low + (1.0 - low) * (texel - 0.5) / (f64::from(side) - 1.0);
                (roots * roots) * (roots * roots)
            }
            Self::Centres => {
                let uv = texel / f64::from(side);
                DVec2::new(uv.x, alpha_from_perceptual_roughness(uv.y))
            }
        }
    }

    /// Inverse of [`Self::parameters`].
    pub fn texel(self, parameters: DVec2, side: u32) -> DVec2 {
        let DVec2 {
            x: n_dot_v,
            y: alpha,
        } = parameters;
        match self {
            Self::FourthRoots => {
                let low = Self::least_roots();
                let position =
                    (DVec2::new(n_dot_v.sqrt().sqrt(), alpha.sqrt().sqrt()) - low) / (1.0 - low);
                position * (f64::from(side) - 1.0) + 0.5
            }
            Self::Centres => {
                DVec2::new(n_dot_v, perceptual_roughness_from_alpha(alpha)) * f64::from(side)
            }
        }
    }

    /// Looks up (A, B) in a table, bilinearly.
    pub fn lookup(self, table: &Pixels<DVec2>, n_dot_v: f64, alpha: f64) -> DVec2 {
        let uv = self.texel(DVec2::new(n_dot_v, alpha), table.width) / f64::from(table.width);
        bilinear(table, uv, Wrap::CLAMP, |pair| pair.extend(0.0)).truncate()
    }

    fn least_roots() -> DVec2 {
        DVec2::new(COSINE_MIN.into(), ALPHA_MIN.into()).powf(0.25)
    }
}
