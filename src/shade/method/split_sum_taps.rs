//! Split sums by one or several lookups: `Σ w P(d, level) (f0 A + B)`, the taps from a table of [`crate::precompute::taps`].

use super::Method;
use super::split_sum::shifted;
use crate::precompute::taps::TapCount;
use crate::shade::twin::{SpecularTwin, Twin};

const fn by_taps(
    name: &'static str,
    title: &'static str,
    about: &'static str,
    count: TapCount,
    twin: SpecularTwin,
) -> Method {
    Method { lookups: count as u32, tap_table: Some(count), ..shifted(name, title, about, twin) }
}

pub const ONE: Method = by_taps(
    "split-sum-one",
    "Split sum (one lookup)",
    "one lookup of fitted direction and width, by a table",
    TapCount::One,
    Twin::Estimator(|surface, light, _| light.tapped_split_sum(surface, &light.one_tap)),
);

pub const TWO: Method = by_taps(
    "split-sum-two",
    "Split sum (two lookups)",
    "two lookups of unequal direction, width and weight, by a table",
    TapCount::Two,
    Twin::Estimator(|surface, light, _| light.tapped_split_sum(surface, &light.two_taps)),
);

pub const FOUR: Method = by_taps(
    "split-sum-four",
    "Split sum (four lookups)",
    "as split-sum-two by four lookups, some of them with negative weights",
    TapCount::Four,
    Twin::Estimator(|surface, light, _| light.tapped_split_sum(surface, &light.four_taps)),
);
