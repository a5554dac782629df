//! Real spherical harmonics up to degree 2, in the order, axes and signs of \[Kim22\].
//!
//! Order: `Y00; Y1-1 (y), Y10 (z), Y11 (x); Y2-2 (xy), Y2-1 (yz), Y20 (3z² - 1), Y21 (xz), Y22 (x²
//! - y²)`, with x, y, z world coordinates (y up) and positive constants (no Condon-Shortley phase).
//! The functions are orthonormal on the sphere. Irradiance from the coefficients `L_lm` of
//! radiance: `E(n) = Σ A_l L_lm Y_lm(n)` with `A = π, 2π/3, π/4` \[Ramamoorthi01\].

use glam::DVec3;
use std::f64::consts::PI;

pub const COUNT: usize = 9;

/// Degree `l` of each function.
pub const DEGREE: [usize; COUNT] = [0, 1, 1, 1, 2, 2, 2, 2, 2];

/// `A_l`: the zonal factors of the clamped cosine lobe.
pub const COSINE_LOBE: [f64; 3] = [PI, 2.0 * PI / 3.0, PI / 4.0];

/// Returns the nine functions at the unit vector `d`.
pub fn basis(d: DVec3) -> [f64; COUNT] {
    let c0 = 0.5 / PI.sqrt();
    let c1 = 3f64.sqrt() * c0;
    let c2 = 15f64.sqrt() * c0;
    let c20 = 0.5 * 5f64.sqrt() * c0;
    let DVec3 { x, y, z } = d;
    [
        c0,
        c1 * y,
        c1 * z,
        c1 * x,
        c2 * x * y,
        c2 * y * z,
        c20 * (3.0 * z * z - 1.0),
        c2 * x * z,
        0.5 * c2 * (x * x - y * y),
    ]
}

/// Returns irradiance (radiance × sr) at the unit normal `n`. May be negative: degree 2 rings.
pub fn irradiance(radiance: &[DVec3; COUNT], n: DVec3) -> DVec3 {
    let y = basis(n);
    (0..COUNT)
        .map(|k| radiance[k] * (COSINE_LOBE[DEGREE[k]] * y[k]))
        .sum()
}
