//! How wrong is each method?
//!
//! The error of each method and sample count in each case, in the metric of the question: geometric mean over point sets, and over cases
//! where several are told as one. For a mean square error such as relmse, 100 sqrt(error) is the root mean square error in percent of the
//! reference ("rms"): 0.01 is 10 % rms.
//!
//! The *leading* method is the first without samples, which is what a renderer ships, else the first that samples, at its largest count.

use super::conditions::{by_light, by_width_and_light, extremes};
use super::words::{by_axis, cases_sentence, interval_words, label, number, rms_percent, short, with_rms};
use super::{Finding, Question};
use crate::runner::axis::{AXES, Part};
use crate::runner::value::Value;
use crate::study::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::study::frame::estimate::{Estimate, estimate, geometric_mean};
use crate::study::frame::{Frame, Key, Row, Shape, axis, by, distinct_in_order};
use crate::study::table::{Column, Table, value_cell};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "error",
    asks: "How wrong is each method?",
    columns: &[
        Column { name: "error", about: "Error in the metric of the question, geometric mean over point sets." },
        Column { name: "noise_floor", about: "Error that an exact image would have, from the reference's own noise." },
        Column { name: "is_resolved", about: "1 where the error stands clear of that noise, else 0." },
        Column {
            name: "rms_percent",
            about: "Root mean square error in percent of the reference; empty for metrics that are no mean square.",
        },
    ],
    uses_times: false,
    lacks,
    answer,
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    // A white furnace is held against a surface without specular term.
    (shape.reference_method == "none")
        .then_some("reference.method is none: what differs is the term that it leaves out")
}

/// The point sets of one way in one case.
struct Case<'r, 'f> {
    rows: Vec<&'r Row<'f>>,
    error: f64,
}

impl<'r, 'f> Case<'r, 'f> {
    fn row(&self) -> &'r Row<'f> {
        self.rows[0]
    }

    fn is_resolved(&self, frame: &Frame) -> bool {
        self.rows.iter().all(|row| frame.is_resolved(row))
    }
}

fn cases<'r, 'f>(frame: &Frame, images: &[&'r Row<'f>]) -> Vec<Case<'r, 'f>> {
    let luck = frame.swept(&[Part::Luck, Part::Display]);
    let axes: Vec<usize> = (0..AXES.len()).filter(|of| !luck.contains(of)).collect();
    let rows: Vec<&'r Row<'f>> = images.iter().copied().filter(|row| frame.error(row).is_some()).collect();
    let case = |(_, rows): (Key, Vec<&'r Row<'f>>)| {
        let errors: Vec<f64> = rows.iter().filter_map(|row| frame.error(row)).collect();
        Case { rows, error: geometric_mean(&errors) }
    };
    by(&rows, &axes).into_iter().map(case).collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let images = frame.images();
    let all = cases(frame, &images);
    // No specular term beside methods that have one.
    let is_empty = |row: &Row| row.has_no_method() && images.iter().any(|other| !other.has_no_method());
    let is_fixed = |case: &&Case| case.row().samples().is_none() && !is_empty(case.row());
    let largest = || all.iter().reduce(|a, b| if b.row().samples() > a.row().samples() { b } else { a });
    let lead = frame.way(all.iter().find(is_fixed).or_else(largest)?.row());
    let own: Vec<&Case> = all.iter().filter(|case| frame.way(case.row()) == lead).collect();
    let axes = frame.case_axes();
    let columns: Vec<usize> = axes.iter().copied().chain([axis("method"), axis("samples")]).collect();
    let mut table = Table::new(&columns, QUESTION.columns);
    for case in &all {
        let mut row: Vec<Cell> = case.row().key(&columns).iter().map(value_cell).collect();
        row.extend([case.error.into(), frame.noise_floor(case.row()).into()]);
        row.extend([Cell::Integer(case.is_resolved(frame).into()), rms_percent(frame, case.error).into()]);
        table.row(row);
    }
    Some(Finding {
        sentence: sentence(frame, &axes, &lead, &own)?,
        digest: Some(digest(frame, &all, &own)),
        table,
        figure: figure(frame, &axes, &all),
    })
}

/// The leading method by alpha and environment; without alpha, every method by environment.
fn digest(frame: &Frame, all: &[Case], own: &[&Case]) -> Table {
    let words = |group: &[&Case]| {
        let words = |mean: Estimate| Cell::Text(with_rms(frame, mean.value) + &interval_words(&mean, number));
        mean(group).map_or(Cell::Missing, words)
    };
    if frame.shape.is_swept(axis("alpha")) {
        return by_width_and_light(
            frame,
            own,
            |case| case.row(),
            |group| words(&group.iter().map(|case| **case).collect::<Vec<_>>()),
        );
    }
    let ways = distinct_in_order(all.iter().map(|case| frame.way(case.row())));
    let of_way = |way: &String| all.iter().filter(|case| frame.way(case.row()) == *way).collect();
    let rows = ways.iter().map(|way| (vec![Cell::Text(way.clone())], of_way(way)));
    by_light(&["method"], rows.collect(), |case| case.row(), words)
}

fn mean(cases: &[&Case]) -> Option<Estimate> {
    let environment = axis("environment");
    let values = cases.iter().map(|case| (case.row().point.0[environment].clone(), case.error));
    estimate(&values.collect::<Vec<_>>(), geometric_mean)
}

