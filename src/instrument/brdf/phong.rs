//! Phong: `D = (exponent + 2)/(2π) cos^exponent θ_h` [Walter07, eq. 30] with `exponent = 2/alpha² -
//! 2`, which matches the width of Beckmann at small alpha [Walter07, section 5.2]; G1 by the
//! rational fit.
//!
//! The fit is not the Smith masking of this distribution: at large alpha and grazing views energy
//! is created (directional albedo up to 1.14 at alpha 1, n_dot_v 0.1).
//!
//! docs/conventions.md ("Models") derives its exact Smith masking, `G1 = cos θ / (cos θ (1 - I_x(N,
//! 1/2)/2) + C sin^(2N) θ / (2N - 1))`.
//!
//! # Sampling
//!
//! Phong's visible normals have no known sampler in closed form. `sampled-vndf` and the reference
//! draw GGX's of the same alpha: with `k = 1/alpha² - 1` and `s = sin² θ_h`, `D / D_ggx = (1 - s)^k
//! (1 + k s)²`, at most `4/e` (near `k s = 1`), so weights are bounded. Samples of D itself would
//! hit only a few of the facets that a grazing view sees.

use super::{Brdf, g1_rational, sin2_cos2};
use crate::base::math::incomplete_beta::{gamma_ratio_half, incomplete_beta_half};
use crate::base::math::sampling::direction_from_polar;
use glam::{DVec2, DVec3};
use std::f64::consts::{E, PI, TAU};

#[derive(Debug)]
pub struct Phong;

/// Returns the Phong exponent of a microfacet width in (0, 1]: `2/alpha² - 2`, from ∞ to 0.
pub fn exponent_from_alpha(alpha: f64) -> f64 {
    2.0 / (alpha * alpha) - 2.0
}

impl Brdf for Phong {
    fn name(&self) -> &'static str {
        "phong"
    }

    fn is_stretchable(&self) -> bool {
        false
    }

    fn about(&self) -> &'static str {
        "microfacets of a power of the cosine; its masking is Walter's rational fit, made for \
         Beckmann"
    }

    fn d(&self, h_local: DVec3, alpha: f64) -> f64 {
        if h_local.z <= 0.0 {
            return 0.0;
        }
        let exponent = exponent_from_alpha(alpha);
        let (sin2, _) = sin2_cos2(h_local);
        // Near the normal ln_1p keeps the digits that cos θ = 1 - ε has lost; near the horizon cos
        // θ has them.
        let ln_cos = if sin2 < 0.5 {
            0.5 * (-sin2).ln_1p()
        } else {
            h_local.z.ln()
        };
        (exponent + 2.0) / TAU * (exponent * ln_cos).exp()
    }

    fn g1(&self, n_dot_w: f64, alpha: f64) -> f64 {
        g1_rational(n_dot_w, alpha)
    }

    fn g1_exact(&self, n_dot_w: f64, alpha: f64) -> f64 {
        if n_dot_w <= 0.0 {
            return 0.0;
        }
        let cos_theta = n_dot_w.min(1.0);
        let n = 1.0 / (alpha * alpha);
        // sin^(2N) θ; 0 at the normal, where the logarithm is -∞.
        let sin_2n = (n * (-cos_theta * cos_theta).ln_1p()).exp();
        let grazing = gamma_ratio_half(n) / PI.sqrt() * sin_2n / (2.0 * n - 1.0);
        cos_theta / (cos_theta * (1.0 - 0.5 * incomplete_beta_half(n, cos_theta)) + grazing)
    }

    /// D is at most 4/e times GGX's; GGX shows at most √π times the area.
    fn vndf_weight_max(&self) -> f64 {
        4.0 / E * PI.sqrt()
    }

    /// Samples `cos θ = (1 - u)^(1/(exponent + 2))`, density `D cos θ` [Walter07, section 5.2].
    fn sample_d(&self, xi: DVec2, alpha: f64) -> DVec3 {
        // 1/(exponent + 2) = alpha²/2
        let ln_cos2 = alpha * alpha * (-xi.x).ln_1p();
        direction_from_polar((-ln_cos2.exp_m1()).sqrt(), (0.5 * ln_cos2).exp(), xi.y)
    }
}
