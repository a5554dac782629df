//! Nine coefficients under a Hann window: degree l has the weight `(1 + cos(π l/w))/2`, w = [`SH9_WINDOW`] \[Sloan08\].
//!
//! Opposite to a small lamp, `sh9` rings to -3.7 % of its peak before it is floored at 0, this method to -2.3 %. In
//! return it blurs: light linear in direction loses 1/15 of its slope.

use super::Diffuse;
use crate::glsl::constants::SH9_WINDOW;
use crate::math::spherical_harmonics::{COUNT, DEGREE, irradiance};
use crate::shade::twin::Twin;
use glam::DVec3;
use std::f64::consts::PI;

pub const DIFFUSE: Diffuse = Diffuse {
    uses_sh9: true,
    ..Diffuse::plain(
        "sh9-windowed",
        "nine spherical-harmonic coefficients under a Hann window of width 6, against ringing",
        Twin::Estimator(|n, light| irradiance_over_pi(&light.sh9, n).max(DVec3::ZERO)),
    )
};

/// Returns irradiance over π at a unit normal, not floored.
pub fn irradiance_over_pi(radiance: &[DVec3; COUNT], n: DVec3) -> DVec3 {
    let window = |k: usize| 0.5 + 0.5 * (PI * DEGREE[k] as f64 / f64::from(SH9_WINDOW)).cos();
    irradiance(&std::array::from_fn(|k| window(k) * radiance[k]), n) / PI
}
