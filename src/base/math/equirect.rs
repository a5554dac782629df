//! The equirectangular mapping of the project: y up, the image's centre is +z, u = 0.25 is +x, row
//! 0 is +y.
//!
//! `u = 0.5 - atan2(x, z) / 2π`, `v = acos(y) / π`; inverse `φ = 2π (0.5 - u)`, `θ = π v`, `d =
//! (sin φ sin θ, cos θ, cos φ sin θ)`. Texel centres lie at `((i + 0.5)/W, (j + 0.5)/H)`; u wraps,
//! v clamps.

use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Maps a direction (any length but 0) to texture coordinates, u in [0, 1), v in [0, 1].
pub fn uv_from_direction(d: DVec3) -> DVec2 {
    let u = 0.5 - d.x.atan2(d.z) / TAU;
    // atan2 keeps full precision near the poles, where acos loses half of the digits.
    let v = d.x.hypot(d.z).atan2(d.y) / PI;
    DVec2::new(u - u.floor(), v)
}

pub fn direction_from_uv(uv: DVec2) -> DVec3 {
    direction_from_angles(longitude(uv.x), polar_angle(uv.y))
}

/// Returns `(sin φ, cos φ)` of a column.
pub fn longitude(u: f64) -> (f64, f64) {
    (TAU * (0.5 - u)).sin_cos()
}

/// Returns `(sin θ, cos θ)` of a row.
pub fn polar_angle(v: f64) -> (f64, f64) {
    (PI * v).sin_cos()
}

/// Returns the unit direction of a [`longitude`] and a [`polar_angle`].
pub fn direction_from_angles(
    (sin_phi, cos_phi): (f64, f64),
    (sin_theta, cos_theta): (f64, f64),
) -> DVec3 {
    DVec3::new(sin_phi * sin_theta, cos_theta, cos_phi * sin_theta)
}

/// Returns the exact solid angle (sr) of each texel of row `row` in a `width` x `height` map.
pub fn texel_solid_angle(row: u32, width: u32, height: u32) -> f64 {
    let theta = |j: u32| PI * f64::from(j) / f64::from(height);
    TAU / f64::from(width) * (theta(row).cos() - theta(row + 1).cos())
}

/// Returns the solid angle (sr) of a texel of a `width` x `height` map at this sine of θ, `2π² sin
/// θ/(W H)`.
///
/// The sine is floored at its value half a texel from a pole: no texel is smaller than in the first
/// row.
pub fn texel_solid_angle_at(sin_theta: f64, width: u32, height: u32) -> f64 {
    let width = f64::from(width);
    let height = f64::from(height);
    2.0 * PI * PI * sin_theta.max(0.5 * PI / height) / (width * height)
}
