//! GGX (Trowbridge-Reitz): `D = alpha² / (π (alpha² cos² θ_h + sin² θ_h)²)` [Walter07, eq. 33],
//! `G1 = 2 / (1 + √(1 + alpha² tan² θ))` [Walter07, eq. 34].

use super::{Brdf, Widths, sin2_cos2};
use crate::base::math::sampling::direction_from_polar;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

#[derive(Debug)]
pub struct Ggx;

impl Brdf for Ggx {
    fn name(&self) -> &'static str {
        "ggx"
    }

    fn about(&self) -> &'static str {
        "microfacets with long tails (Trowbridge-Reitz); its masking is exact"
    }

    fn d(&self, h_local: DVec3, alpha: f64) -> f64 {
        if h_local.z <= 0.0 {
            return 0.0;
        }
        let alpha2 = alpha * alpha;
        let (sin2, cos2) = sin2_cos2(h_local);
        let t = alpha2 * cos2 + sin2;
        alpha2 / (PI * t * t)
    }

    fn g1(&self, n_dot_w: f64, alpha: f64) -> f64 {
        if n_dot_w <= 0.0 {
            return 0.0;
        }
        // Multiplied by cos θ: a grazing direction has an infinite tangent.
        let cos2 = n_dot_w * n_dot_w;
        2.0 * n_dot_w / (n_dot_w + (cos2 + alpha * alpha * (1.0 - cos2).max(0.0)).sqrt())
    }

    fn g1_exact(&self, n_dot_w: f64, alpha: f64) -> f64 {
        self.g1(n_dot_w, alpha)
    }

    /// Samples `tan² θ = alpha² u / (1 - u)` [Walter07, eq. 35].
    fn sample_d(&self, xi: DVec2, alpha: f64) -> DVec3 {
        let alpha2 = alpha * alpha;
        let denominator = (1.0 - xi.x) + alpha2 * xi.x;
        direction_from_polar(
            (alpha2 * xi.x / denominator).sqrt(),
            ((1.0 - xi.x) / denominator).sqrt(),
            xi.y,
        )
    }
}

/// Samples visible normals by spherical caps: the normals of the visible half sphere are the half
/// vectors of the cap that the stretched `v` reflects into \[Dupuy23\].
pub(super) fn sample_visible(xi: DVec2, v_local: DVec3, widths: Widths) -> DVec3 {
    let v_standard = widths.stretched(v_local).normalize();
    let z = (1.0 - xi.x) * (1.0 + v_standard.z) - v_standard.z;
    let h = direction_from_polar((1.0 - z * z).max(0.0).sqrt(), z, xi.y) + v_standard;
    widths
        .stretched(h.truncate().extend(h.z.max(0.0)))
        .normalize()
}

/// Computes `G1(v) D / (4 n_dot_v)` [Heitz18, eq. 17]; 0 for normals that face away from `v`.
pub(super) fn pdf_visible_l(v_local: DVec3, h_local: DVec3, widths: Widths) -> f64 {
    if v_local.dot(h_local) <= 0.0 {
        return 0.0;
    }
    // n_dot_v / G1(v), regular at n_dot_v = 0.
    let area = 0.5 * (v_local.z + widths.stretched(v_local).length());
    widths.d(&Ggx, h_local) / (4.0 * area)
}

/// The cap of the stretched sphere with all directions that leave above the horizon
/// \[EtoTokuyoshi23\].
struct BoundedCap {
    v_standard: DVec3,
    /// Length of the stretched `v`.
    length: f64,
    /// The cap ends at `z = -k v_standard.z` [EtoTokuyoshi23, eq. 5].
    k: f64,
    /// `1 - k`, with all its digits.
    rest: f64,
}

impl BoundedCap {
    fn new(v_local: DVec3, widths: Widths) -> Self {
        let stretched = widths.stretched(v_local);
        let length = stretched.length();
        let alpha2 = widths.0.min_element().powi(2);
        let s2 = (1.0 + v_local.x.hypot(v_local.y)).powi(2);
        let denominator = s2 + alpha2 * v_local.z * v_local.z;
        let k = (1.0 - alpha2) * s2 / denominator;
        let rest = alpha2 * (s2 + v_local.z * v_local.z) / denominator;
        Self {
            v_standard: stretched / length,
            length,
            k,
            rest,
        }
    }

    fn height(&self) -> f64 {
        1.0 + self.k * self.v_standard.z
    }
}

/// Samples visible normals by the half vectors of a spherical cap \[Dupuy23\], smaller by
/// [EtoTokuyoshi23, listing 1] so that fewer samples leave below the horizon. `xi.x = 0` is the
/// cap's centre.
pub(super) fn sample_bounded(xi: DVec2, v_local: DVec3, widths: Widths) -> DVec3 {
    let cap = BoundedCap::new(v_local, widths);
    let depth = xi.x * cap.height();
    let radius = (depth * (2.0 - depth)).max(0.0).sqrt();
    let point = direction_from_polar(radius, 0.0, xi.y);
    let across = point + cap.v_standard;
    let z = (1.0 - xi.x) * cap.height() + cap.rest * cap.v_standard.z;
    widths.stretched(across.truncate().extend(z)).normalize()
}

/// Computes `D / (2 (k n_dot_v + t))`, t the length of the stretched `v` [EtoTokuyoshi23, eq. 8]; 0
/// outside the cap.
pub(super) fn pdf_bounded_l(v_local: DVec3, h_local: DVec3, widths: Widths) -> f64 {
    let cap = BoundedCap::new(v_local, widths);
    let h = (h_local.truncate() / widths.0)
        .extend(h_local.z)
        .normalize();
    let v_dot_h = cap.v_standard.dot(h);
    if v_dot_h <= 0.0 || 2.0 * v_dot_h * h.z - cap.v_standard.z < -cap.k * cap.v_standard.z {
        return 0.0;
    }
    widths.d(&Ggx, h_local) / (2.0 * (cap.k * v_local.z + cap.length))
}
