//! One bilinear lookup in a small map of irradiance over π.

use super::Diffuse;
use crate::shade::twin::Twin;

pub const DIFFUSE: Diffuse = Diffuse {
    name: "irradiance-map",
    about: "a small map of numerically integrated irradiance",
    twin: Twin::Estimator(|n, light| light.irradiance_over_pi(n)),
    uses_irradiance_map: true,
    uses_sh9: false,
};
