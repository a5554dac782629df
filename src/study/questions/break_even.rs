//! From how many samples a pixel on is sampling closer to the reference than a method without samples?
//!
//! A *case* is one setting of everything but method, sample count, point set and tone curve. In a case let e(N) be the error of a sampling
//! method with N samples (geometric mean over point sets) and f the error of the method without samples. The *break-even* is the smallest
//! tried N such that e(M) < f for every tried M >= N. A count that wins while a larger one loses does not count: it was luck. The
//! *crossing* is where log e over log N meets log f between two tried counts; it is interpolated, the break-even is measured.
//!
//! Over cases: the median, with "above the largest tried count" last. Its interval resamples environments ([`estimate`]); infinity stands
//! for "above".

use super::conditions::{by_width_and_light, extremes};
use super::words::{by_axis, cases_sentence, interval_words, label, short};
use super::{Finding, Question};
use crate::runner::axis::Part;
use crate::runner::value::Value;
use crate::study::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::study::frame::curve::{Curve, curves, without_samples};
use crate::study::frame::estimate::{Estimate, estimate};
use crate::study::frame::{Frame, Key, Row, Shape, axis, distinct_in_order, fits};
use crate::study::table::{Column, Table, value_cell};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "break-even",
    asks: "From how many samples a pixel on is sampling closer to the reference than a method without samples?",
    columns: &[
        Column { name: "sampled", about: "The sampling method." },
        Column { name: "fixed", about: "The method without samples." },
        Column {
            name: "break_even",
            about: "Smallest tried sample count from which on the sampling method errs less; empty above the largest tried.",
        },
        Column { name: "largest_tried", about: "Largest tried sample count." },
        Column {
            name: "crossing",
            about: "Sample count at which the two errors meet, interpolated between tried counts; empty where they do not meet.",
        },
        Column { name: "fixed_error", about: "Error of the method without samples, in the metric of the question." },
        Column {
            name: "is_resolved",
            about: "1 where both errors at the break-even stand clear of the reference's noise, else 0.",
        },
    ],
    uses_times: false,
    lacks,
    answer,
};

pub(super) fn lacks(shape: &Shape) -> Option<&'static str> {
    lacks_methods(shape)
        .or_else(|| (!shape.is_swept(axis("samples"))).then_some("axes.samples has fewer than two counts"))
}

/// What `axes.method` lacks for a comparison of a method that samples with one that does not.
pub(super) fn lacks_methods(shape: &Shape) -> Option<&'static str> {
    let methods = crate::shade::METHODS.iter().filter(|method| shape.has("method", &[method.name]));
    let methods: Vec<_> = methods.filter(|method| method.name != "none").collect();
    match () {
        () if !methods.iter().any(|method| method.uses_samples) => Some("axes.method has no method that samples"),
        () if methods.iter().all(|method| method.uses_samples) => Some("axes.method has no method without samples"),
        () => None,
    }
}

/// A sampling method beside one without samples in one case.
pub(super) struct Case<'r, 'f> {
    /// Values on the axes of cases; an axis that one of the two does not use is that of the other.
    pub key: Key,
    pub curve: Curve<'r, 'f>,
    pub fixed: &'r Row<'f>,
    pub fixed_error: f64,
    /// `None`: above the largest tried count.
    pub break_even: Option<u32>,
}

impl Case<'_, '_> {
    /// By log-log interpolation on the segment that ends at the break-even.
    pub fn crossing(&self) -> Option<f64> {
        let points = &self.curve.points;
        let index = points.iter().position(|point| Some(point.samples) == self.break_even)?;
        let (before, after) = (points.get(index.checked_sub(1)?)?, &points[index]);
        let [x0, x1] = [before, after].map(|point| f64::from(point.samples).ln());
        let [y0, y1] = [before, after].map(|point| (point.error / self.fixed_error).ln());
        Some((x0 + y0 / (y0 - y1) * (x1 - x0)).exp()).filter(|n| n.is_finite())
    }

