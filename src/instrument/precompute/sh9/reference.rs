//! SH9 coefficients in f64, for each reading of the map.

use crate::base::math::equirect_quadrature::EquirectQuadrature;
use crate::base::math::quadrature::{Estimate, Tolerance};
use crate::base::math::spherical_harmonics::{COUNT, basis};
use glam::DVec3;

/// Nine coefficients of radiance, linear RGB.
pub type Sh9 = [DVec3; COUNT];

/// Integrates the bilinear map of lookups. The kernels are smooth, so the bound of 1e-9 is soon
/// met.
pub fn project_bilinear(environment: &EquirectQuadrature) -> Sh9 {
    project_bilinear_bounded(environment).value
}

/// [`project_bilinear`] with its error bounds.
pub fn project_bilinear_bounded(environment: &EquirectQuadrature) -> Estimate<COUNT> {
    environment.integrate(
        basis,
        None,
        Tolerance {
            relative: 1e-9,
            max_part_count: 100_000,
        },
    )
}
