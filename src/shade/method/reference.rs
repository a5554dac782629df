//! The unbiased estimator of the specular integral, by many random samples of BRDF and environment; `shade::reference` integrates it.

use super::Method;
use crate::shade::REFERENCE;
use crate::shade::reference::integrate;
use crate::shade::twin::Twin;

pub const METHOD: Method = Method {
    uses_samples: true,
    lobe: Some("specular"),
    ..Method::plain(
        REFERENCE,
        "unbiased: BRDF and environment sampling combined, many samples, unfiltered",
        Twin::Mean(|environment, surface, _, tolerance| integrate(environment, surface, tolerance).specular),
    )
};
