//! Nine spherical-harmonic coefficients per pixel [Ramamoorthi01, eq. 7, over π]; floored at 0,
//! since degree 2 rings.

use super::Diffuse;
use crate::base::math::spherical_harmonics::irradiance;
use crate::instrument::precompute::sh9::Projection;
use crate::instrument::precompute::sh9::reference::texture_lookup;
use crate::instrument::shade::twin::{DiffuseTwin, Twin};
use glam::DVec3;
use std::f64::consts::PI;

pub const DIFFUSE: Diffuse = Diffuse {
    sh9: Some(Projection::OverTexels),
    ..Diffuse::plain(
        "sh9",
        "nine spherical-harmonic coefficients evaluated per pixel",
        TWIN,
    )
};

/// Source document 0's sum.
pub const AT_CENTRES: Diffuse = Diffuse {
    sh9: Some(Projection::AtCentres),
    ..Diffuse::plain(
        "sh9-centres",
        "as sh9, with coefficients summed at texel centres: wrong under maps of few rows",
        TWIN,
    )
};

/// Source document 0's irradiance texture.
pub const TEXTURE: Diffuse = Diffuse {
    sh9: Some(Projection::OverTexels),
    uses_sh9_texture: true,
    ..Diffuse::plain(
        "sh9-texture",
        "as sh9, from a texture of 400x200 texels that a pass evaluates once",
        Twin::Estimator(|n, light| texture_lookup(&light.sh9, n)),
    )
};

const TWIN: DiffuseTwin =
    Twin::Estimator(|n, light| (irradiance(&light.sh9, n) / PI).max(DVec3::ZERO));
