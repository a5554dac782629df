//! The sentences about pictures.

use super::{BASE, Group, MethodGroups, by_method, leading_score, picture_axes, worst_of};
use crate::study::questions::prelude::*;

pub(super) fn sentences(frame: &Frame, all: &[&Group]) -> Option<Sentences> {
    let metric = leading_score(frame);
    let methods = by_method(all, metric);
    let MethodGroups { variant, groups } = methods.first()?;
    let medians = groups
        .iter()
        .filter_map(|group| Some(group.median()?.value));
    let worse = groups
        .iter()
        .filter_map(|group| Some(100.0 * group.worse()?.value));
    let worst = worst_of(groups)?;
    let axes = picture_axes(frame);
    let headline = statement![
        "In the median picture ",
        Phrase::Method(variant.clone()),
        " has ",
        Quantity::new(Extent::from_values(medians))
            .unit(" times")
            .strong(),
        " the ",
        Phrase::Metric(metric),
        " of ",
        Phrase::Method(Variant::new(BASE)),
        ", and it makes ",
        Quantity::new(Extent::from_values(worse)).unit(" %"),
        " of the pictures worse."
    ];
    let detail = statement![
        "The worst has ",
        Quantity::rounded(worst.ratio).unit(" times"),
        ": ",
        frame.names.comma_phrases(&axes, &worst.row.key(&axes)),
        "."
    ];
    Some(Sentences::new(headline).with_details([detail]))
}
