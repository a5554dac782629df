//! Split sums along the lobe's first moment, from tables: `P(m, a) (f0 A + B)`, m along `∫ f n·l l dl`, a by method.

use super::Method;
use super::split_sum::shifted;
use crate::precompute::LobeTableKind;
use crate::precompute::lobe_shape::Objective;
use crate::shade::twin::{SpecularTwin, Twin};

const fn along_moment(name: &'static str, title: &'static str, about: &'static str, twin: SpecularTwin) -> Method {
    Method { lobe_table: Some(LobeTableKind::Shapes), ..shifted(name, title, about, twin) }
}

/// `a = alpha`. For light linear in direction, `L = L0 + g·l`, the truth is `W (L0 + ρ g·m)`, with ρ the moment's
/// length over `W = f0 A + B`. A lookup along d gives `W (L0 + c g·d)`, with c the mean cosine of the map's kernel.
/// Along m the error is only `W (c - ρ) g·m`, for any g.
pub const MOMENT: Method = along_moment(
    "split-sum-moment",
    "Split sum (first moment)",
    "the split sum along the first moment of the lobe, by a table",
    Twin::Estimator(|surface, light, _| light.moment_split_sum(surface)),
);

/// `a = argmin ∫ K_a² - 2 ∫ ŵ K_a(·, m)`, with K_a the normalised kernel of the prefiltered map and ŵ the normalised
/// lobe: the least expected squared error under light that is white noise over the sphere. No environment enters.
pub const FITTED: Method = along_moment(
    "split-sum-fitted",
    "Split sum (fitted)",
    "the split sum along the first moment of the lobe at the width of least squared error, by a table",
    Twin::Estimator(|surface, light, _| light.fitted_split_sum(surface, Objective::Square)),
);

/// `a = argmin ∫ (K_a - ŵ)² / (b + ŵ)²`: the expected squared relative error under one small lamp anywhere on the
/// sphere amid constant light of β = 4 times its flux, `b = β/4π`. Pixels that see no lamp weigh more than others, so
/// kernels are narrower.
pub const RELATIVE: Method = along_moment(
    "split-sum-relative",
    "Split sum (corrected)",
    "as split-sum-fitted, by the width of least relative error",
    Twin::Estimator(|surface, light, _| light.fitted_split_sum(surface, Objective::Relative)),
);

/// `f0 A P(m_A, a_A) + B P(m_B, a_B)`: a lookup as in [`RELATIVE`] for each part of Schlick's Fresnel.
///
/// The parts of weights 1 - Fc and Fc are lobes of their own; the second lies nearer to the horizon and is more
/// stretched. The table has moment and width of each, at the shares 0 and 1: no f0 is blended, and coloured ones are
/// exact.
pub const PARTED: Method = Method {
    lookups: 2,
    ..along_moment(
        "split-sum-parted",
        "Split sum (corrected, two lookups)",
        "as split-sum-relative, a lookup for each part of the Fresnel term",
        Twin::Estimator(|surface, light, _| light.parted_split_sum(surface)),
    )
};
