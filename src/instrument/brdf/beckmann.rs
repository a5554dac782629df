//! Beckmann: `D = exp(-tan² θ_h / alpha²) / (π alpha² cos⁴ θ_h)` [Walter07, eq. 25], G1 by a
//! rational fit [eq. 27].
//!
//! # Sampling
//!
//! Beckmann's own visible normals \[HeitzDeon14\] have no closed form: Newton's method must invert
//! their distribution. `sampled-vndf` draws them. The reference draws the visible normals of GGX of
//! the same alpha (`shaders/lib/visible_ggx.glsl`). With `s = tan² θ_h / alpha²`, `D / D_ggx =
//! exp(-s) (1 + s)²`, at most `4/e`, and the visible areas differ by at most `√π` (at a grazing
//! view), so weights are at most 2.61.

use super::{Brdf, Widths, g1_rational, sin2_cos2};
use crate::base::glsl::constants::TILT_MIN;
use crate::base::math::erf::erf_inverse;
use crate::base::math::sampling::direction_from_polar;
use glam::{DVec2, DVec3};
use libm::erfc;
use std::f64::consts::PI;

/// Largest slope, in units of alpha: `erfc` there is 4e-20.
const SLOPE_MAX: f64 = 6.5;

#[derive(Debug)]
pub struct Beckmann;

/// Returns `∫ (cos θ - t sin θ) exp(-t²) dt / √π` over t from -∞ to `slope`: the area of the facets
/// up to that slope that a view at polar angle θ sees, for alpha = 1 \[HeitzDeon14\].
fn visible_area_up_to(slope: f64, sin_theta: f64, cos_theta: f64) -> f64 {
    0.5 * (cos_theta * erfc(-slope) + sin_theta * (-slope * slope).exp() / PI.sqrt())
}

/// Returns the area of the microfacets that a view sees, per area of surface: `cos θ / G1`, G1
/// exact; `stretched` is the width times the sine.
fn projected_area(stretched: f64, cos_theta: f64) -> f64 {
    // At the normal the last visible slope is infinite, and erfc(-∞) = 2, exp(-∞) = 0.
    visible_area_up_to(cos_theta / stretched, stretched, cos_theta)
}

impl Brdf for Beckmann {
    fn name(&self) -> &'static str {
        "beckmann"
    }

    fn about(&self) -> &'static str {
        "microfacets with Gaussian slopes; its masking is Walter's rational fit"
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

    /// Computes `2 cos θ / (cos θ (1 + erf a) + alpha sin θ exp(-a²)/√π)`, `a = 1/(alpha tan θ)`
    /// [Walter07, eq. 26].
    fn g1_exact(&self, n_dot_w: f64, alpha: f64) -> f64 {
        if n_dot_w <= 0.0 {
            return 0.0;
        }
        let sin_theta = ((1.0 - n_dot_w) * (1.0 + n_dot_w)).max(0.0).sqrt();
        n_dot_w / projected_area(alpha * sin_theta, n_dot_w)
    }

    /// Samples the model's own visible normals. Of the slopes along and across `v`, in units of
    /// alpha, the first has density `(cos θ - t sin θ) exp(-t²)/√π` up to `cot θ`, the other is
    /// Gaussian \[HeitzDeon14\]. Halley's method inverts the first, starting from the fit of
    /// \[Jakob14\].
    fn sample_vndf(&self, xi: DVec2, v_local: DVec3, widths: Widths) -> DVec3 {
        const STEPS: u32 = 6;
        let across = widths.stretched(v_local).truncate();
        let sin = across.length();
        let cos = v_local.z;
        let end = (cos / sin).min(SLOPE_MAX);
        let area = visible_area_up_to(end, sin, cos);
        let theta = sin.atan2(cos);
        let exponent = 1.0 + theta * (-0.876 + theta * (0.4265 - 0.0594 * theta));
        let guess = 1.0 - erfc(end) - (2.0 - erfc(end)) * (1.0 - xi.x).powf(exponent);
        let guess = guess.clamp(1e-9 - 1.0, 1.0 - 1e-9);
        let mut t = erf_inverse(guess, (1.0 - guess) * (1.0 + guess));
        for _ in 0..STEPS {
            let projected = cos - t * sin;
            if projected <= 0.0 {
                break;
            }
            let step = (visible_area_up_to(t, sin, cos) - xi.x * area)
                / (projected * (-t * t).exp() / PI.sqrt());
            t = (t - step / (1.0 + 0.5 * (step * (2.0 * t + sin / projected)).clamp(-1.5, 1.5)))
                .clamp(-SLOPE_MAX, end);
        }
        // Infinite at 2/3, which no net of points contains; most contain 0.
        let turn = (xi.y + 1.0 / 3.0).fract();
        let y = erf_inverse(2.0 * turn - 1.0, (4.0 * turn * (1.0 - turn)).max(1e-13));
        let along = if v_local.truncate().length() > f64::from(TILT_MIN) {
            across / sin
        } else {
            DVec2::X
        };
        let slope = widths.0 * (t * along + y * along.perp());
        DVec3::new(-slope.x, -slope.y, 1.0).normalize()
    }

    /// Computes `G1(v) D / (4 n_dot_v)` with the exact G1.
    fn pdf_vndf_l(&self, v_local: DVec3, h_local: DVec3, widths: Widths) -> f64 {
        let visible = v_local.dot(h_local) > 0.0;
        let area = projected_area(widths.stretched(v_local).truncate().length(), v_local.z);
        if visible {
            widths.d(self, h_local) / (4.0 * area)
        } else {
            0.0
        }
    }

    /// Samples `tan² θ = -alpha² ln(1 - u)` [Walter07, eq. 28].
    fn sample_d(&self, xi: DVec2, alpha: f64) -> DVec3 {
        let tan2 = -alpha * alpha * (-xi.x).ln_1p();
        let cos_theta = 1.0 / (1.0 + tan2).sqrt();
        direction_from_polar(tan2.sqrt() * cos_theta, cos_theta, xi.y)
    }
}
