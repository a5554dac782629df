//! Four spherical-harmonic coefficients, and a quadratic zonal part guessed from them \[Roughton24\].
//!
//! All channels share one axis, the direction of the linear part of luminance. With r the ratio of a channel's linear
//! part along it to its constant part, the zonal coefficient is `L00 (0.08 r + 0.6 r²)`, a fit by the authors. It reads
//! four of the nine coefficients. Constant light is exact; linear light is not, since it gets a quadratic part.

use super::Diffuse;
use crate::glsl::constants::{LUMINANCE_BLUE, LUMINANCE_GREEN, LUMINANCE_RED};
use crate::math::spherical_harmonics::{COSINE_LOBE, COUNT, basis};
use crate::shade::twin::Twin;
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

pub const DIFFUSE: Diffuse = Diffuse {
    uses_sh9: true,
    ..Diffuse::plain(
        "zh3",
        "four spherical-harmonic coefficients and a quadratic part guessed from them about the axis of luminance",
        Twin::Estimator(|n, light| irradiance_over_pi(&light.sh9, n).max(DVec3::ZERO)),
    )
};

/// Returns irradiance over π at a unit normal, not floored.
pub fn irradiance_over_pi(radiance: &[DVec3; COUNT], n: DVec3) -> DVec3 {
    let luminance = DVec3::new(LUMINANCE_RED.into(), LUMINANCE_GREEN.into(), LUMINANCE_BLUE.into());
    // Columns along x, y, z: the slope of each channel.
    let [constant, y, z, x] = [radiance[0], radiance[1], radiance[2], radiance[3]];
    let slope = DMat3::from_cols(x, y, z);
    let axis = (slope.transpose() * luminance).normalize_or_zero();
    let along = (slope * axis).abs();
    let zonal = along * (0.08 + 0.6 * along / constant.max(DVec3::splat(1e-30)));
    let at_n = basis(n);
    let first = COSINE_LOBE[0] * at_n[0] * constant + COSINE_LOBE[1] * (at_n[1] * y + at_n[2] * z + at_n[3] * x);
    // The zonal function of degree 2 about the axis is the one about z at the cosine to the axis.
    let cosine = axis.dot(n);
    let about_axis = basis(DVec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine))[6];
    (first + COSINE_LOBE[2] * about_axis * if axis == DVec3::ZERO { DVec3::ZERO } else { zonal }) / PI
}
