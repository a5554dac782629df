//! How does the error grow with the dynamic range of the environment?
//!
//! The range is log2 of peak over mean luminance, in stops. `environment_clip_log2` cuts the peaks of one environment off at 2 to a power,
//! for a method and its reference alike, so that nothing but the peaks changes: each environment is a series of its own, at each alpha by
//! itself. Two environments differ in more than their range and make no trend. Over everything else the error is a geometric mean.
//!
//! The growth is the error at the widest range over that at the narrowest. The factor a stop is exp of the least-squares slope of
//! ln e over stops; it describes the path only where that is a line, and errors saturate: the range from which a series is level is
//! the first from which on its errors lie within a factor of [`LEVEL`], over at least [`LEVEL_SHARE`] of the range.

use super::words::{label, number, short};
use super::{Finding, Question};
use crate::runner::value::Value;
use crate::study::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::study::frame::estimate::geometric_mean;
use crate::study::frame::{Frame, Row, Shape, ascending, axis, distinct_in_order};
use crate::study::table::{Column, Table};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "dynamic-range",
    asks: "How does the error grow with the dynamic range of the environment?",
    columns: &[
        Column {
            name: "range_stops",
            about: "Dynamic range of the clipped environment: log2 of peak over mean luminance.",
        },
        Column { name: "n", about: "Images behind the error." },
        Column { name: "error", about: "Error in the metric of the question, geometric mean over the images." },
    ],
    uses_times: false,
    lacks,
    answer,
};

/// Errors that lie within this factor of each other count as level.
const LEVEL: f64 = 1.5;
/// Over this share of the range at least: two neighbours are always close.
const LEVEL_SHARE: f64 = 1.0 / 3.0;

fn lacks(shape: &Shape) -> Option<&'static str> {
    (!shape.is_swept(axis("environment_clip_log2"))).then_some("axes.environment_clip_log2 has fewer than two clips")
}

/// A method in one light at one alpha, with lower and lower peaks.
struct Path<'r, 'f> {
    method: String,
    /// Environment and alpha.
    condition: [Value; 2],
    /// Ascending by range.
    points: Vec<Point<'r, 'f>>,
}

struct Point<'r, 'f> {
    range: f64,
    error: f64,
    rows: Vec<&'r Row<'f>>,
}

fn condition_axes() -> [usize; 2] {
    ["environment", "alpha"].map(axis)
}

/// Those of two ranges or more, methods without samples first.
fn paths<'r, 'f>(frame: &'r Frame<'f>) -> Vec<Path<'r, 'f>> {
    let images = frame.images().into_iter().filter(|row| frame.way(row) != "none");
    let rows: Vec<(&Row, f64)> = images.filter_map(|row| Some((row, row.range_stops?))).collect();
    let key =
        |row: &Row| (row.samples().is_some(), frame.way(row), condition_axes().map(|axis| row.point.0[axis].clone()));
    let mut keys = distinct_in_order(rows.iter().map(|(row, _)| key(row)));
    keys.sort_by_key(|(draws, ..)| *draws);
    let path = |wanted: (bool, String, [Value; 2])| {
        let own: Vec<&(&Row, f64)> = rows.iter().filter(|(row, _)| key(row) == wanted).collect();
        let mut ranges: Vec<f64> = own.iter().map(|(_, range)| *range).collect();
        ranges.sort_by(f64::total_cmp);
        ranges.dedup();
        let points = ranges.into_iter().filter_map(|range| {
            let rows: Vec<&Row> = own.iter().filter(|(_, of)| *of == range).map(|(row, _)| *row).collect();
            let errors: Vec<f64> = rows.iter().filter_map(|row| frame.error(row)).collect();
            let error = Some(geometric_mean(&errors)).filter(|error| error.is_finite())?;
            Some(Point { range, error, rows })
        });
        let (_, method, condition) = wanted;
        Path { method, condition, points: points.collect() }
    };
    keys.into_iter().map(path).filter(|path| path.points.len() > 1).collect()
}

impl Path<'_, '_> {
    fn ends(&self) -> [&Point<'_, '_>; 2] {
        [&self.points[0], &self.points[self.points.len() - 1]]
    }

    fn growth(&self) -> f64 {
        let [first, last] = self.ends();
        last.error / first.error
    }

    /// Factor of the error for each stop, by least squares in logarithms; `None` for fewer than three ranges.
    fn factor_a_stop(&self) -> Option<f64> {
        let n = self.points.len() as f64;
        let logs = || self.points.iter().map(|point| (point.range, point.error.ln()));
        let mean = |of: fn((f64, f64)) -> f64| logs().map(of).sum::<f64>() / n;
        let (x0, y0) = (mean(|p| p.0), mean(|p| p.1));
        let slope =
            logs().map(|(x, y)| (x - x0) * (y - y0)).sum::<f64>() / logs().map(|(x, _)| (x - x0).powi(2)).sum::<f64>();
        (self.points.len() > 2).then(|| slope.exp()).filter(|factor| factor.is_finite())
    }

