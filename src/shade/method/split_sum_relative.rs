//! As `split-sum-fitted`, with the width of least relative error: `a = argmin ∫ (K_a - ŵ)² / (b + ŵ)²`.
//!
//! That is the expected squared relative error under one small lamp anywhere on the sphere amid constant light: `b = β/4π`, where that
//! light has β = 4 times the lamp's flux. A pixel that sees no lamp weighs more than one that does, so that kernels get narrower.

use super::Method;
use super::split_sum::shifted;
use crate::precompute::lobe_shape::Objective;
use crate::shade::twin::Twin;

pub const METHOD: Method = Method {
    uses_lobe_shapes: true,
    ..shifted(
        "split-sum-relative",
        "as split-sum-fitted, by the width of least relative error",
        Twin::Estimator(|surface, light, _| light.fitted_split_sum(surface, Objective::Relative)),
    )
};
