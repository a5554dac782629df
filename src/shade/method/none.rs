//! No specular term.

use super::Method;
use crate::shade::NONE;
use crate::shade::twin::Twin;
use glam::DVec3;

pub const METHOD: Method = Method::plain(NONE, "no specular term", Twin::Estimator(|_, _, _| DVec3::ZERO));
