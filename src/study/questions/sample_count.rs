//! Do so many samples a pixel suffice?
//!
//! Two measures of "suffice", at each tried count N. Against the method without samples: the ratio e(N)/f of the two errors in a case
//! (geometric mean over point sets), told as the geometric mean over cases. Where that is below 1 at some values of alpha, or under some
//! environments, and above 1 at others, it is told along them and never averaged over them. To the eye: mean FLIP at the plain tone curve,
//! visible from [`VISIBLE_FROM`] on. Where bias and variance were parted, the share of bias says how much of the error more samples would
//! leave.
//!
//! The sentence is about the count that a renderer takes by default, else the tried count nearest to it by ratio.

use super::break_even::lacks_methods;
use super::conditions::{Along, along, change_of_sign, heading};
use super::words::{cases_sentence, count, label, listed, number, percent, short, with_interval};
use super::{Finding, Question};
use crate::runner::axis::AXES;
use crate::runner::value::Value;
use crate::study::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::study::frame::curve::{Curve, CurvePoint, curves, mean, without_samples};
use crate::study::frame::estimate::{Estimate, estimate, geometric_mean};
use crate::study::frame::{Frame, Key, Row, Shape, VISIBLE_FROM, ascending, axis, distinct_in_order, fits};
use crate::study::table::{Column, Table, value_cell};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "sample-count",
    asks: "Do so many samples a pixel suffice?",
    columns: &[
        Column { name: "fixed", about: "The method without samples that the row is held against." },
        Column {
            name: "ratio",
            about: "Error over that of the method without samples; below 1 sampling is closer to the reference.",
        },
        Column { name: "is_resolved", about: "1 where both errors stand clear of the reference's noise, else 0." },
        Column { name: "flip", about: "Mean FLIP at the plain tone curve, mean over point sets." },
        Column {
            name: "is_visible",
            about: "1 where that is at least 0.05, this project's limit of the visible, else 0.",
        },
        Column {
            name: "bias_share",
            about: "Squared bias over mean square error; as an unbiased estimate it may fall below 0. Empty without [bias_variance].",
        },
    ],
    uses_times: false,
    lacks,
    answer,
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    lacks_methods(shape)
}

/// One count of a sampling method beside a method without samples in one case.
struct Case<'r, 'f> {
    key: Key,
    method: Value,
    point: CurvePoint<'r, 'f>,
    fixed: &'r Row<'f>,
    ratio: f64,
}

impl Case<'_, '_> {
    fn row(&self) -> &Row<'_> {
        self.fixed
    }

    fn flip(&self) -> Option<f64> {
        mean(self.point.rows.iter().filter_map(|row| row.flip()))
    }

    fn is_visible(&self) -> bool {
        self.flip().is_some_and(|flip| flip >= VISIBLE_FROM)
    }

    fn is_of(&self, names: &(Value, Value)) -> bool {
        (&self.method, &self.fixed.point.0[axis("method")]) == (&names.0, &names.1)
    }
}

fn cases<'r, 'f>(frame: &Frame, images: &[&'r Row<'f>], axes: &[usize]) -> Vec<Case<'r, 'f>> {
    let fixed = without_samples(images);
    let of_curve = |curve: Curve<'r, 'f>| {
        let mut found = Vec::new();
        for &row in &fixed {
            let other = row.key(axes);
            let Some(error) = frame.error(row).filter(|_| fits(&other, &curve.key)) else { continue };
            let key = curve.key.iter().zip(&other).map(|(a, b)| if *a == Value::Unset { b } else { a }.clone());
            let key: Key = key.collect();
            found.extend(curve.points.iter().map(|point| Case {
                key: key.clone(),
                method: curve.method.clone(),
                ratio: point.error / error,
                point: point.clone(),
                fixed: row,
            }));
        }
        found
    };
    curves(frame, images, axes).into_iter().flat_map(of_curve).collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let (axes, images) = (frame.case_axes(), frame.images());
    let all: Vec<Case> = cases(frame, &images, &axes).into_iter().filter(|case| case.ratio.is_finite()).collect();
    let method = axis("method");
    let pairs = distinct_in_order(all.iter().map(|case| (case.method.clone(), case.fixed.point.0[method].clone())));
    let lead: Vec<&Case> = all.iter().filter(|case| pairs.first().is_some_and(|names| case.is_of(names))).collect();
    Some(Finding {
        sentence: sentence(frame, &axes, &lead)?,
        table: table(frame, &axes, &all),
        digest: Some(digest(frame, &all, &pairs)),
        figure: figure(frame, &axes, &all, &pairs),
    })
}

