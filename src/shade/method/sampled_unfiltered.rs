//! As `sampled`, but every lookup reads the finest level.

use super::Method;
use super::sampled::importance_sampled;
use crate::shade::twin::Twin;

pub const METHOD: Method = Method {
    uses_samples: true,
    uses_point_set: true,
    ..Method::plain(
        "sampled-unfiltered",
        "as sampled, always from the finest level",
        Twin::Estimator(|surface, light, samples| importance_sampled(surface, light, samples, false)),
    )
};
