//! SH9 coefficients in f64, for each reading of the map.

use crate::math::equirect::direction_from_uv;
use crate::math::equirect_quadrature::EquirectQuadrature;
use crate::math::quadrature::{Estimate, Tolerance};
use crate::math::spherical_harmonics::{COUNT, basis};
use crate::pixels::RgbImage;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Nine coefficients of radiance, linear RGB.
pub type Sh9 = [DVec3; COUNT];

/// Sums `Σ L Y sin θ 2π²/(W H)` at texel centres \[Kim22\].
pub fn project_texel_centers(image: &RgbImage) -> Sh9 {
    let size = DVec2::new(f64::from(image.width), f64::from(image.height));
    let mut coefficients = [DVec3::ZERO; COUNT];
    for (x, y) in (0..image.height).flat_map(|y| (0..image.width).map(move |x| (x, y))) {
        let uv = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) / size;
        let weight = (PI * uv.y).sin() * 2.0 * PI * PI / (size.x * size.y);
        let (radiance, values) = (DVec3::from_array(image.get(x, y).map(f64::from)), basis(direction_from_uv(uv)));
        (0..COUNT).for_each(|k| coefficients[k] += radiance * weight * values[k]);
    }
    coefficients
}

/// Integrates the bilinear map of lookups. The kernels are smooth, so the bound of 1e-9 is soon met.
pub fn project_bilinear(environment: &EquirectQuadrature) -> Sh9 {
    project_bilinear_bounded(environment).value
}

/// [`project_bilinear`] with its error bounds.
pub fn project_bilinear_bounded(environment: &EquirectQuadrature) -> Estimate<COUNT> {
    environment.integrate(basis, &[], Tolerance { relative: 1e-9, max_part_count: 100_000 })
}