fn table(frame: &Frame, axes: &[usize], all: &[Case]) -> Table {
    let method = axis("method");
    let columns: Vec<usize> = axes.iter().copied().chain([method, axis("samples")]).collect();
    let mut table = Table::new(&columns, QUESTION.columns);
    for case in all {
        let mut row: Vec<Cell> = case.key.iter().chain([&case.method]).map(value_cell).collect();
        row.extend([Cell::Integer(case.point.samples.into()), Cell::Text(case.fixed.text(method)), case.ratio.into()]);
        row.push(Cell::Integer((case.point.is_resolved && frame.is_resolved(case.fixed)).into()));
        let flip = case.flip();
        row.extend([flip.into(), flip.map_or(Cell::Missing, |_| Cell::Integer(case.is_visible().into()))]);
        row.push(case.point.bias_share().into());
        table.row(row);
    }
    table
}

/// The geometric mean of the ratios.
fn ratio(cases: &[&Case]) -> Option<Estimate> {
    let environment = axis("environment");
    let values = cases.iter().map(|case| (case.fixed.point.0[environment].clone(), case.ratio));
    estimate(&values.collect::<Vec<_>>(), geometric_mean)
}

fn ratio_value(cases: &[&&Case]) -> f64 {
    geometric_mean(&cases.iter().map(|case| case.ratio).collect::<Vec<_>>())
}

/// The count that the sentence is about.
fn told_count(cases: &[&Case]) -> Option<u32> {
    let usual = match (AXES[axis("samples")].default)() {
        Value::Count(count) => f64::from(count),
        _ => 1.0,
    };
    let distance = |count: u32| (f64::from(count) / usual).ln().abs();
    let counts = cases.iter().map(|case| case.point.samples);
    counts.reduce(|a, b| if distance(b) < distance(a) { b } else { a })
}

fn sentence(frame: &Frame, axes: &[usize], lead: &[&Case]) -> Option<String> {
    let samples = told_count(lead)?;
    let own: Vec<&Case> = lead.iter().copied().filter(|case| case.point.samples == samples).collect();
    let (first, pooled) = (own.first()?, ratio(&own)?);
    let (method, fixed, metric) = (&first.method, first.fixed.text(axis("method")), frame.metric_name());
    let wins = own.iter().filter(|case| case.ratio < 1.0).count();
    let at = format!("At **{samples} samples a pixel**");
    let mut parts = match change_of_sign(frame, &own, |case| case.row(), ratio_value) {
        Some((of, groups)) => {
            let (better, worse): (Along, Along) = groups.iter().cloned().partition(|(_, ratio)| *ratio < 1.0);
            vec![
                format!(
                    "{at} `{method}` beats `{fixed}` in `{metric}` {} ({} times the error).",
                    place(of, &groups, &better),
                    range(&better)
                ),
                format!("{} it loses ({} times).", capital(&place(of, &groups, &worse)), range(&worse)),
            ]
        }
        None if own.len() == 1 => {
            let light = short(axis("environment"), &first.fixed.point.0[axis("environment")]);
            vec![format!(
                "{at} `{method}` has {} times the `{metric}` of `{fixed}`, under {light}.",
                number(pooled.value)
            )]
        }
        None => vec![format!(
            "{at} `{method}` has {} times the `{metric}` of `{fixed}`; it wins in {wins} of {} cases.",
            with_interval(&pooled),
            own.len()
        )],
    };
    let flips: Vec<f64> = own.iter().filter_map(|case| case.flip()).collect();
    if let Some(flip) = mean(flips.iter().copied()) {
        let visible = own.iter().filter(|case| case.is_visible()).count();
        parts.push(match own.len() {
            1 if visible == 1 => format!("The difference is visible (mean FLIP {}).", number(flip)),
            1 => format!("The difference is hidden (mean FLIP {}).", number(flip)),
            n => format!("The difference is visible in {visible} of {n} cases (mean FLIP {}).", number(flip)),
        });
    }
    if let Some(share) = mean(own.iter().filter_map(|case| case.point.bias_share())) {
        parts.push(format!("Bias, which more samples leave, is {} of the square error.", percent(share)));
    }
    let rows: Vec<&Row> = own.iter().map(|case| case.row()).collect();
    parts.push(cases_sentence(&rows, axes, own.len()).trim().to_owned());
    parts.retain(|part| !part.is_empty());
    parts.truncate(super::SENTENCES_MAX);
    Some(parts.join(" "))
}

