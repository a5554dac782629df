//! The rung of the diffuse ladder before `sh9`: nine exact spherical-harmonic coefficients, `L_lm = ∫ L Y_lm dl`.
//!
//! | rung | irradiance over π | replaces |
//! |---|---|---|
//! | `fresnel-inside` | with Fresnel's weight inside the integral | nothing |
//! | `reference` | `E(n)/π` | Fresnel inside the integral |
//! | | `Σ A_l L_lm Y_lm(n)/π` up to degree 2 | light above degree 2 |
//! | `ladder-clamp` | the same, at least 0 | negative irradiance |
//! | `sh9` | the same, L_lm by a sum over texels | the integrals of the coefficients |
//!
//! From the second rung on, `1 - (f0 A + B)` weighs the irradiance, with A and B from the table. The third has no
//! image, since radiance is not negative; `crate::ladder` and the oracle have its numbers.

use super::Diffuse;
use crate::math::quadrature::{Bounded, Estimate};
use crate::math::spherical_harmonics::{COSINE_LOBE, COUNT, DEGREE, basis, irradiance};
use crate::precompute::sh9::Projection;
use crate::shade::twin::Twin;
use glam::DVec3;
use std::f64::consts::PI;

pub const DIFFUSE: Diffuse = Diffuse {
    sh9: Some(Projection::Exact),
    ..Diffuse::plain(
        "ladder-clamp",
        "sh9 with exact coefficients",
        Twin::Estimator(|n, light| (irradiance(&light.exact_sh9, n) / PI).max(DVec3::ZERO)),
    )
};

/// Returns irradiance over π from nine radiance coefficients, and its bound `Σ |A_l Y_lm(n)| error_lm / π`.
pub fn truncated(sh9: &Estimate<COUNT>, n: DVec3) -> Bounded {
    let y = basis(n);
    let weight = |k: usize| (COSINE_LOBE[DEGREE[k]] * y[k]).abs() / PI;
    Bounded { value: irradiance(&sh9.value, n) / PI, error: (0..COUNT).map(|k| weight(k) * sh9.error[k]).sum() }
}
