//! The directional albedo pair in f64, by adaptive cubature over half vectors.

use crate::brdf::{Brdf, MaskingShadowing, g2, reflect, schlick_weight};
use crate::math::quadrature::{Rectangle, Tolerance, integrate_rectangle};
use glam::{DVec2, DVec3};

/// Scales of `f0` and of `f90 = 1` (A and B of the source documents).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dfg {
    pub f0_scale: f64,
    pub f90_scale: f64,
    /// Upper estimate of the absolute error of each.
    pub error: f64,
}

impl Dfg {
    /// `A + B`: the directional albedo for F = 1.
    pub fn albedo(&self) -> f64 {
        self.f0_scale + self.f90_scale
    }
}

/// The pair for `n_dot_v` in (0, 1] and `alpha` in (0, 1].
///
/// Integrates over the unit square of [`Brdf::sample_d`], where every lobe has the same width; half of it, by symmetry in azimuth.
pub fn dfg(model: &dyn Brdf, masking: MaskingShadowing, n_dot_v: f64, alpha: f64) -> Dfg {
    const TOLERANCE: Tolerance = Tolerance { relative: 2e-7, max_part_count: 200_000 };
    let v = DVec3::new(((1.0 - n_dot_v) * (1.0 + n_dot_v)).sqrt(), 0.0, n_dot_v);
    let half = Rectangle { low: DVec2::ZERO, high: DVec2::new(1.0, 0.5) };
    let integral = integrate_rectangle(half, TOLERANCE, |xi| {
        // The corners of the square are checked too; u = 1 is the horizon, where no light is reflected upwards.
        if xi.x >= 1.0 {
            return DVec3::ZERO;
        }
        let h = model.sample_d(xi, alpha);
        let l = reflect(v, h);
        let v_dot_h = v.dot(h);
        if v_dot_h <= 0.0 || l.z <= 0.0 {
            return DVec3::ZERO;
        }
        let weight = 2.0 * g2(model, n_dot_v, l.z, alpha, masking) * v_dot_h / (n_dot_v * h.z);
        DVec3::new(weight, weight * schlick_weight(v_dot_h), 0.0)
    });
    let (albedo, f90_scale) = (integral.value.x, integral.value.y);
    Dfg { f0_scale: albedo - f90_scale, f90_scale, error: integral.error.x }
}
