//! The figure of pictures: medians and worst pictures.

use super::{
    BASE, Group, Worst, by_method, leading_score, picture_name, without_picture_axes, worst_of,
};
use crate::study::questions::numbers::middle_dot;
use crate::study::questions::prelude::*;

/// The leading score of the median picture by [`Frame::row_axis`], one panel per other case, and a
/// single dot for the worst picture of each method there. Dots link to their image.
pub(super) fn figure(frame: &Frame, all: &[&Group]) -> Option<Figure> {
    let row_axis = frame.row_axis();
    let metric = leading_score(frame);
    let methods = by_method(all, metric);
    let steps = values(all.iter().flat_map(|group| group.ratios.rows()), row_axis);
    let title = |group: &Group| panel_title(frame, &group.case);
    let mut panels = Vec::new();
    for name in distinct_in_order(all.iter().map(|group| title(group))) {
        let mut marks = vec![Mark::neutral(Form::HorizontalRule(1.0))];
        for (series, method) in methods.iter().enumerate() {
            let mut groups = method.groups.clone();
            groups.retain(|group| title(group) == name);
            let medians = groups
                .iter()
                .filter_map(|group| median_dot(frame, group, &steps, series));
            marks.extend(joined(medians.collect()));
            let worst = worst_of(&groups);
            marks.extend(worst.map(|worst| worst_dot(frame, worst, &steps, series)));
        }
        panels.push(ChartPanel { title: name, marks });
    }
    Chart {
        title: "Pictures against the textbook's split sum",
        note: format!(
            "{metric} over the {metric} of {}; below 1 is better. Lines: the median picture; \
             single marks: the worst picture",
            Variant::new(BASE).label()
        ),
        x: ChartAxis::values(frame, row_axis, &steps),
        y: ChartAxis::Log("ratio"),
        panels,
        series: methods
            .into_iter()
            .map(|one| {
                let row = one
                    .groups
                    .first()
                    .and_then(|group| group.ratios.rows().next());
                let method = row.map_or_else(String::new, |row| row.text(METHOD));
                method_series(one.variant.label(), &method, false)
            })
            .collect(),
    }
    .figure()
}

/// The values of a case that are not steps of the figure.
fn panel_title(frame: &Frame, case: &[Value]) -> String {
    let mut axes = without_picture_axes(frame.case_axes());
    let mut key = case.to_vec();
    if let Some(index) = axes.iter().position(|axis| *axis == frame.row_axis()) {
        axes.remove(index);
        key.remove(index);
    }
    frame.names.label(&axes, &key)
}

/// The median picture of a group, with a link to the picture nearest to it.
fn median_dot(frame: &Frame, group: &Group, steps: &[Value], series: usize) -> Option<Mark> {
    let median = group.median()?;
    let row = group.nearest(median.value)?;
    let position = [step(steps, &row.point[frame.row_axis()]), median.value];
    let words = |all: &Estimate| format!("median picture {}", with_interval(all));
    let dot = middle_dot(&median, series, &group.variant.label(), position, &words);
    Some(dot.cell(&*row.cell.id))
}

fn worst_dot(frame: &Frame, worst: Worst, steps: &[Value], series: usize) -> Mark {
    let Worst { row, ratio } = worst;
    let name = picture_name(frame, row);
    let tip = format!("worst picture {}, {name}", number(ratio));
    let x = step(steps, &row.point[frame.row_axis()]);
    dot([x, ratio], series, tip, row)
}
