//! One bilinear lookup in a small map of irradiance over π.

use super::Diffuse;
use crate::instrument::shade::twin::Twin;

pub const DIFFUSE: Diffuse = Diffuse {
    uses_irradiance_map: true,
    ..Diffuse::plain(
        "irradiance-map",
        "a small map of numerically integrated irradiance",
        Twin::Estimator(|n, light| light.irradiance_over_pi(n)),
    )
};