/// Errors that differ by less than this factor are told as one.
const CHANGE_MIN: f64 = 2.0;

fn sentence(frame: &Frame, axes: &[usize], lead: &str, cases: &[&Case]) -> Option<String> {
    let (middle, first) = (mean(cases)?, cases.first()?.row());
    let scope = match cases.len() {
        1 => {
            let place = ["scene", "environment"].map(axis).map(|of| short(of, &first.point.0[of]));
            format!(", on {} under {}", place[0], place[1])
        }
        n => format!(", the geometric mean of {n} cases"),
    };
    let percent = rms_percent(frame, middle.value);
    let rms = percent.map_or_else(String::new, |percent| format!(", about **{} % rms**", number(percent)));
    let value = number(middle.value);
    let value = if percent.is_some() { value } else { format!("**{value}**") };
    let interval = interval_words(&middle, number);
    let mut text = format!("`{lead}` errs by a `{}` of {value}{interval}{rms}{scope}.", frame.metric_name());
    let of =
        |own: &[&&Case]| mean(&own.iter().map(|case| **case).collect::<Vec<_>>()).map_or(f64::NAN, |one| one.value);
    if let Some((of, ends)) = extremes(cases, |case| case.row(), of, CHANGE_MIN) {
        text += &by_axis("it", of, &ends, |error| with_rms(frame, error));
    }
    text += &match cases.iter().any(|case| case.is_resolved(frame)) {
        false => " The reference's own noise shows in it: the true error may be smaller.".to_owned(),
        true => cases_sentence(&cases.iter().map(|case| case.row()).collect::<Vec<_>>(), axes, cases.len()),
    };
    Some(text)
}

/// Panels of a figure; the table has the others.
const PANELS_MAX: usize = 12;
/// Ways of one method that differ in their sample count: the fewest, the middle one and the most.
const COUNTS_SHOWN: usize = 3;

/// Dots by alpha, else by way, one panel an environment.
fn figure(frame: &Frame, axes: &[usize], all: &[Case]) -> Option<Figure> {
    let (alpha, environment) = (axis("alpha"), axis("environment"));
    let ways = shown_ways(frame, all);
    let shown: Vec<&Case> =
        all.iter().filter(|case| case.error > 0.0 && ways.contains(&frame.way(case.row()))).collect();
    let lights = distinct_in_order(shown.iter().map(|case| case.row().point.0[environment].clone()));
    let width = |case: &Case| match case.row().point.0[alpha] {
        Value::Number(alpha) => Some(alpha),
        _ => None,
    };
    let y = Scale::log(frame.metric_name(), shown.iter().map(|case| case.error))?;
    let is_by_alpha = frame.shape.is_swept(alpha);
    let x = match is_by_alpha {
        true => Scale::log(AXES[alpha].name, shown.iter().filter_map(|case| width(case)))?,
        false => Scale::steps("", ways.clone()),
    };
    let panel = |light: &Value| {
        let mut marks = Vec::new();
        for (series, way) in ways.iter().enumerate() {
            let is_own = |case: &&&Case| case.row().point.0[environment] == *light && frame.way(case.row()) == *way;
            let own = shown.iter().filter(is_own);
            let place = |case: &Case| if is_by_alpha { width(case) } else { Some(series as f64) };
            marks.extend(own.filter_map(|case| {
                let tip = format!("{way}: {} · {}", with_rms(frame, case.error), label(axes, &case.row().key(axes)));
                Some(Mark::new(Form::Dot([place(case)?, case.error]), series).tip(tip).cell(&case.row().cell.id))
            }));
        }
        let title = if lights.len() > 1 { short(environment, light) } else { String::new() };
        Panel { title, x: x.clone(), y: y.clone(), marks }
    };
    let panels: Vec<Panel> = lights.iter().take(PANELS_MAX).map(panel).collect();
    Some(Figure {
        title: "How wrong each method is".to_owned(),
        note: format!("{}; each dot is an image", frame.metric_name()),
        panels,
        series: ways.into_iter().map(|name| Series { name, is_dashed: false }).collect(),
        ramp: None,
    })
}

/// Methods without samples, and of each other method a few of its counts.
fn shown_ways(frame: &Frame, all: &[Case]) -> Vec<String> {
    let method = axis("method");
    let names = distinct_in_order(all.iter().map(|case| case.row().point.0[method].clone()));
    let of_method = |name: &Value| -> Vec<String> {
        let own: Vec<&Case> = all.iter().filter(|case| case.row().point.0[method] == *name).collect();
        let mut counts: Vec<u32> = own.iter().filter_map(|case| case.row().samples()).collect();
        counts.sort_unstable();
        counts.dedup();
        let last = counts.len().saturating_sub(1);
        let kept: Vec<u32> = match counts.len() > COUNTS_SHOWN {
            true => [0, last / 2, last].map(|place| counts[place]).to_vec(),
            false => counts,
        };
        let is_kept = |case: &&&Case| case.row().samples().is_none_or(|n| kept.contains(&n));
        distinct_in_order(own.iter().filter(is_kept).map(|case| frame.way(case.row())))
    };
    names.iter().flat_map(of_method).collect()
}
