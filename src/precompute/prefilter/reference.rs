//! Prefiltered radiance in f64: exact over the environment's bilinear map, and as the device estimates it.

use super::Kernel;
use crate::brdf::reflect;
use crate::environment::layout::{FilteredMap, lod_from_solid_angles};
use crate::math::equirect_quadrature::{EquirectQuadrature, Focus};
use crate::math::frame::Frame;
use crate::math::quadrature::{Bounded, GaussLegendre, Tolerance};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Integrates `P(r, alpha)` for the unit vector `r` and `alpha` in (0, 1].
pub fn prefilter(
    environment: &EquirectQuadrature,
    kernel: Kernel,
    alpha: f64,
    r: DVec3,
    tolerance: Tolerance,
) -> Bounded {
    let frame = Frame::from_normal(r);
    environment
        .integrate(
            |l: DVec3| [density(kernel, frame.to_local(l), alpha)],
            &[Focus { direction: r, radius: alpha }],
            tolerance,
        )
        .combine([DVec3::splat(1.0 / density_integral(kernel, alpha))])
}

/// Estimates it as the device does, from half vectors at `points`. Each lookup reads the level whose texels cover the
/// solid angle of the sample, `1/(N p_l)`, plus `lod_bias`. At least one sample must lie above the horizon.
pub fn estimate(
    environment: &FilteredMap,
    kernel: Kernel,
    alpha: f64,
    r: DVec3,
    points: &[DVec2],
    lod_bias: f64,
) -> DVec3 {
    let frame = Frame::from_normal(r);
    let (mut sum, mut weight_sum) = (DVec3::ZERO, 0.0);
    for point in points {
        let h = kernel.brdf.sample_d(*point, alpha);
        let l_local = reflect(DVec3::Z, h);
        let l = frame.to_world(l_local);
        let omega_s = 4.0 / (points.len() as f64 * kernel.brdf.d(h, alpha));
        let lod = lod_from_solid_angles(omega_s, environment.texel_solid_angle(l, omega_s)) + lod_bias;
        let weight = kernel.weight(alpha, l_local.z);
        sum += weight * environment.value(l, lod);
        weight_sum += weight;
    }
    sum / weight_sum
}

/// `D(h) w(l)` for `n = v = (0, 0, 1)`.
fn density(kernel: Kernel, l_local: DVec3, alpha: f64) -> f64 {
    match kernel.weight(alpha, l_local.z) {
        0.0 => 0.0,
        weight => kernel.brdf.d((l_local + DVec3::Z).normalize(), alpha) * weight,
    }
}

/// Integrates `∫ D(h) w(l) dl` over the hemisphere, in `t = ln tan(θ_l/2)`: lobes of all widths have one shape.
fn density_integral(kernel: Kernel, alpha: f64) -> f64 {
    // θ_l below 2 exp(-20) holds 1e-11 of the lobe at alpha 0.001; with panels of 1/4 the rule is exact to rounding.
    const T_LOW: f64 = -20.0;
    const PANEL_COUNT: u32 = 80;
    let rule = GaussLegendre::<6>::new();
    let step = -T_LOW / f64::from(PANEL_COUNT);
    let panel = |k: u32| {
        let low = T_LOW + f64::from(k) * step;
        rule.integrate(low, low + step, |t| {
            // sin θ = 1/cosh t, cos θ = -tanh t, dω = 2π sin² θ dt.
            let sin_theta = 1.0 / t.cosh();
            TAU * sin_theta * sin_theta * density(kernel, DVec3::new(sin_theta, 0.0, -t.tanh()), alpha)
        })
    };
    (0..PANEL_COUNT).map(panel).sum()
}
