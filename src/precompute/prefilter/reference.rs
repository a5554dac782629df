//! Prefiltered radiance in f64: exact over the environment's bilinear map, and as the device estimates it.

use super::{Kernel, harmonic};
use crate::brdf::reflect;
use crate::environment::layout::{FilteredMap, lod_from_solid_angles};
use crate::math::equirect_quadrature::{EquirectQuadrature, Focus};
use crate::math::frame::Frame;
use crate::math::quadrature::{Bounded, Tolerance};
use glam::{DVec2, DVec3};

/// Integrates `P(r, alpha)` for the unit vector `r` and `alpha` in (0, 1].
pub fn prefilter(
    environment: &EquirectQuadrature,
    kernel: Kernel,
    alpha: f64,
    r: DVec3,
    tolerance: Tolerance,
) -> Bounded {
    let frame = Frame::from_normal(r);
    let norm = harmonic::integrals(kernel.brdf, alpha, 1, |n_dot_l| kernel.weight(alpha, n_dot_l))[0];
    environment
        .integrate(
            |l: DVec3| [density(kernel, frame.to_local(l), alpha)],
            &[Focus { direction: r, radius: alpha }],
            tolerance,
        )
        .combine([DVec3::splat(1.0 / norm)])
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
