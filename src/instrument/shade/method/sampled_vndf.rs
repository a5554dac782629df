//! As `sampled`, with half vectors that the view sees: each lookup is filtered by the density of
//! its own direction.
//!
//! The weight is `F G2 D / (4 n_dot_v pdf_l)`, at most `G2/G1(v)` for the model's own visible
//! normals. GGX draws from a cap that excludes most samples below the horizon [Dupuy23,
//! EtoTokuyoshi23], Beckmann by inversion [HeitzDeon14, Jakob14]. Phong has no known sampler: it
//! draws the visible normals of GGX and weighs by `D/D_ggx`, at most 4/e.

use super::Method;
use super::sampled::{self, BY_VNDF, Lookup, estimate};
use crate::instrument::shade::twin::Twin;

pub const METHOD: Method = Method {
    name: "sampled-vndf",
    title: "Sampling of visible normals",
    about: "as sampled, by visible normals: GGX in a bounded spherical cap, Beckmann by inversion, \
            Phong as GGX",
    twin: Twin::Estimator(|surface, light, samples| {
        estimate(surface, light, samples, Lookup::Filtered, BY_VNDF)
    }),
    ..sampled::METHOD
};
