//! The f64 twins of the pass that projects a map on spherical harmonics.

use glam::{DVec2, DVec3};
use splitsum::base::math::equirect::direction_from_uv;
use splitsum::base::math::quadrature::GaussLegendre;
use splitsum::base::math::spherical_harmonics::{COUNT, basis};
use splitsum::base::pixels::RgbImage;
use std::f64::consts::PI;

/// Integrates texels as constant patches by a Gauss rule, which is exact to rounding: a texel of the
/// harmonics of degree 2 is smooth.
pub fn project_texels(image: &RgbImage) -> [DVec3; COUNT] {
    // 16 nodes integrate cos 2φ over a whole turn to 1e-14.
    let rule = GaussLegendre::<16>::new();
    let nodes = |index: u32, count: u32| {
        let step = 1.0 / f64::from(count);
        std::array::from_fn::<_, 16, _>(|k| {
            let place = (f64::from(index) + 0.5 + 0.5 * rule.nodes[k]) * step;
            (place, 0.5 * step * rule.weights[k])
        })
    };
    let mut coefficients = [DVec3::ZERO; COUNT];
    for row in 0..image.height {
        for column in 0..image.width {
            let mut integrals = [0.0; COUNT];
            for (v, v_weight) in nodes(row, image.height) {
                for (u, u_weight) in nodes(column, image.width) {
                    let weight = u_weight * v_weight * 2.0 * PI * PI * (PI * v).sin();
                    let values = basis(direction_from_uv(DVec2::new(u, v)));
                    (0..COUNT).for_each(|k| integrals[k] += weight * values[k]);
                }
            }
            let radiance = DVec3::from_array(image.get(column, row).map(f64::from));
            (0..COUNT).for_each(|k| coefficients[k] += radiance * integrals[k]);
        }
    }
    coefficients
}

/// Sums `Σ L Y sin θ 2π²/(W H)` at texel centres \[Kim22\].
pub fn project_texel_centers(image: &RgbImage) -> [DVec3; COUNT] {
    let size = DVec2::new(f64::from(image.width), f64::from(image.height));
    let mut coefficients = [DVec3::ZERO; COUNT];
    for (x, y) in (0..image.height).flat_map(|y| (0..image.width).map(move |x| (x, y))) {
        let uv = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) / size;
        let weight = (PI * uv.y).sin() * 2.0 * PI * PI / (size.x * size.y);
        let (radiance, values) = (
            DVec3::from_array(image.get(x, y).map(f64::from)),
            basis(direction_from_uv(uv)),
        );
        (0..COUNT).for_each(|k| coefficients[k] += radiance * weight * values[k]);
    }
    coefficients
}
