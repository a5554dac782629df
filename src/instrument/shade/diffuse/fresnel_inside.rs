//! Irradiance with Fresnel's weight inside the integral, `∫ (1 - F(v·h)) n·l/π L dl`, by the passes
//! of the reference.
//!
//! The other diffuse methods weigh irradiance by `1 - (f0 A + B)`, which depends on n·v only and
//! keeps the sum of both terms below 1. This weight depends on l too, and applies with or without a
//! specular term.

use super::Diffuse;
use crate::instrument::shade::reference::integrate;
use crate::instrument::shade::twin::Twin;

pub const DIFFUSE: Diffuse = Diffuse {
    lobe: Some("lambert-fresnel"),
    ..Diffuse::plain(
        "fresnel-inside",
        "as reference, with the weight 1 - F(v.h) inside the integral in place of 1 - (f0 A + B) \
         outside",
        Twin::Mean(|environment, surface, _, tolerance| {
            integrate(environment, surface, tolerance).diffuse_transmitted
        }),
    )
};
