//! Irradiance in f64, exact over the environment's bilinear map.

use crate::base::math::equirect_quadrature::EquirectQuadrature;
use crate::base::math::quadrature::{Bounded, Tolerance};
use glam::DVec3;

/// Integrates `E(n)` for the unit vector `n`, not divided by π.
pub fn irradiance(environment: &EquirectQuadrature, n: DVec3, tolerance: Tolerance) -> Bounded {
    environment
        .integrate(|l| [n.dot(l).max(0.0)], None, tolerance)
        .combine([DVec3::ONE])
}
