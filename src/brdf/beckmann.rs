//! Beckmann: `D = exp(-tan² θ_h / alpha²) / (π alpha² cos⁴ θ_h)` [Walter07, eq. 25], G1 by the rational fit [Walter07, eq. 27].
//!
//! The sampler draws visible normals of the exact Smith masking, not of the fit: the fit (within 0.35 %) belongs to the model,
//! the exact masking to the density. Weights stay unbiased because [`Brdf::pdf_visible_l`] is the sampler's own density.

use super::{Brdf, g1_rational, sin2_cos2};
use crate::math::erf::{erf_inverse, erfc, monotone_root};
use crate::math::sampling::direction_from_polar;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// The Beckmann model with Walter's rational masking.
#[derive(Debug)]
pub struct Beckmann;

/// Slopes (in units of alpha) beyond it have probability below 1e-18.
const SLOPE_END: f64 = 6.5;

/// `∫ (cos θ - t sin θ) exp(-t²) dt / √π` over t from -∞ to `slope`: the area that a view at polar angle θ sees of the facets up
/// to that slope, for alpha = 1 [HeitzDeon14].
fn visible_area_up_to(slope: f64, sin_theta: f64, cos_theta: f64) -> f64 {
    0.5 * (cos_theta * erfc(-slope) + sin_theta * (-slope * slope).exp() / PI.sqrt())
}

/// Area of the visible microfacets seen at a polar angle, per area of surface: `cos θ / G1` with the exact Smith G1.
fn projected_area(sin_theta: f64, cos_theta: f64, alpha: f64) -> f64 {
    let stretched = alpha * sin_theta;
    // At the normal the last visible slope is infinite, and erfc(-∞) = 2, exp(-∞) = 0.
    visible_area_up_to(cos_theta / stretched, stretched, cos_theta)
}

impl Brdf for Beckmann {
    fn name(&self) -> &'static str {
        "beckmann"
    }

    fn d(&self, h_local: DVec3, alpha: f64) -> f64 {
        if h_local.z <= 0.0 {
            return 0.0;
        }
        let alpha2 = alpha * alpha;
        let (sin2, cos2) = sin2_cos2(h_local);
        (-sin2 / (cos2 * alpha2)).exp() / (PI * alpha2 * cos2 * cos2)
    }

    fn g1(&self, n_dot_w: f64, alpha: f64) -> f64 {
        g1_rational(n_dot_w, alpha)
    }

    /// `2 cos θ / (cos θ (1 + erf a) + alpha sin θ exp(-a²)/√π)`, `a = 1/(alpha tan θ)` [Walter07, eq. 26].
    fn g1_exact(&self, n_dot_w: f64, alpha: f64) -> f64 {
        if n_dot_w <= 0.0 {
            return 0.0;
        }
        let sin_theta = ((1.0 - n_dot_w) * (1.0 + n_dot_w)).max(0.0).sqrt();
        n_dot_w / projected_area(sin_theta, n_dot_w, alpha)
    }

    /// `tan² θ = -alpha² ln(1 - u)` [Walter07, eq. 28].
    fn sample_d(&self, xi: DVec2, alpha: f64) -> DVec3 {
        let tan2 = -alpha * alpha * (-xi.x).ln_1p();
        let cos_theta = 1.0 / (1.0 + tan2).sqrt();
        direction_from_polar(tan2.sqrt() * cos_theta, cos_theta, xi.y)
    }

    /// Visible normals in the space of slopes [HeitzDeon14] [Jakob14]: stretch to alpha = 1, invert the distribution of the
    /// slope along `v` by `xi.x` (numerically; it has no closed inverse) and of the slope across by `xi.y`, stretch back.
    ///
    /// This mapping has no polar angle: as `xi.x` grows, the facets turn from facing `v` to facing away from it.
    fn sample_visible(&self, xi: DVec2, v_local: DVec3, alpha: f64) -> DVec3 {
        let stretched = DVec3::new(alpha * v_local.x, alpha * v_local.y, v_local.z).normalize();
        let sin_theta = stretched.x.hypot(stretched.y);
        let cos_theta = stretched.z;
        let end = if cos_theta < SLOPE_END * sin_theta { cos_theta / sin_theta } else { SLOPE_END };
        let target = xi.x * visible_area_up_to(end, sin_theta, cos_theta);
        let along = monotone_root(-SLOPE_END, end, |slope| {
            let density = (cos_theta - slope * sin_theta) * (-slope * slope).exp() / PI.sqrt();
            (visible_area_up_to(slope, sin_theta, cos_theta) - target, density)
        });
        let across = erf_inverse(2.0 * xi.y - 1.0);
        let azimuth = if sin_theta > 0.0 { DVec2::new(stretched.x, stretched.y) / sin_theta } else { DVec2::X };
        let slope = alpha * (along * azimuth + across * azimuth.perp());
        DVec3::new(-slope.x, -slope.y, 1.0).normalize()
    }

    /// `G1(v) D / (4 n_dot_v)` with the exact Smith G1.
    fn pdf_visible_l(&self, v_local: DVec3, h_local: DVec3, alpha: f64) -> f64 {
        if v_local.dot(h_local) <= 0.0 {
            return 0.0;
        }
        self.d(h_local, alpha) / (4.0 * projected_area(v_local.x.hypot(v_local.y), v_local.z, alpha))
    }
}
