//! Split sums by several lookups: `Σ w P(d, level) (f0 A + B)`, the taps from a table of [`crate::precompute::taps`].

use super::Method;
use super::split_sum::shifted;
use crate::precompute::LobeTableKind;
use crate::shade::twin::{SpecularTwin, Twin};

const fn by_taps(
    name: &'static str,
    title: &'static str,
    about: &'static str,
    count: u32,
    twin: SpecularTwin,
) -> Method {
    let lobe_table = Some(LobeTableKind::Taps(count as usize));
    Method { lookups: count, lobe_table, ..shifted(name, title, about, twin) }
}

pub const TWO: Method = by_taps(
    "split-sum-two",
    "Split sum (two lookups)",
    "two lookups of unequal direction, width and weight, by a table",
    2,
    Twin::Estimator(|surface, light, _| light.tapped_split_sum(surface, &light.two_taps)),
);

pub const FOUR: Method = by_taps(
    "split-sum-four",
    "Split sum (four lookups)",
    "as split-sum-two by four lookups, some of them with negative weights",
    4,
    Twin::Estimator(|surface, light, _| light.tapped_split_sum(surface, &light.four_taps)),
);
