//! SH9 coefficients in f64, for each reading of the map.

use crate::math::equirect::direction_from_uv;
use crate::math::equirect_quadrature::EquirectQuadrature;
use crate::math::quadrature::{Estimate, GaussLegendre, Tolerance};
use crate::math::spherical_harmonics::{COUNT, basis};
use crate::pixels::RgbImage;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Nine coefficients of radiance, linear RGB.
pub type Sh9 = [DVec3; COUNT];

/// Sums `Σ L Y sin θ 2π²/(W H)` at texel centres \[Kim22\].
pub fn project_texel_centers(image: &RgbImage) -> Sh9 {
    project(image, &GaussLegendre::<1>::new())
}

/// Integrates texels as constant patches, `Σ L ∫_texel Y dω`, by a 6 x 6 point rule in each.
pub fn project_texel_areas(image: &RgbImage) -> Sh9 {
    project(image, &GaussLegendre::<6>::new())
}

/// Integrates the bilinear map of lookups. The kernels are smooth, so the bound of 1e-9 is soon met.
pub fn project_bilinear(environment: &EquirectQuadrature) -> Sh9 {
    project_bilinear_bounded(environment).value
}

/// [`project_bilinear`] with its error bounds.
pub fn project_bilinear_bounded(environment: &EquirectQuadrature) -> Estimate<COUNT> {
    environment.integrate(basis, &[], Tolerance { relative: 1e-9, max_part_count: 100_000 })
}

/// Sums `Σ_texels L Σ_points weight Y sin θ 2π²/(W H)`.
fn project<const N: usize>(image: &RgbImage, rule: &GaussLegendre<N>) -> Sh9 {
    let size = DVec2::new(f64::from(image.width), f64::from(image.height));
    let mut coefficients = [DVec3::ZERO; COUNT];
    for y in 0..image.height {
        for x in 0..image.width {
            let mut texel = [0.0; COUNT];
            for (a, b) in (0..N).flat_map(|a| (0..N).map(move |b| (a, b))) {
                let offset = 0.5 * DVec2::new(rule.nodes[a], rule.nodes[b]) + 0.5;
                let uv = (DVec2::new(f64::from(x), f64::from(y)) + offset) / size;
                let weight =
                    0.25 * rule.weights[a] * rule.weights[b] * (PI * uv.y).sin() * 2.0 * PI * PI / (size.x * size.y);
                let values = basis(direction_from_uv(uv));
                (0..COUNT).for_each(|k| texel[k] += weight * values[k]);
            }
            let radiance = DVec3::from_array(image.get(x, y).map(f64::from));
            (0..COUNT).for_each(|k| coefficients[k] += radiance * texel[k]);
        }
    }
    coefficients
}
