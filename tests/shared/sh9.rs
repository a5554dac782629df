//! The f64 twin of the pass that projects a map on spherical harmonics.

use glam::{DVec2, DVec3};
use splitsum::base::math::equirect::direction_from_uv;
use splitsum::base::math::spherical_harmonics::{COUNT, basis};
use splitsum::base::pixels::RgbImage;
use std::f64::consts::PI;

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
