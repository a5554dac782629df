//! Point sets and mappings of the unit square that need no BRDF.
//!
//! By convention `xi.x` drives the polar angle and is 0 at the lobe's centre; `xi.y` drives the
//! azimuth, `φ = 2π xi.y`.

use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Returns van der Corput's radical inverse of `i` in base 2, in [0, 1). Exact: 32 bits fit an f64.
pub fn radical_inverse_2(i: u32) -> f64 {
    f64::from(i.reverse_bits()) / 4_294_967_296.0
}

/// Returns point `i` of the Hammersley set of `count` points, `((i + 1/2)/count,
/// radical_inverse_2(i))`.
///
/// The half keeps `xi.x` off 0 and 1, where the lobes' mappings are singular.
pub fn hammersley(i: u32, count: u32) -> DVec2 {
    DVec2::new(
        (f64::from(i) + 0.5) / f64::from(count),
        radical_inverse_2(i),
    )
}

/// Returns the unit vector of azimuth `2π xi_azimuth`, given sine and cosine of its polar angle.
pub fn direction_from_polar(sin_theta: f64, cos_theta: f64, xi_azimuth: f64) -> DVec3 {
    let (sin_phi, cos_phi) = (TAU * xi_azimuth).sin_cos();
    DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}
