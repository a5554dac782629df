//! The split sum [Karis13, eq. 7, 8]: the mean radiance of the lobe for `n = v = r`, times its
//! albedo for constant radiance, `P(r, alpha) (f0 A(n_dot_v, alpha) + B(n_dot_v, alpha))`. Both
//! factors are tables.

use super::Method;
use crate::instrument::brdf::reflect;
use crate::instrument::shade::twin::{SpecularTwin, Twin};

/// A split sum with another lookup of the prefiltered map.
pub(super) const fn shifted(
    name: &'static str,
    title: &'static str,
    about: &'static str,
    twin: SpecularTwin,
) -> Method {
    several(1, name, title, about, twin)
}

/// A split sum of several lookups, without a table of taps.
pub(super) const fn several(
    lookups: u32,
    name: &'static str,
    title: &'static str,
    about: &'static str,
    twin: SpecularTwin,
) -> Method {
    Method {
        lookups,
        uses_dfg: true,
        ..Method::plain(name, title, about, twin)
    }
}

pub const METHOD: Method = Method {
    has_ladder: true,
    ..shifted(
        "split-sum",
        "Split sum (textbook)",
        "prefiltered map (n = v = r, n.l weight) times the DFG table",
        Twin::Estimator(|surface, light, _| {
            light.split_sum(surface, reflect(surface.v, surface.n), surface.alpha)
        }),
    )
};
