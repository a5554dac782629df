//! From how many samples a pixel on is sampling closer to the reference than a method without samples?
//!
//! A *case* is one setting of everything but method, sample count, point set and tone curve. In a case let e(N) be the error of a sampling
//! method with N samples (geometric mean over point sets) and f the error of the method without samples. The *break-even* is the smallest
//! tried N such that e(M) < f for every tried M >= N. A count that wins while a larger one loses does not count: it was luck. The
//! *crossing* is where log e over log N meets log f between two tried counts; it is interpolated, the break-even is measured.
//!
//! Over cases: the median, with "above the largest tried count" last. Its interval resamples environments ([`estimate`]); infinity stands
//! for "above".

use super::words::{count, label, number, scope, short};
use super::{Finding, Question};
use crate::runner::axis::{AXES, Part};
use crate::runner::value::Value;
use crate::study::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::study::frame::estimate::{Estimate, estimate, geometric_mean};
use crate::study::frame::{Frame, Key, Row, Shape, ascending, axis, by, distinct_in_order, fits};
use crate::study::table::{Column, Table};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "break-even",
    asks: "From how many samples a pixel on is sampling closer to the reference than a method without samples?",
    columns: &[
        Column { name: "sampled", about: "The sampling method." },
        Column { name: "fixed", about: "The method without samples." },
        Column { name: "break_even", about: "Smallest tried sample count from which on the sampling method errs less; empty above the largest tried." },
        Column { name: "largest_tried", about: "Largest tried sample count." },
        Column { name: "crossing", about: "Sample count at which the two errors meet, interpolated between tried counts; empty where they do not meet." },
        Column { name: "fixed_error", about: "Error of the method without samples, in the metric of the question." },
        Column { name: "is_resolved", about: "1 where both errors at the break-even stand clear of the reference's noise, else 0." },
    ],
    uses_times: false,
    lacks,
    answer,
};

pub(super) fn lacks(shape: &Shape) -> Option<&'static str> {
    let methods = crate::shade::METHODS.iter().filter(|method| shape.has("method", &[method.name]));
    let methods: Vec<_> = methods.filter(|method| method.name != "none").collect();
    match () {
        () if !methods.iter().any(|method| method.uses_samples) => Some("axes.method has no method that samples"),
        () if methods.iter().all(|method| method.uses_samples) => Some("axes.method has no method without samples"),
        () if !shape.is_swept(axis("samples")) => Some("axes.samples has fewer than two counts"),
        () => None,
    }
}

/// A sampling method beside one without samples in one case.
pub(super) struct Case<'r, 'f> {
    pub key: Key,
    /// Error by sample count, ascending.
    pub curve: Vec<(u32, f64)>,
    /// The images behind the curve.
    pub sampled: Vec<&'r Row<'f>>,
    is_resolved: bool,
    pub fixed: &'r Row<'f>,
    pub fixed_error: f64,
    /// `None`: above the largest tried count.
    pub break_even: Option<u32>,
}

impl Case<'_, '_> {
    fn largest(&self) -> u32 {
        self.curve.last().map_or(0, |(samples, _)| *samples)
    }

    /// By log-log interpolation on the segment that ends at the break-even.
    pub fn crossing(&self) -> Option<f64> {
        let index = self.curve.iter().position(|(samples, _)| Some(*samples) == self.break_even)?;
        let ((n0, e0), (n1, e1)) = (*self.curve.get(index.checked_sub(1)?)?, self.curve[index]);
        let [x0, x1] = [n0, n1].map(|n| f64::from(n).ln());
        let [y0, y1] = [e0, e1].map(|error| (error / self.fixed_error).ln());
        Some((x0 + y0 / (y0 - y1) * (x1 - x0)).exp()).filter(|n| n.is_finite())
    }

    /// For medians: infinite above the largest tried count.
    fn number(&self) -> f64 {
        self.break_even.map_or(f64::INFINITY, f64::from)
    }
}

/// The smallest count of an ascending curve from which on every error lies below `fixed`.
fn break_even(curve: &[(u32, f64)], fixed: f64) -> Option<u32> {
    curve.iter().rev().take_while(|(_, error)| *error < fixed).last().map(|(samples, _)| *samples)
}

