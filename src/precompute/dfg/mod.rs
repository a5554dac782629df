//! Directional albedo of a BRDF model for Schlick's Fresnel: the second factor of the split sum.
//!
//! `∫ f n_dot_l dl = f0 A + B` with `f90 = 1` [Karis13, eq. 8]: with `D(h) n_dot_h` as density of h and `Fc = (1 - v·h)⁵`,
//!
//! `A = E[(1 - Fc) W]`, `B = E[Fc W]`, `W = G2(v, l) (v·h) / (n_dot_v n_dot_h)`, `l = reflect(-v, h)`, W = 0 for `n_dot_l <= 0`.
//!
//! `A + B` is the directional albedo of one scattering for F = 1. There is one table for each model and masking variant: x is n_dot_v,
//! y is perceptual roughness, both at texel centres, so that no texel has `n_dot_v = 0` or `alpha = 0`.

mod albedos;
pub mod pass;
pub mod reference;

pub use albedos::Albedos;

use crate::brdf::{alpha_from_perceptual_roughness, perceptual_roughness_from_alpha};
use crate::pixels::Pixels;
use crate::pixels::lookup::{Wrap, bilinear};
use glam::DVec2;

/// `(n_dot_v, alpha)` at a position of the table, in texels (centres at half integers). Inverse: [`texel_from_parameters`].
pub fn parameters_from_texel(texel: DVec2, size: u32) -> DVec2 {
    let at = texel / f64::from(size);
    DVec2::new(at.x, alpha_from_perceptual_roughness(at.y))
}

/// Inverse of [`parameters_from_texel`].
pub fn texel_from_parameters(parameters: DVec2, size: u32) -> DVec2 {
    DVec2::new(parameters.x, perceptual_roughness_from_alpha(parameters.y)) * f64::from(size)
}

/// (A, B) as looked up in a table.
pub fn lookup(table: &Pixels<DVec2>, n_dot_v: f64, alpha: f64) -> DVec2 {
    let uv = texel_from_parameters(DVec2::new(n_dot_v, alpha), table.width) / f64::from(table.width);
    bilinear(table, uv, Wrap::Clamp, |pair| pair.extend(0.0)).truncate()
}
