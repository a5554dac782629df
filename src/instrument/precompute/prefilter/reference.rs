//! Prefiltered radiance in f64: exact over the environment's bilinear map.

use super::{Kernel, harmonic};
use crate::base::math::equirect_quadrature::{EquirectQuadrature, Focus};
use crate::base::math::frame::Frame;
use crate::base::math::quadrature::{Bounded, Tolerance};
use glam::DVec3;

/// Integrates `P(r, alpha)` for the unit vector `r` and `alpha` in (0, 1].
pub fn prefilter(
    environment: &EquirectQuadrature,
    kernel: Kernel,
    alpha: f64,
    r: DVec3,
    tolerance: Tolerance,
) -> Bounded {
    let frame = Frame::from_normal(r);
    let norm = harmonic::integrals(kernel.brdf, alpha, 1, |n_dot_l| {
        kernel.weight(alpha, n_dot_l)
    })[0];
    let density = |l: DVec3| {
        let l = frame.to_local(l);
        match kernel.weight(alpha, l.z) {
            0.0 => [0.0],
            weight => [kernel.brdf.d((l + DVec3::Z).normalize(), alpha) * weight],
        }
    };
    environment
        .integrate(
            density,
            Some(Focus {
                direction: r,
                radius: alpha,
                in_widths: None,
            }),
            tolerance,
        )
        .combine([DVec3::splat(1.0 / norm)])
}
