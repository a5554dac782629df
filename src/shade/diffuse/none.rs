//! No diffuse term.

use super::Diffuse;
use crate::shade::NONE;
use crate::shade::twin::Twin;
use glam::DVec3;

pub const DIFFUSE: Diffuse = Diffuse {
    name: NONE,
    about: "no diffuse term",
    twin: Twin::Estimator(|_, _| DVec3::ZERO),
    uses_irradiance_map: false,
    uses_sh9: false,
};
