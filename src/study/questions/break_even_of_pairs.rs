//! How many samples per pixel does each sampling method need to beat each method without samples?
//!
//! The break-even of `break_even`, for every pair of methods, by width of the lobe: the median over environments with its interval. On the
//! scene `design` also by bands of n·v; for pictures also in FLIP.

use super::break_even::{
    SURFACE, by_condition, conditions, counted, counted_words, lacks as lacks_pair, numbers, pairs, tried, up,
};
use super::numbers::middle_marks;
use super::prelude::*;
use super::{FIXED, SAMPLED};
use crate::metrics::{ALL_VIEWS as WHOLE, Space, VIEWS};
use crate::run::tables::DISPLAY_HEADLINE;
use crate::study::frame::curve::beside;

pub const QUESTION: Question = Question {
    name: "break-even-of-pairs",
    asks: "How many samples per pixel does each sampling method need to beat each method without samples?",
    columns: &[
        column("metric", "The metric of the errors."),
        SEEN_FROM,
        SEEN_TO,
        FIXED,
        SAMPLED,
        column("break_even", "Median over environments, rounded up to a tried count; empty above the largest tried."),
        column("break_even_lo", "Lower end of its 95 % interval over environments, not rounded."),
        column("break_even_hi", super::UPPER),
        column("largest_tried", "Largest tried sample count."),
    ],
    lacks,
    answer,
    ..Question::PLAIN
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    lacks_pair(shape).or_else(|| (shape.methods().count() < 3).then_some("axes.method has one pair of methods only"))
}

/// The median of a pair under a condition.
struct Middle {
    metric: &'static str,
    seen: [f64; 2],
    /// On the axes of [`conditions`].
    key: Key,
    /// The method that samples, and the other.
    names: [String; 2],
    all: Estimate,
    tried: Vec<u32>,
}

impl Middle {
    fn words(&self) -> String {
        counted_words(&self.all, &self.tried)
    }

    /// "relmse", "relmse, n·v 0 to 0.2".
    fn score(&self) -> String {
        if self.seen == WHOLE { self.metric.to_owned() } else { format!("{}, {}", self.metric, view(self.seen)) }
    }
}

fn middles(frame: &Frame, seen: [f64; 2]) -> Vec<Middle> {
    let images = frame.images();
    let of_pair = |(names, cases): ([String; 2], Vec<_>)| {
        let middle = |(key, own): (Key, Numbers)| {
            let (metric, tried) = (frame.metric_name(), tried(&cases));
            Some(Middle { metric, seen, key, names: names.clone(), all: own.estimate()?, tried })
        };
        by_condition(frame, &cases).into_iter().filter_map(middle).collect::<Vec<_>>()
    };
    pairs(beside(frame, &images, &frame.case_axes())).into_iter().flat_map(of_pair).collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let images = frame.images();
    let mut all = middles(frame, WHOLE);
    if frame.leads && frame.metric.space == Space::Linear && frame.run.has_pictures() {
        all.extend(middles(&frame.like(frame.run, DISPLAY_HEADLINE), WHOLE));
    }
    let views = frame.views(&images).into_iter();
    all.extend(views.flat_map(|(seen, run)| middles(&frame.like(&run, frame.metric_name()), seen)));
    let axes: Vec<usize> = conditions(frame).collect();
    let columns = distinct_in_order(SURFACE.into_iter().chain(axes.iter().copied()));
    let mut table = Table::new(&columns, QUESTION.columns);
    let cells = |key: &Key| {
        let only = |axis: usize| frame.shape.values[axis].first().cloned().unwrap_or(Value::Unset);
        let value = |of: &usize| axes.iter().position(|axis| axis == of).map_or_else(|| only(*of), |i| key[i].clone());
        axis_cells(&columns, &columns.iter().map(value).collect::<Key>())
    };
    for own in &all {
        let ends = own.all.interval.map_or([None; 2], |ends| ends.map(Some)).map(|end| end.filter(|n| n.is_finite()));
        let count = Some(up(own.all.value, &own.tried)).filter(|n| n.is_finite());
        let [sampled, fixed] = &own.names;
        let head = cells![own.metric, own.seen[0], own.seen[1], fixed.as_str(), sampled.as_str()];
        let numbers = cells![count, ends[0], ends[1], own.tried.last().copied()];
        table.row([cells(&own.key), head, numbers].concat());
    }
    let cases = pairs(beside(frame, &images, &frame.case_axes())).into_iter().flat_map(|(_, cases)| cases);
    let scope = numbers(&cases.collect::<Vec<_>>()).scope(frame);
    Some(Finding {
        sentence: sentence(&all)? + &scope.replacen("Over", "Medians over", 1),
        digest: Some(digest(frame, &axes, &all)),
        table,
        figure: figure(frame, &axes, &all),
    })
}