    /// For medians: infinite above the largest tried count.
    fn number(&self) -> f64 {
        self.break_even.map_or(f64::INFINITY, f64::from)
    }

    /// Whether both errors stand clear of the reference's noise where they meet.
    fn is_resolved(&self, frame: &Frame) -> bool {
        let at = self.break_even.unwrap_or(self.curve.tried()[1]);
        frame.is_resolved(self.fixed) && self.curve.at(at).is_some_and(|point| point.is_resolved)
    }
}

/// The smallest count of an ascending curve from which on every error lies below `fixed`.
fn break_even(curve: &Curve, fixed: f64) -> Option<u32> {
    curve.points.iter().rev().take_while(|point| point.error < fixed).last().map(|point| point.samples)
}

/// A sampling method, a method without samples, and the cases that have both.
pub(super) struct Pair<'r, 'f> {
    pub sampled: String,
    pub fixed: String,
    pub cases: Vec<Case<'r, 'f>>,
}

impl Pair<'_, '_> {
    /// Smallest and largest tried count of all cases.
    fn tried(&self) -> [u32; 2] {
        tried(&self.cases.iter().collect::<Vec<_>>())
    }
}

fn tried(cases: &[&Case]) -> [u32; 2] {
    let ends = || cases.iter().map(|case| case.curve.tried());
    [ends().map(|[least, _]| least).min().unwrap_or(0), ends().map(|[_, largest]| largest).max().unwrap_or(0)]
}

/// In the order of the rows. A curve of one count meets nothing.
pub(super) fn pairs<'r, 'f>(frame: &Frame, images: &[&'r Row<'f>], axes: &[usize]) -> Vec<Pair<'r, 'f>> {
    let fixed = without_samples(images);
    let mut pairs: Vec<Pair> = Vec::new();
    for curve in curves(frame, images, axes).into_iter().filter(|curve| curve.points.len() > 1) {
        for &row in &fixed {
            let other = row.key(axes);
            let Some(fixed_error) = frame.error(row).filter(|_| fits(&other, &curve.key)) else { continue };
            let key = curve.key.iter().zip(&other).map(|(a, b)| if *a == Value::Unset { b } else { a }.clone());
            let break_even = break_even(&curve, fixed_error);
            let case = Case { key: key.collect(), curve: curve.clone(), fixed: row, fixed_error, break_even };
            let names = (curve.method.to_string(), row.text(axis("method")));
            match pairs.iter_mut().find(|pair| (&pair.sampled, &pair.fixed) == (&names.0, &names.1)) {
                Some(pair) => pair.cases.push(case),
                None => pairs.push(Pair { sampled: names.0, fixed: names.1, cases: vec![case] }),
            }
        }
    }
    pairs
}

