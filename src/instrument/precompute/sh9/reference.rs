//! SH9 coefficients in f64, for each reading of the map.

use super::TEXTURE_SIZE;
use crate::base::math::equirect::{direction_from_uv, uv_from_direction};
use crate::base::math::equirect_quadrature::EquirectQuadrature;
use crate::base::math::quadrature::{Estimate, GaussLegendre, Tolerance};
use crate::base::math::spherical_harmonics::{COUNT, basis, irradiance};
use crate::base::pixels::Pixels;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

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

/// Returns the texel of the irradiance texture at a column and row: irradiance over π of the
/// direction at its centre, floored at 0.
fn texture_texel(coefficients: &Sh9, x: u32, y: u32) -> DVec3 {
    let [width, height] = TEXTURE_SIZE.map(f64::from);
    let uv = DVec2::new((f64::from(x) + 0.5) / width, (f64::from(y) + 0.5) / height);
    (irradiance(coefficients, direction_from_uv(uv)) / PI).max(DVec3::ZERO)
}

/// Makes the texture of irradiance over π.
pub fn texture(coefficients: &Sh9) -> Pixels<DVec3> {
    let [width, height] = TEXTURE_SIZE;
    Pixels::from_fn(width, height, |x, y| texture_texel(coefficients, x, y))
}

/// Looks up the texture bilinearly at a unit normal; only the four texels around it are made.
pub fn texture_lookup(coefficients: &Sh9, n: DVec3) -> DVec3 {
    let [width, height] = TEXTURE_SIZE;
    let place = uv_from_direction(n) * DVec2::new(width.into(), height.into()) - 0.5;
    let corner = place.floor();
    let share = place - corner;
    let column = |step: i64| (corner.x as i64 + step).rem_euclid(width.into()) as u32;
    let row = |step: i64| (corner.y as i64 + step).clamp(0, i64::from(height) - 1) as u32;
    let across = |y: i64| {
        let texel = |x: i64| texture_texel(coefficients, column(x), row(y));
        texel(0).lerp(texel(1), share.x)
    };
    across(0).lerp(across(1), share.y)
}

/// Returns the coefficients of the function `n -> f(turn(n))` of a function with coefficients `f`.
pub fn turned(f: &Sh9, turn: impl Fn(DVec3) -> DVec3) -> Sh9 {
    // Products of two functions have degree 4, for which six nodes of z and six azimuths are exact.
    let rule = GaussLegendre::<6>::new();
    let mut sums = Sh9::default();
    for (z, weight) in rule.nodes.iter().zip(rule.weights) {
        for i in 0..6 {
            let (sin, cos) = (f64::from(i) * PI / 3.0).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            let n = DVec3::new(radius * cos, radius * sin, *z);
            let value: DVec3 = f
                .iter()
                .zip(basis(turn(n)))
                .map(|(value, y)| *value * y)
                .sum();
            for (y, sum) in basis(n).iter().zip(&mut sums) {
                *sum += PI / 3.0 * weight * *y * value;
            }
        }
    }
    sums
}