/// "at alpha 0.25 to 1", "in sky and studio".
fn place(of: usize, all: &[(Value, f64)], some: &[(Value, f64)]) -> String {
    let word = |value: &Value| short(of, value);
    let is_numeric = some.iter().all(|(value, _)| matches!(value, Value::Number(_) | Value::Count(_)));
    let first = all.iter().position(|group| Some(group) == some.first()).unwrap_or(0);
    let is_run = all[first..].starts_with(some);
    match some {
        [(least, _), .., (most, _)] if is_numeric && is_run => {
            format!("at {} {} to {}", AXES[of].name, word(least), word(most))
        }
        _ if is_numeric => {
            format!("at {} {}", AXES[of].name, listed(&some.iter().map(|(value, _)| word(value)).collect::<Vec<_>>()))
        }
        _ => format!("for {}", listed(&some.iter().map(|(value, _)| word(value)).collect::<Vec<_>>())),
    }
}

/// "0.2 to 0.5".
fn range(groups: &[(Value, f64)]) -> String {
    let ends = |pick: fn(f64, f64) -> f64| groups.iter().map(|(_, ratio)| *ratio).reduce(pick).unwrap_or(f64::NAN);
    let [least, most] = [ends(f64::min), ends(f64::max)].map(number);
    if least == most { least } else { format!("{least} to {most}") }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// By method and count: the ratio at each value of the axis along which it changes most in meaning, over all where it keeps its sign, then
/// wins, FLIP and bias.
fn digest(frame: &Frame, all: &[Case], pairs: &[(Value, Value)]) -> Table {
    let refs: Vec<&Case> = all.iter().collect();
    let usual = [axis("alpha"), axis("environment")].into_iter().find(|of| frame.shape.is_swept(*of));
    let lead: Vec<&Case> =
        refs.iter().copied().filter(|case| pairs.first().is_some_and(|names| case.is_of(names))).collect();
    let told: Vec<&Case> = lead.iter().copied().filter(|case| Some(case.point.samples) == told_count(&lead)).collect();
    let of = change_of_sign(frame, &told, |case| case.row(), ratio_value).map(|(of, _)| of).or(usual);
    let values = of.map_or_else(Vec::new, |of| {
        ascending(distinct_in_order(all.iter().map(|case| case.fixed.point.0[of].clone())))
    });
    let has_bias = all.iter().any(|case| case.point.bias_share().is_some());
    let mut names: Vec<String> = ["method", "beside", "samples"].map(str::to_owned).to_vec();
    names.extend(of.iter().flat_map(|of| values.iter().map(|value| heading(*of, value))));
    names.extend(["all", "wins", "cases", "mean FLIP", "visible"].map(str::to_owned));
    names.extend(has_bias.then(|| "bias share".to_owned()));
    let mut table = Table::with_names(names);
    for pair in pairs {
        let own: Vec<&Case> = refs.iter().copied().filter(|case| case.is_of(pair)).collect();
        let mut counts = distinct_in_order(own.iter().map(|case| case.point.samples));
        counts.sort_unstable();
        for samples in counts {
            let at: Vec<&Case> = own.iter().copied().filter(|case| case.point.samples == samples).collect();
            let mut row =
                vec![Cell::Text(pair.0.to_string()), Cell::Text(pair.1.to_string()), Cell::Integer(samples.into())];
            let groups = of.map_or_else(Vec::new, |of| along(&at, |case| case.row(), of, ratio_value));
            let group = |value: &Value| groups.iter().find(|(known, _)| known == value).map(|(_, ratio)| *ratio);
            row.extend(
                values.iter().map(|value| group(value).map_or(Cell::Missing, |ratio| Cell::Text(number(ratio)))),
            );
            let is_pooled = change_of_sign(frame, &at, |case| case.row(), ratio_value).is_none();
            let pooled = ratio(&at).filter(|_| is_pooled);
            row.push(pooled.map_or(Cell::Missing, |pooled| Cell::Text(with_interval(&pooled))));
            let wins = at.iter().filter(|case| case.ratio < 1.0).count();
            row.extend([wins, at.len()].map(|n| Cell::Integer(n as u64)));
            row.push(mean(at.iter().filter_map(|case| case.flip())).map_or(Cell::Missing, |x| Cell::Text(number(x))));
            row.push(Cell::Integer(at.iter().filter(|case| case.is_visible()).count() as u64));
            if has_bias {
                let share = mean(at.iter().filter_map(|case| case.point.bias_share()));
                row.push(share.map_or(Cell::Missing, |share| Cell::Text(percent(share))));
            }
            table.row(row);
        }
    }
    table
}

/// Panels of a figure; the table has the others.
const PANELS_MAX: usize = 12;

/// The ratio over the sample count: one panel a pair of methods and environment, one line a case, coloured by alpha.
fn figure(frame: &Frame, axes: &[usize], all: &[Case], pairs: &[(Value, Value)]) -> Option<Figure> {
    let (alpha, environment) = (axis("alpha"), axis("environment"));
    let is_by_alpha = frame.shape.is_swept(alpha);
    let width = |case: &Case| case.fixed.point.0[alpha].clone();
    let widths = if is_by_alpha { ascending(distinct_in_order(all.iter().map(width))) } else { Vec::new() };
    let x = Scale::log("samples a pixel", all.iter().map(|case| f64::from(case.point.samples)))?;
    let y = Scale::log("ratio of errors", all.iter().map(|case| case.ratio).chain([1.0]))?;
    let lights = distinct_in_order(all.iter().map(|case| case.fixed.point.0[environment].clone()));
    let places = pairs.iter().flat_map(|pair| lights.iter().map(move |light| (pair, light)));
    let panel = |(pair, light): (&(Value, Value), &Value)| {
        let mut marks = vec![Mark::neutral(Form::HorizontalRule(1.0))];
        let is_own = |case: &&Case| case.is_of(pair) && case.fixed.point.0[environment] == *light && case.ratio > 0.0;
        let own: Vec<&Case> = all.iter().filter(is_own).collect();
        for key in distinct_in_order(own.iter().map(|case| case.key.clone())) {
            let line: Vec<&Case> = own.iter().copied().filter(|case| case.key == key).collect();
            let Some(first) = line.first() else { continue };
            let series = widths.iter().position(|value| *value == width(first)).unwrap_or(0);
            let at = |case: &Case| [f64::from(case.point.samples), case.ratio];
            marks.push(Mark::new(Form::Line(line.iter().map(|case| at(case)).collect()), series));
            marks.extend(line.iter().map(|case| {
                let samples = count(case.point.samples as usize, "sample", "samples");
                let tip = format!("{samples}: {} times · {}", number(case.ratio), label(axes, &key));
                Mark::new(Form::Dot(at(case)), series).tip(tip).cell(&case.point.rows[0].cell.id)
            }));
        }
        let under = if lights.len() > 1 { format!(", {}", short(environment, light)) } else { String::new() };
        Panel { title: format!("{} over {}{under}", pair.0, pair.1), x: x.clone(), y: y.clone(), marks }
    };
    let panels: Vec<Panel> = places.take(PANELS_MAX).map(panel).collect();
    let series = match widths.is_empty() {
        true => vec![Series { name: "ratio".to_owned(), is_dashed: false }],
        false => widths.iter().map(|value| Series { name: heading(alpha, value), is_dashed: false }).collect(),
    };
    Some(Figure {
        title: "Error of sampling over that of the method without samples".to_owned(),
        note: format!("{}; below 1 sampling is closer to the reference", frame.metric_name()),
        panels,
        series,
        ramp: None,
    })
}
