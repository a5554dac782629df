//! Split sums by one or several lookups: `Σ w P(d, level) (f0 A + B)`, the taps from a table of
//! [`crate::instrument::precompute::taps`].

use super::Method;
use super::split_sum::several;
use crate::instrument::precompute::taps::TapCount;
use crate::instrument::shade::twin::{SpecularTwin, Twin};

const fn by_taps(
    count: TapCount,
    name: &'static str,
    title: &'static str,
    about: &'static str,
    twin: SpecularTwin,
) -> Method {
    Method {
        tap_table: Some(count),
        is_corrected: true,
        ..several(count as u32, name, title, about, twin)
    }
}

pub const ONE: Method = by_taps(
    TapCount::One,
    "split-sum-one",
    "Split sum (one lookup)",
    "one lookup of fitted direction and width, by a table",
    Twin::Estimator(|surface, light, _| light.tapped_split_sum(surface, &light.one_tap)),
);

pub const TWO: Method = by_taps(
    TapCount::Two,
    "split-sum-two",
    "Split sum (two lookups)",
    "two lookups of unequal direction, width and weight, by a table",
    Twin::Estimator(|surface, light, _| light.tapped_split_sum(surface, &light.two_taps)),
);

pub const FOUR: Method = by_taps(
    TapCount::Four,
    "split-sum-four",
    "Split sum (four lookups)",
    "as split-sum-two by four lookups, some of them with negative weights",
    Twin::Estimator(|surface, light, _| light.tapped_split_sum(surface, &light.four_taps)),
);
