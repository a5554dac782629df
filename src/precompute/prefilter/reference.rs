//! Prefiltered radiance in f64: exact over the environment's bilinear map.

use crate::brdf::Brdf;
use crate::math::equirect_quadrature::{EquirectQuadrature, Focus};
use crate::math::frame::Frame;
use crate::math::quadrature::{Bounded, GaussLegendre, Tolerance};
use glam::DVec3;
use std::f64::consts::TAU;

/// `P(r, alpha)` for the unit vector `r` and `alpha` in (0, 1].
pub fn prefilter(
    environment: &EquirectQuadrature,
    model: &dyn Brdf,
    alpha: f64,
    r: DVec3,
    tolerance: Tolerance,
) -> Bounded {
    let frame = Frame::from_normal(r);
    let kernel = |l: DVec3| {
        let l_local = frame.to_local(l);
        [if l_local.z <= 0.0 { 0.0 } else { weight(model, l_local, alpha) }]
    };
    environment
        .integrate(kernel, &[Focus { direction: r, radius: alpha }], tolerance)
        .combine([DVec3::splat(1.0 / weight_integral(model, alpha))])
}

/// `D(h) n_dot_l` for `n = v = (0, 0, 1)`.
fn weight(model: &dyn Brdf, l_local: DVec3, alpha: f64) -> f64 {
    model.d((l_local + DVec3::Z).normalize(), alpha) * l_local.z
}

/// `∫ D(h) n_dot_l dl` over the hemisphere, in `t = ln tan(θ_l/2)`, where a lobe of any width has the same shape.
fn weight_integral(model: &dyn Brdf, alpha: f64) -> f64 {
    // θ_l below 2 exp(-20) holds 1e-11 of the lobe at alpha 0.001; panels of 1/4 leave the 6-point rule at rounding.
    const T_LOW: f64 = -20.0;
    const PANEL_COUNT: u32 = 80;
    let rule = GaussLegendre::<6>::new();
    let step = -T_LOW / f64::from(PANEL_COUNT);
    let panel = |k: u32| {
        let low = T_LOW + f64::from(k) * step;
        rule.integrate(low, low + step, |t| {
            // sin θ = 1/cosh t, cos θ = -tanh t, dω = 2π sin² θ dt.
            let sin_theta = 1.0 / t.cosh();
            TAU * sin_theta * sin_theta * weight(model, DVec3::new(sin_theta, 0.0, -t.tanh()), alpha)
        })
    };
    (0..PANEL_COUNT).map(panel).sum()
}
