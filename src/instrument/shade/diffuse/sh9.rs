//! Nine spherical-harmonic coefficients per pixel [Ramamoorthi01, eq. 7, over π]; floored at 0,
//! since degree 2 rings.

use super::Diffuse;
use crate::base::math::spherical_harmonics::irradiance;
use crate::instrument::shade::twin::Twin;
use glam::DVec3;
use std::f64::consts::PI;

pub const DIFFUSE: Diffuse = Diffuse {
    uses_sh9: true,
    ..Diffuse::plain(
        "sh9",
        "nine spherical-harmonic coefficients evaluated per pixel",
        Twin::Estimator(|n, light| (irradiance(&light.sh9, n) / PI).max(DVec3::ZERO)),
    )
};
