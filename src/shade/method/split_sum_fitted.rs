//! The split sum along the first moment m of the lobe, at the width closest to it: `P(m, a) (f0 A + B)` with
//! `a = argmin ∫ K_a² - 2 ∫ ŵ K_a(·, m)`, K_a the normalised kernel of the prefiltered map, ŵ the normalised lobe.
//!
//! That is the least expected squared error under light that is white noise over the sphere: no environment enters.

use super::Method;
use super::split_sum::shifted;
use crate::precompute::lobe_shape::Objective;
use crate::shade::twin::Twin;

pub const METHOD: Method = Method {
    uses_lobe_shapes: true,
    ..shifted(
        "split-sum-fitted",
        "the split sum along the first moment of the lobe at the width of least squared error, by a table",
        Twin::Estimator(|surface, light, _| light.fitted_split_sum(surface, Objective::Square)),
    )
};
