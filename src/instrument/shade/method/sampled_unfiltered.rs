//! As `sampled`, with all lookups in the finest level.

use super::Method;
use super::sampled::{self, BY_D, Lookup, estimate};
use crate::instrument::shade::twin::Twin;

pub const METHOD: Method = Method {
    name: "sampled-unfiltered",
    title: "Sampling, unfiltered",
    about: "as sampled, always from the finest level",
    uses_lod_bias: false,
    twin: Twin::Estimator(|surface, light, samples| {
        estimate(surface, light, samples, Lookup::Finest, BY_D)
    }),
    ..sampled::METHOD
};