/// Cases by pair of methods, in the order of the rows.
pub(super) fn pairs<'r, 'f>(frame: &'r Frame<'f>, axes: &[usize]) -> Vec<((String, String), Vec<Case<'r, 'f>>)> {
    let images = frame.images();
    let sampled: Vec<&Row> = images.iter().copied().filter(|row| row.samples().is_some()).collect();
    let fixed: Vec<&Row> = images.iter().copied().filter(|row| row.samples().is_none() && !row.has_no_method()).collect();
    let method = axis("method");
    let with_method: Vec<usize> = axes.iter().copied().chain([method]).collect();
    let mut found: Vec<((String, String), Vec<Case>)> = Vec::new();
    for (mut key, own) in by(&sampled, &with_method) {
        let sampled_name = key.pop().unwrap_or(Value::Unset).to_string();
        let curve = curve(frame, &own);
        if curve.len() < 2 {
            continue;
        }
        for row in fixed.iter().filter(|row| fits(&row.key(axes), &key)) {
            let Some(fixed_error) = frame.error(row) else { continue };
            let break_even = break_even(&curve, fixed_error);
            let at = own.iter().filter(|row| row.samples() == break_even);
            let is_resolved = frame.is_resolved(row) && at.fold(true, |all, row| all && frame.is_resolved(row));
            let case = Case {
                key: key.clone(),
                curve: curve.clone(),
                sampled: own.clone(),
                is_resolved,
                fixed: row,
                fixed_error,
                break_even,
            };
            let name = (sampled_name.clone(), row.text(method));
            match found.iter_mut().find(|(known, _)| *known == name) {
                Some((_, cases)) => cases.push(case),
                None => found.push((name, vec![case])),
            }
        }
    }
    found
}

/// Error by sample count, ascending; the geometric mean over point sets.
fn curve(frame: &Frame, rows: &[&Row]) -> Vec<(u32, f64)> {
    let mut counts: Vec<u32> = distinct_in_order(rows.iter().filter_map(|row| row.samples()));
    counts.sort_unstable();
    let errors = |n: u32| rows.iter().filter(|row| row.samples() == Some(n)).filter_map(|row| frame.error(row)).collect();
    let mean = |n: u32| -> f64 { geometric_mean(&Vec::from_iter::<Vec<f64>>(errors(n))) };
    counts.into_iter().map(|n| (n, mean(n))).filter(|(_, error)| !error.is_nan()).collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let axes = frame.case_axes();
    let pairs = pairs(frame, &axes);
    let mut table = Table::new(&axes, QUESTION.columns);
    for ((sampled, fixed), cases) in &pairs {
        for case in cases {
            let mut row: Vec<Cell> = case.key.iter().map(|value| Cell::Text(value.to_string())).collect();
            row.extend([sampled, fixed].map(|name| Cell::Text(name.clone())));
            row.push(case.break_even.map_or(Cell::Missing, |n| Cell::Integer(n.into())));
            row.extend([Cell::Integer(case.largest().into()), case.crossing().into(), case.fixed_error.into()]);
            row.push(Cell::Integer(case.is_resolved.into()));
            table.row(row);
        }
    }
    let ((sampled, fixed), cases) = pairs.first()?;
    Some(Finding {
        sentence: sentence(frame, &axes, sampled, fixed, cases),
        digest: Some(digest(&axes, cases)),
        table,
        figure: figure(frame, &axes, &pairs),
    })
}

/// The median of the break-even of some cases.
fn median(cases: &[&Case]) -> Option<Estimate> {
    let environment = axis("environment");
    let values = cases.iter().map(|case| (case.fixed.point.0[environment].clone(), case.number()));
    estimate(&values.collect::<Vec<_>>(), upper_median)
}

/// A tried count, or infinity: at least half of the cases break even at or below it.
fn upper_median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

fn counted(n: f64, largest: u32) -> String {
    if n.is_finite() { number(n) } else { format!("more than {largest}") }
}

fn sentence(frame: &Frame, axes: &[usize], sampled: &str, fixed: &str, cases: &[Case]) -> String {
    let all: Vec<&Case> = cases.iter().collect();
    let largest = cases.iter().map(Case::largest).max().unwrap_or(0);
    let metric = frame.metric_name();
    let [first, ..] = cases else { return String::new() };
    if cases.len() == 1 {
        let n = counted(first.number(), largest);
        return format!("`{sampled}` needs {n} samples a pixel to beat `{fixed}` in {metric}.");
    }
    let Some(middle) = median(&all) else { return String::new() };
    let rows: Vec<&Row> = cases.iter().map(|case| case.fixed).collect();
    let mut text = format!(
        "`{sampled}` needs {} samples a pixel to beat `{fixed}` in {metric}: the median of {} ({}).",
        median_words(&middle, largest),
        count(cases.len(), "case", "cases"),
        scope(&rows, axes)
    );
    let mut numbers: Vec<f64> = cases.iter().map(Case::number).collect();
    numbers.sort_by(f64::total_cmp);
    if let (Some(least), Some(most)) = (numbers.first(), numbers.last()).into()
        && least != most
    {
        text += &format!(" Cases range from {} to {}.", counted(*least, largest), counted(*most, largest));
    }
    text
}

