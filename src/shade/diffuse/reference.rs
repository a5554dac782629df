//! The unbiased estimator of the irradiance, by many random samples of cosine and environment; `shade::reference` integrates it.

use super::Diffuse;
use crate::shade::REFERENCE;
use crate::shade::reference::integrate;
use crate::shade::twin::Twin;

pub const DIFFUSE: Diffuse = Diffuse {
    lobe: Some("lambert"),
    ..Diffuse::plain(
        REFERENCE,
        "unbiased: cosine and environment sampling combined, many samples",
        Twin::Mean(|environment, surface, _, tolerance| integrate(environment, surface, tolerance).diffuse),
    )
};
