//! No diffuse term.

use super::Diffuse;
use crate::shade::NONE;
use crate::shade::twin::Twin;
use glam::DVec3;

pub const DIFFUSE: Diffuse = Diffuse::plain(NONE, "no diffuse term", Twin::Estimator(|_, _| DVec3::ZERO));