/// Medians by alpha, one column an environment, the last row and column over all.
fn digest(axes: &[usize], cases: &[Case]) -> Table {
    let (alpha, environment) = (axis("alpha"), axis("environment"));
    let of = |axis: usize, case: &Case| match axes.iter().position(|known| *known == axis) {
        Some(place) => case.key[place].clone(),
        None => case.fixed.point.0[axis].clone(),
    };
    let alphas = ascending(distinct_in_order(cases.iter().map(|case| of(alpha, case))));
    let environments = distinct_in_order(cases.iter().map(|case| of(environment, case)));
    let cell = |width: Option<&Value>, light: Option<&Value>| {
        let is_own = |case: &&Case| {
            width.is_none_or(|value| of(alpha, case) == *value) && light.is_none_or(|value| of(environment, case) == *value)
        };
        let own: Vec<&Case> = cases.iter().filter(is_own).collect();
        let largest = own.iter().map(|case| case.largest()).max().unwrap_or(0);
        median(&own).map_or(Cell::Missing, |middle| Cell::Text(median_words(&middle, largest)))
    };
    let names = environments.iter().map(|value| short(environment, value));
    let columns = [AXES[alpha].name.to_owned()].into_iter().chain(names).chain(["all".to_owned()]);
    let mut table = Table::with_names(columns.collect());
    let widths = alphas.iter().map(Some).chain([None]);
    for width in widths {
        let first = Cell::Text(width.map_or("all".to_owned(), |value| short(alpha, value)));
        let lights = environments.iter().map(Some).chain([None]);
        table.row(std::iter::once(first).chain(lights.map(|light| cell(width, light))).collect());
    }
    table
}

/// "32 (95 % 16 to 64)".
fn median_words(middle: &Estimate, largest: u32) -> String {
    let interval = middle.told_interval();
    let interval =
        interval.map_or_else(String::new, |[lo, hi]| format!(" (95 % {} to {})", counted(lo, largest), counted(hi, largest)));
    format!("{}{interval}", counted(middle.value, largest))
}

/// One panel a pair of methods: the break-even of each case, one row a case.
fn figure(frame: &Frame, axes: &[usize], pairs: &[((String, String), Vec<Case>)]) -> Option<Figure> {
    let series_axis = frame.swept(&[Part::Case]).into_iter().find(|known| AXES[*known].name == "brdf");
    let names: Vec<Value> = series_axis.map_or_else(Vec::new, |axis| frame.shape.values[axis].clone());
    let mut panels = Vec::new();
    for ((sampled, fixed), cases) in pairs {
        let others: Vec<usize> = axes.iter().copied().filter(|axis| Some(*axis) != series_axis).collect();
        let row_key = |case: &Case| -> Key {
            let own = axes.iter().zip(&case.key).filter(|(axis, _)| Some(**axis) != series_axis);
            own.map(|(_, value)| value.clone()).collect()
        };
        let rows = distinct_in_order(cases.iter().map(row_key));
        let largest = cases.iter().map(Case::largest).max()?;
        let least = cases.iter().filter_map(|case| case.curve.first()).map(|(n, _)| *n).min()?;
        let beyond = f64::from(largest) * 2.0;
        let mut marks = vec![Mark::neutral(Form::VerticalRule(f64::from(largest)))];
        for case in cases {
            let y = rows.iter().position(|row| *row == row_key(case))? as f64;
            let series = series_axis.and_then(|axis| names.iter().position(|name| *name == case.fixed.point.0[axis]));
            let x = case.break_even.map_or(beyond, f64::from);
            let tip = format!("{}: {}", label(axes, &case.key), counted(case.number(), largest));
            marks.push(Mark::new(Form::Dot([x, y]), series.unwrap_or(0)).tip(tip).cell(&case.fixed.cell.id));
        }
        panels.push(Panel {
            title: format!("{sampled} over {fixed}"),
            x: Scale::log("samples a pixel", [f64::from(least), beyond])?,
            y: Scale::steps("", rows.iter().map(|row| label(&others, row)).collect()),
            marks,
        });
    }
    let series = match names.is_empty() {
        true => vec![Series { name: "break-even".to_owned(), is_dashed: false }],
        false => names.iter().map(|name| Series { name: name.to_string(), is_dashed: false }).collect(),
    };
    Some(Figure {
        title: "Samples a pixel from which on sampling errs less".to_owned(),
        note: format!("{}; marks beyond the line: not up to the largest tried count", frame.metric_name()),
        panels,
        series,
        ramp: None,
    })
}
