//! Two lookups as those of [`split-sum-relative`](super::split_sum_relative), one for each part of Schlick's Fresnel:
//! `f0 A P(m_A, a_A) + B P(m_B, a_B)`.
//!
//! The parts of weights 1 - Fc and Fc are lobes of their own: that of Fc lies nearer to the horizon and is the more stretched. Each has its
//! moment and its width in the table, at the shares 0 and 1, so that no f0 is blended and a coloured one is exact.

use super::Method;
use super::split_sum::shifted;
use crate::shade::twin::Twin;

pub const METHOD: Method = Method {
    uses_lobe_shapes: true,
    lookups: 2,
    ..shifted(
        "split-sum-parted",
        "as split-sum-relative, a lookup for each part of the Fresnel term",
        Twin::Estimator(|surface, light, _| light.parted_split_sum(surface)),
    )
};
