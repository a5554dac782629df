//! The figure of the steps of an error: their shares as bars.

use super::{Group, VIEW_STEP, share_words};
use crate::instrument::ladder::BANDS;
use crate::instrument::metrics::ALL_VIEWS;
use crate::study::questions::prelude::*;

/// Bars of shares by [`Frame::row_axis`], one panel per surface: right of 0 steps add error, left
/// of 0 they cancel it. Over all views, which grazing ones dominate, then facing the viewer.
pub(super) fn figure(groups: &[Group], steps: &[&str]) -> Option<Figure> {
    let row_values = groups.iter().map(|group| group.row_value.clone());
    let row_values = ascending(distinct_in_order(row_values));
    let heading = |value: &Value| {
        let group = groups.iter().find(|group| group.row_value == *value);
        group.map_or_else(String::new, |group| group.heading.clone())
    };
    let shown = [ALL_VIEWS, BANDS[BANDS.len() - 1]]
        .into_iter()
        .flat_map(|n_dot_v| groups.iter().filter(move |group| group.n_dot_v == n_dot_v));
    let mut panels = Vec::new();
    for (title, groups) in grouped(shown, |group| group.title()) {
        let mut marks = Vec::new();
        for group in groups {
            marks.extend(bars(group, steps, step(&row_values, &group.row_value)));
        }
        marks.push(Mark::neutral(Form::VerticalRule(0.0)));
        marks.push(Mark::neutral(Form::VerticalRule(1.0)));
        panels.push(ChartPanel { title, marks });
    }
    let is_pooled = groups
        .iter()
        .any(|group| steps.iter().any(|step| group.is_pooled(step)));
    let note = if is_pooled {
        "share of relmse by step, mean over environments; left of 0 a step cancels error; \
         whiskers: 95 % of the longest"
    } else {
        "share of relmse by step; left of 0 a step cancels error"
    };
    let series = steps.iter().map(|step| {
        if *step == VIEW_STEP {
            solid("view (n = v = r)")
        } else {
            solid(*step)
        }
    });
    Chart {
        title: "Where the split sum's error comes from",
        note: note.to_owned(),
        x: ChartAxis::Linear("share of the error"),
        y: ChartAxis::Steps("", row_values.iter().map(heading).collect()),
        panels,
        series: series.collect(),
    }
    .figure()
}

/// The bars of a group, stacked to both sides of 0, and the interval of the longest bar alone:
/// others would overlap it.
fn bars(group: &Group, steps: &[&str], y: f64) -> Vec<Mark> {
    let mut marks = Vec::new();
    let mut positive_end = 0.0;
    let mut negative_end = 0.0;
    let mut longest: Option<(f64, Option<Mark>)> = None;
    for (series, step) in steps.iter().enumerate() {
        let Some(share) = group.share(step) else {
            continue;
        };
        let end = if share.value < 0.0 {
            &mut negative_end
        } else {
            &mut positive_end
        };
        let base = *end;
        *end += share.value;
        let bar = Form::HorizontalBar {
            y,
            base,
            to: base + share.value,
        };
        let tip = format!("{step}: {} · {}", share_words(&share), group.heading);
        marks.push(Mark::new(bar, series).tip(tip));
        let is_longest = longest
            .as_ref()
            .is_none_or(|(value, _)| share.value.total_cmp(value).is_ge());
        if is_longest {
            let whisker = share
                .interval
                .map(|[lo, hi]| Mark::neutral(Form::Whisker([base + lo, y], [base + hi, y])));
            longest = Some((share.value, whisker));
        }
    }
    marks.extend(longest.and_then(|(_, whisker)| whisker));
    marks
}
