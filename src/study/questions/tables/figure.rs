//! The figure of tables: their error over their size.

use super::{Combination, Measured, combinations, enough, words};
use crate::study::questions::prelude::*;

/// One panel per value of [`Frame::row_axis`], one dot per combination at its worst condition; dots
/// of one kind are joined.
pub(super) fn figure(frame: &Frame, parameters: &[AxisId], all: &[&Measured]) -> Option<Figure> {
    // The kind of a combination: its values that are words, such as the layout.
    let mut kind_axes = parameters.to_vec();
    kind_axes.retain(|axis| {
        let values = &frame.shape.values[*axis];
        values.iter().all(|value| matches!(value, Value::Text(_)))
    });
    let kind = |one: &Measured| kind(frame, &kind_axes, one);
    let kinds = distinct_in_order(all.iter().map(|one| kind(one)));
    let mut panels = Vec::new();
    for (value, measured) in grouped_ascending(all.iter().copied(), frame.row_axis(), |one| one.row)
    {
        let mut marks = vec![Mark::neutral(Form::HorizontalRule(enough(frame)))];
        let combinations = combinations(measured.into_iter());
        for (series, name) in kinds.iter().enumerate() {
            let mut worst: Vec<&Measured> = combinations.iter().map(Combination::worst).collect();
            worst.retain(|one| kind(one) == *name);
            let dots: Vec<Mark> = best_of_each_size(worst)
                .into_iter()
                .map(|one| tables_dot(frame, parameters, series, one))
                .collect();
            marks.extend(if dots.len() > 1 { joined(dots) } else { dots });
        }
        panels.push(ChartPanel {
            title: frame.names.heading(frame.row_axis(), &value),
            marks,
        });
    }
    Chart {
        title: "Error of tables and of the split",
        note: format!(
            "{} of the best tables of each size over the error of the split itself, worst \
             condition; below the line the split dominates",
            frame.metric_name()
        ),
        x: ChartAxis::Log("texels"),
        y: ChartAxis::Log("share of the split's error"),
        panels,
        series: kinds.into_iter().map(solid).collect(),
    }
    .figure()
}

fn kind(frame: &Frame, kind_axes: &[AxisId], one: &Measured) -> String {
    let words = kind_axes
        .iter()
        .map(|&axis| frame.names.short(axis, &one.row.point[axis]));
    words.collect::<Vec<_>>().join(" · ")
}

/// Of tables that differ by their small levels or DFG, the best; the smallest first.
fn best_of_each_size<'m, 'r, 'f>(mut all: Vec<&'m Measured<'r, 'f>>) -> Vec<&'m Measured<'r, 'f>> {
    let size = |one: &Measured| one.texels().log2().round();
    all.sort_by(|a, b| {
        size(a)
            .total_cmp(&size(b))
            .then(a.share().total_cmp(&b.share()))
    });
    all.dedup_by_key(|one| size(one));
    all
}

fn tables_dot(frame: &Frame, parameters: &[AxisId], series: usize, worst: &Measured) -> Mark {
    let tip = format!(
        "{}: {} of the split's error · {}",
        words(frame, parameters, &worst.tables),
        percent(worst.share()),
        worst.condition(frame, &[ENVIRONMENT])
    );
    dot([worst.texels(), worst.share()], series, tip, worst.row)
}