/// For each metric the range of the first and of the last pair of methods.
fn sentence(all: &[Middle]) -> Option<String> {
    let (first, last) = (&all.first()?.names, &all.last()?.names);
    let told = |own: &[&Middle], names: &[String; 2]| {
        let own = || own.iter().filter(|middle| middle.names == *names);
        let least = own().min_by(|a, b| a.all.value.total_cmp(&b.all.value))?;
        let most = own().max_by(|a, b| a.all.value.total_cmp(&b.all.value))?;
        Some(range_words([least.all.value, most.all.value], |n| counted(n, &least.tried)))
    };
    let whole = all.iter().filter(|middle| middle.seen == WHOLE);
    let of_metric = |(place, (metric, own)): (usize, (&'static str, Vec<&Middle>))| {
        let [a, b] = [told(&own, first)?, told(&own, last)?];
        Some(match place {
            0 => format!(
                "In `{metric}`, `{}` needs **{a} samples per pixel** to beat `{}`, and `{}` needs **{b}** to beat `{}`.",
                first[0], first[1], last[0], last[1]
            ),
            _ => format!(" In `{metric}`: {a}, and {b}."),
        })
    };
    Some(grouped(whole, |middle| middle.metric).into_iter().enumerate().filter_map(of_metric).collect())
}

/// One row per score, condition and pair, one column per value of [`Frame::row_axis`]; of the bands of n·v only the ends, for the first and
/// last pair.
fn digest(frame: &Frame, axes: &[usize], all: &[Middle]) -> Table {
    let of = frame.row_axis();
    let others: Vec<usize> = (0..axes.len()).filter(|i| axes[*i] != of).collect();
    let width_of = |own: &Middle| axes.iter().position(|axis| *axis == of).map(|i| own.key[i].clone());
    let widths = ascending(distinct_in_order(all.iter().filter_map(width_of)));
    let heads = widths.iter().map(|width| frame.names.heading(of, width));
    let heads: Vec<String> = if widths.is_empty() { vec!["samples per pixel".to_owned()] } else { heads.collect() };
    let names =
        others.iter().map(|i| frame.names.name(axes[*i])).chain(["without samples", "sampling"]).map(str::to_owned);
    let mut table = Table::with_names(std::iter::once("score".to_owned()).chain(names).chain(heads));
    let ends = [&all[0].names, &all[all.len() - 1].names];
    let is_end = |own: &Middle| [VIEWS[0], VIEWS[VIEWS.len() - 1]].contains(&own.seen) && ends.contains(&&own.names);
    let is_shown = |own: &&Middle| own.seen == WHOLE || is_end(own);
    let key = |own: &&Middle| {
        let rest: Key = others.iter().map(|i| own.key[*i].clone()).collect();
        (own.score(), rest, own.names.clone())
    };
    let mut rows = grouped(all.iter().filter(is_shown), key);
    let order = distinct_in_order(rows.iter().map(|((score, rest, _), _)| (score.clone(), rest.clone())));
    rows.sort_by_key(|((score, rest, _), _)| order.iter().position(|own| own.0 == *score && own.1 == *rest));
    for ((score, rest, [sampled, fixed]), own) in rows {
        let mut row = cells![score];
        row.extend(others.iter().zip(&rest).map(|(i, value)| Cell::from(frame.names.short(axes[*i], value))));
        row.extend(cells![fixed, sampled]);
        let words = |own: Option<&&Middle>| Cell::from(own.map(|own| own.words()));
        if widths.is_empty() {
            row.push(words(own.first()));
        }
        row.extend(widths.iter().map(|width| words(own.iter().find(|own| width_of(own).as_ref() == Some(width)))));
        table.row(row);
    }
    table
}

/// One panel per metric, condition and sampling method, one line per method without samples; whole images.
fn figure(frame: &Frame, axes: &[usize], all: &[Middle]) -> Option<Figure> {
    let (of, names) = (frame.row_axis(), &frame.names);
    let widths = frame.shape.values[of].clone();
    let series = distinct_in_order(all.iter().map(|own| own.names[1].clone()));
    let title =
        |own: &&Middle| commas([own.metric, &names.label_where(axes, &own.key, |axis| axis != of), &own.names[0]]);
    let largest = f64::from(*all.first()?.tried.last()?);
    let panel = |(name, own): (String, Vec<&Middle>)| {
        let line = |(fixed, own): (String, Vec<&Middle>)| {
            let marks = own.into_iter().flat_map(|own| {
                let place = axes.iter().position(|axis| *axis == of);
                let x = place.map_or(0.0, |i| step(&widths, &own.key[i]));
                let at = |n: f64| [x, up(n, &own.tried).min(2.0 * largest)];
                let words = |_: &Estimate| own.words();
                let name = format!("{fixed}, {}", names.label(axes, &own.key));
                middle_marks(&own.all, step(&series, &fixed) as usize, at, (&name, &words))
            });
            joined(marks.collect())
        };
        let band = std::iter::once(Mark::neutral(Form::BeyondY(largest)));
        (name, band.chain(grouped(own, |own| own.names[1].clone()).into_iter().flat_map(line)).collect())
    };
    let whole = all.iter().filter(|own| own.seen == WHOLE);
    let mut panels: Vec<(String, Vec<&Middle>)> = grouped(whole, title);
    panels.sort_by_key(|(name, _)| name.clone());
    Chart {
        title: "Samples per pixel that sampling needs to win",
        note: format!("median{INTERVAL}; hatched: more than the largest tried count"),
        x: Along::values(frame, of, &widths),
        y: Along::Log("samples per pixel"),
        panels: panels.into_iter().map(panel).collect(),
        series: series.clone(),
    }
    .figure()
}