    /// The range from which on the error is level.
    fn level_from(&self) -> Option<f64> {
        let [first, last] = self.ends();
        let is_level = |points: &[Point]| {
            let errors = || points.iter().map(|point| point.error);
            errors().fold(0.0, f64::max) <= LEVEL * errors().fold(f64::INFINITY, f64::min)
        };
        let is_long = |point: &Point| last.range - point.range >= LEVEL_SHARE * (last.range - first.range);
        (0..self.points.len())
            .find(|&i| is_long(&self.points[i]) && is_level(&self.points[i..]))
            .map(|i| self.points[i].range)
    }
}

fn answer(frame: &Frame) -> Option<Finding> {
    let paths = paths(frame);
    let lead = &paths.first()?.method;
    let axes = [frame.way_axes(), ["environment", "environment_clip_log2", "alpha"].map(axis).to_vec()].concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for point in paths.iter().flat_map(|path| &path.points) {
        let mut row = point.rows.first()?.cells(&axes);
        row.extend([point.range.into(), Cell::Integer(point.rows.len() as u64), point.error.into()]);
        table.row(row);
    }
    let own: Vec<&Path> = paths.iter().filter(|path| path.method == *lead).collect();
    Some(Finding {
        sentence: sentence(frame, &own),
        table,
        digest: Some(digest(&paths)),
        figure: figure(frame, &paths),
    })
}

/// Environments of a sentence; the digest has all.
const TOLD: usize = 3;

/// One sentence an environment, at the ends of the alphas.
fn sentence(frame: &Frame, paths: &[&Path]) -> String {
    let [environment, alpha] = condition_axes();
    let say = |light: &Value| {
        let alphas = ascending(distinct_in_order(
            paths.iter().filter(|path| path.condition[0] == *light).map(|path| path.condition[1].clone()),
        ));
        let of = |width: &Value| paths.iter().find(|path| path.condition == [light.clone(), width.clone()]);
        let told = match alphas.as_slice() {
            [first, .., last] => vec![of(first)?, of(last)?],
            [only] => vec![of(only)?],
            [] => return None,
        };
        let way = |(i, path): (usize, &&&Path)| {
            let metric = if i == 0 { format!("{} ", frame.metric_name()) } else { String::new() };
            let [first, last] = path.ends().map(|point| number(point.error));
            let at = label(&[alpha], &path.condition[1..]);
            let at = if at.is_empty() { at } else { format!(" at {at}") };
            format!("from {metric}{first} to {last}{at}")
        };
        let ways: Vec<String> = told.iter().enumerate().map(way).collect();
        let [from, to] = told[0].ends().map(|point| number(point.range));
        let light = short(environment, light);
        Some(format!("In {light}, {from} to {to} stops, `{}` goes {}.", told[0].method, ways.join(", ")))
    };
    let lights = distinct_in_order(paths.iter().map(|path| path.condition[0].clone()));
    lights.iter().filter_map(say).take(TOLD).collect::<Vec<_>>().join(" ")
}

/// One row a method, environment and alpha.
fn digest(paths: &[Path]) -> Table {
    let names = ["method", "environment", "alpha", "from stops", "to stops", "error there", "error here"];
    let names = names.into_iter().chain(["growth", "factor a stop", "level from stops"]);
    let mut table = Table::with_names(names.map(str::to_owned).collect());
    for path in paths {
        let [first, last] = path.ends();
        let mut row = vec![Cell::Text(path.method.clone())];
        row.extend(condition_axes().iter().zip(&path.condition).map(|(axis, value)| Cell::Text(short(*axis, value))));
        row.extend([first.range, last.range, first.error, last.error, path.growth()].map(Cell::Number));
        row.extend([path.factor_a_stop(), path.level_from()].map(Cell::from));
        table.row(row);
    }
    table
}

/// One panel an environment and alpha, one line a method.
fn figure(frame: &Frame, paths: &[Path]) -> Option<Figure> {
    let methods = distinct_in_order(paths.iter().map(|path| path.method.clone()));
    let points = || paths.iter().flat_map(|path| &path.points);
    let panel = |condition: [Value; 2]| {
        let mut marks = Vec::new();
        for path in paths.iter().filter(|path| path.condition == condition) {
            let series = methods.iter().position(|method| *method == path.method)?;
            marks.push(Mark::new(
                Form::Line(path.points.iter().map(|point| [point.range, point.error]).collect()),
                series,
            ));
            for point in &path.points {
                let tip = format!("{} · {} stops: {}", path.method, number(point.range), number(point.error));
                let mark = Mark::new(Form::Dot([point.range, point.error]), series).tip(tip);
                marks.push(if point.rows.len() == 1 { mark.cell(&point.rows[0].cell.id) } else { mark });
            }
        }
        Some(Panel {
            title: label(&condition_axes(), &condition),
            x: Scale::linear("dynamic range, stops", points().map(|point| point.range))?,
            y: Scale::log(frame.metric_name(), points().map(|point| point.error))?,
            marks,
        })
    };
    let conditions = distinct_in_order(paths.iter().map(|path| path.condition.clone()));
    Some(Figure {
        title: "Error over the dynamic range of the environment".to_owned(),
        note: format!("{}; the same light with its peaks cut off", frame.metric_name()),
        panels: conditions.into_iter().filter_map(panel).collect(),
        series: methods.iter().map(|name| Series { name: name.clone(), is_dashed: false }).collect(),
        ramp: None,
    })
}
