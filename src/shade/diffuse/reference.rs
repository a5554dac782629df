//! The unbiased estimator of the irradiance, by many random samples of cosine and environment; `shade::reference` integrates it.

use super::Diffuse;
use crate::shade::REFERENCE;
use crate::shade::reference::integrate;
use crate::shade::twin::Twin;

pub const DIFFUSE: Diffuse = Diffuse {
    name: REFERENCE,
    about: "unbiased: cosine and environment sampling combined, many samples",
    twin: Twin::Mean(|environment, surface, _, tolerance| integrate(environment, surface, tolerance).diffuse),
    uses_irradiance_map: false,
    uses_sh9: false,
};