fn answer(frame: &Frame) -> Option<Finding> {
    let (axes, images) = (frame.case_axes(), frame.images());
    let pairs = pairs(frame, &images, &axes);
    let mut table = Table::new(&axes, QUESTION.columns);
    for pair in &pairs {
        for case in &pair.cases {
            let mut row: Vec<Cell> = case.key.iter().map(value_cell).collect();
            row.extend([&pair.sampled, &pair.fixed].map(|name| Cell::Text(name.clone())));
            row.push(case.break_even.map_or(Cell::Missing, |n| Cell::Integer(n.into())));
            row.push(Cell::Integer(case.curve.tried()[1].into()));
            row.extend([case.crossing().into(), case.fixed_error.into()]);
            row.push(Cell::Integer(case.is_resolved(frame).into()));
            table.row(row);
        }
    }
    let lead = pairs.first()?;
    Some(Finding {
        sentence: sentence(frame, &axes, lead),
        digest: Some(digest(frame, lead)),
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

/// "16"; "at most 4" where no fewer were tried; "more than 256".
fn counted(n: f64, [least, largest]: [u32; 2]) -> String {
    match n {
        n if n.is_infinite() => format!("more than {largest}"),
        n if n == f64::from(least) && least > 1 => format!("at most {least}"),
        n => n.to_string(),
    }
}

/// Medians that differ by less than this factor are told as one.
const CHANGE_MIN: f64 = 2.0;

fn sentence(frame: &Frame, axes: &[usize], pair: &Pair) -> String {
    let all: Vec<&Case> = pair.cases.iter().collect();
    let (tried, metric) = (pair.tried(), frame.metric_name());
    let ([first, ..], Some(middle)) = (pair.cases.as_slice(), median(&all)) else { return String::new() };
    let interval = interval_words(&middle, |n| counted(n, tried));
    let scope = match pair.cases.len() {
        1 => format!(", under {}", short(axis("environment"), &first.fixed.point.0[axis("environment")])),
        _ => ", in the median case".to_owned(),
    };
    let mut text = format!(
        "`{}` needs **{} samples a pixel**{interval} to beat `{}` in `{metric}`{scope}.",
        pair.sampled,
        counted(middle.value, tried),
        pair.fixed
    );
    let number =
        |cases: &[&&Case]| median(&cases.iter().map(|case| **case).collect::<Vec<_>>()).map_or(f64::NAN, |m| m.value);
    if let Some((of, [least, most])) = extremes(&all, |case| case.fixed, number, CHANGE_MIN) {
        text += &by_axis("it", of, &[least, most], |n| counted(n, tried));
    }
    let rows: Vec<&Row> = pair.cases.iter().map(|case| case.fixed).collect();
    text + &cases_sentence(&rows, axes, pair.cases.len())
}

/// Medians by alpha and environment.
fn digest(frame: &Frame, pair: &Pair) -> Table {
    by_width_and_light(
        frame,
        &pair.cases,
        |case| case.fixed,
        |own| {
            let tried = tried(own);
            let words = |middle: Estimate| {
                Cell::Text(counted(middle.value, tried) + &interval_words(&middle, |n| counted(n, tried)))
            };
            median(own).map_or(Cell::Missing, words)
        },
    )
}

/// One panel a pair of methods: the break-even of each case, one row a case.
fn figure(frame: &Frame, axes: &[usize], pairs: &[Pair]) -> Option<Figure> {
    let series_axis = frame.swept(&[Part::Case]).into_iter().find(|known| *known == axis("brdf"));
    let names: Vec<Value> = series_axis.map_or_else(Vec::new, |axis| frame.shape.values[axis].clone());
    let mut panels = Vec::new();
    for pair in pairs {
        let others: Vec<usize> = axes.iter().copied().filter(|axis| Some(*axis) != series_axis).collect();
        let row_key = |case: &Case| -> Key {
            let own = axes.iter().zip(&case.key).filter(|(axis, _)| Some(**axis) != series_axis);
            own.map(|(_, value)| value.clone()).collect()
        };
        let rows = distinct_in_order(pair.cases.iter().map(row_key));
        let tried = pair.tried();
        let [least, largest] = tried.map(f64::from);
        let beyond = largest * 2.0;
        let mut marks = vec![Mark::neutral(Form::VerticalRule(largest))];
        for case in &pair.cases {
            let y = rows.iter().position(|row| *row == row_key(case))? as f64;
            let series = series_axis.and_then(|axis| names.iter().position(|name| *name == case.fixed.point.0[axis]));
            let x = case.break_even.map_or(beyond, f64::from);
            let tip = format!("{}: {} samples", label(axes, &case.key), counted(case.number(), tried));
            marks.push(Mark::new(Form::Dot([x, y]), series.unwrap_or(0)).tip(tip).cell(&case.fixed.cell.id));
        }
        panels.push(Panel {
            title: format!("{} over {}", pair.sampled, pair.fixed),
            x: Scale::log("samples a pixel", [least, beyond])?,
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
        note: format!("{}; beyond the line: not up to the largest tried count", frame.metric_name()),
        panels,
        series,
        ramp: None,
    })
}
