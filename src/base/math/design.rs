//! Surfaces whose normals and views fill both spaces evenly.
//!
//! A sphere under one camera ties n·v to the position on the map: each n·v sees one ring of it.
//! Instead, surface i of N has
//!
//! - the reflected direction r of the spherical Fibonacci lattice: `r.y = 1 - (2 i + 1)/N`, azimuth
//!   `2π i/φ`, φ the golden ratio;
//! - `n·v = frac(1/2 + i/ρ)`, and the azimuth `2π frac(1/2 + i/ρ²)` of the plane of incidence about
//!   r, ρ the plastic number: the R2 sequence \[Roberts18\].
//!
//! A tangent lies at the azimuth `2π frac(1/2 + i √2)` about n from the plane of incidence.
//!
//! So r is even over the sphere, n·v is even over (0, 1), and every range of n·v sees the whole
//! map.

use glam::{DQuat, DVec3};
use std::f64::consts::{SQRT_2, TAU};

/// The real root of x³ = x + 1.
const PLASTIC: f64 = 1.324_717_957_244_746;

/// Returns normal and view of pixel `index` of `count`, unit vectors.
pub fn frame(index: u32, count: u32) -> [DVec3; 2] {
    let i = f64::from(index);
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let y = 1.0 - (2.0 * i + 1.0) / f64::from(count);
    let phi = TAU * (i / golden).fract();
    let horizontal = (1.0 - y * y).sqrt();
    let r = DVec3::new(horizontal * phi.sin(), y, horizontal * phi.cos());
    let n_dot_v = (0.5 + i / PLASTIC).fract();
    let axis = DQuat::from_axis_angle(r, TAU * (0.5 + i / (PLASTIC * PLASTIC)).fract())
        * r.any_orthonormal_vector();
    let n = DQuat::from_axis_angle(axis, n_dot_v.acos()) * r;
    // r is v mirrored in n.
    [n, 2.0 * n_dot_v * n - r]
}

/// Returns the tangent of pixel `index` of `count`, turned counter-clockwise about n by an angle in
/// radians.
pub fn tangent(index: u32, count: u32, turn: f64) -> DVec3 {
    let [n, v] = frame(index, count);
    let azimuth = TAU * (0.5 + f64::from(index) * SQRT_2).fract();
    DQuat::from_axis_angle(n, azimuth + turn) * v.reject_from_normalized(n).normalize()
}
