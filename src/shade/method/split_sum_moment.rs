//! The split sum, looked up along the first moment of the lobe: `P(m, alpha) (f0 A + B)`, m the unit vector along `∫ f n·l l dl`.
//!
//! For light linear in direction, `L = L0 + g·l`, the truth is `W (L0 + ρ g·m)`, ρ the moment's length over `W = f0 A + B`. A lookup gives
//! `W (L0 + c g·d)`, c the mean cosine of the map's kernel. So along m it errs by `W (c - ρ) g·m` only, whatever g is.

use super::Method;
use super::split_sum::shifted;
use crate::shade::twin::Twin;

pub const METHOD: Method = Method {
    uses_lobe_shapes: true,
    ..shifted(
        "split-sum-moment",
        "the split sum along the first moment of the lobe, by a table",
        Twin::Estimator(|surface, light, _| light.moment_split_sum(surface)),
    )
};
