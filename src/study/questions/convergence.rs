//! How does the error fall with the sample count, and where does it stop?
//!
//! In a case let e(N) be the error of a sampling method with N samples per pixel (geometric mean
//! over point sets). The *slope* belongs to the least-squares line of ln e over ln N: -1 for plain
//! Monte Carlo in squared error; bias draws it towards 0. Only resolved points count. Its standard
//! error comes from the residuals, so a curve that bends has a large one. Doubling the samples
//! divides the error by 2^-slope.
//!
//! An error *stops falling* at the smallest tried count from which doubling the samples removes
//! less than [`GAIN_MIN`], up to the largest resolved count.

use super::prelude::*;
use super::{ERROR, IS_RESOLVED, NOISE_FLOOR};
use crate::study::frame::curve::{Curve, CurvePoint, curves, without_samples};
use crate::study::frame::line::{Line, POINTS_MIN};

pub const QUESTION: Question = Question {
    name: "convergence",
    asks: "How does the error fall with the sample count, and where does it stop?",
    columns: &[
        ERROR,
        NOISE_FLOOR,
        IS_RESOLVED,
        column(
            "slope",
            "Slope of ln error over ln samples of the resolved counts; -1 is plain Monte Carlo.",
        ),
        column(
            "slope_standard_error",
            "Standard error of that slope, from the residuals.",
        ),
        column(
            "stops_at",
            "Count from which doubling it removes less than 10 %; empty if the error falls to the \
             end.",
        ),
    ],
    lacks,
    answer,
    ..Question::PLAIN
};

/// The error has stopped falling if a doubling removes less than this share.
const GAIN_MIN: f64 = 0.1;

fn lacks(shape: &Shape) -> Option<&'static str> {
    match () {
        () if !shape.methods().any(|method| method.uses_samples) => {
            Some("axes.method has no sampling method")
        }
        () if shape.values[SAMPLES].len() < POINTS_MIN => {
            Some("axes.samples has fewer than three counts")
        }
        () => None,
    }
}

struct Fall<'r, 'f> {
    curve: Curve<'r, 'f>,
    line: Option<Line>,
    stops_at: Option<u32>,
}

impl Fall<'_, '_> {
    fn of<'r, 'f>(curve: Curve<'r, 'f>) -> Fall<'r, 'f> {
        let resolved: Vec<&CurvePoint> = curve
            .points
            .iter()
            .filter(|point| point.is_resolved)
            .collect();
        let logs: Vec<[f64; 2]> = resolved
            .iter()
            .map(|point| [f64::from(point.count).ln(), point.error.ln()])
            .collect();
        let is_flat = |ends: &[[f64; 2]]| {
            (ends[1][1] - ends[0][1]) / (ends[1][0] - ends[0][0]) > (1.0 - GAIN_MIN).log2()
        };
        let flat = logs
            .windows(2)
            .rev()
            .take_while(|ends| is_flat(ends))
            .count();
        let stops_at = (flat > 0).then(|| resolved[resolved.len() - 1 - flat].count);
        Fall {
            line: Line::of(&logs),
            stops_at,
            curve,
        }
    }
}

fn answer(frame: &Frame) -> Option<Finding> {
    let (axes, images) = (frame.case_axes(), frame.images());
    let fixed = without_samples(&images);
    let falls: Vec<Fall> = curves(frame, &images, &axes)
        .into_iter()
        .map(Fall::of)
        .collect();
    let columns = frame.table_axes();
    let of_row = [&columns[..], &[METHOD, SAMPLES]].concat();
    let mut table = Table::new(&of_row, QUESTION.columns);
    for (fall, point) in falls
        .iter()
        .flat_map(|fall| fall.curve.points.iter().map(move |point| (fall, point)))
    {
        let mut row = fall.curve.first().cells(&columns);
        row.extend(cells![
            &fall.curve.method,
            point.count,
            point.error,
            frame.noise_floor(point.rows[0]),
            point.is_resolved
        ]);
        let [slope, standard_error] = [
            fall.line.map(|line| line.slope),
            fall.line.map(|line| line.standard_error),
        ];
        row.extend(cells![slope, standard_error, fall.stops_at]);
        table.row(row);
    }
    for row in &fixed {
        let own = cells![
            frame.error(row),
            frame.noise_floor(row),
            frame.is_resolved(row)
        ];
        table.row([row.cells(&of_row), own, vec![Cell::Missing; 3]].concat());
    }
    let fitted: Vec<&Fall> = falls.iter().filter(|fall| fall.line.is_some()).collect();
    let by_method = grouped(fitted, |fall| fall.curve.method.clone());
    Some(Finding {
        sentence: sentence(frame, &by_method.first()?.1)?,
        table,
        digest: Some(digest(frame, &by_method).without_empty()),
        figure: figure(frame, &axes, &falls, &fixed),
    })
}

/// The factor by which doubling the samples divides the error of each curve.
fn doublings<'r, 'f>(falls: &[&Fall<'r, 'f>]) -> Numbers<'r, 'f> {
    let factors = falls
        .iter()
        .filter_map(|fall| Some((fall.curve.first(), (-fall.line?.slope).exp2())));
    Numbers::new(factors, Middle::Median)
}

fn lights(falls: &[&Fall], all: &Numbers) -> usize {
    values(
        falls
            .iter()
            .map(|fall| fall.curve.first())
            .filter(|row| all.weighs(row)),
        ENVIRONMENT,
    )
    .len()
}

/// Smaller ratios of factors are not mentioned.
const CHANGE_MIN: f64 = 1.1;

fn sentence(frame: &Frame, falls: &[&Fall]) -> Option<String> {
    let doublings = doublings(falls);
    let middle = doublings.estimate()?;
    let text = format!(
        "Doubling the samples divides the `{}` of `{}` by **{}**{}{} (slope {}).{}",
        frame.metric_name(),
        falls.first()?.curve.method,
        number(middle.value),
        interval_words(&middle, number),
        doublings.place(frame, ", in the median environment"),
        number(-middle.value.log2()),
        doublings.extremes(frame, "the factor", CHANGE_MIN, number)
    );
    let stops = |fall: &&Fall| fall.stops_at.is_some() && doublings.weighs(fall.curve.first());
    let stopping: Vec<&Fall> = falls.iter().copied().filter(stops).collect();
    let from = stopping.iter().filter_map(|fall| fall.stops_at).min();
    let end = match (from, lights(falls, &doublings)) {
        (None, _) => doublings.scope(frame),
        (Some(least), 1) => {
            let samples = count(least as usize, "sample", "samples");
            let of = frame.row_axis();
            let at = values(stopping.iter().map(|fall| fall.curve.first()), of);
            let at: Vec<String> = at
                .iter()
                .map(|value| frame.names.short(of, value))
                .collect();
            let at = match frame.shape.is_swept(of) {
                true => format!(" at {} {}", frame.names.name(of), listed(&at)),
                false => String::new(),
            };
            format!(" It stops falling{at}, from {samples}.")
        }
        (Some(least), n) => {
            let (stopping, plural) = (lights(&stopping, &doublings), AXES[ENVIRONMENT].plural);
            let samples = count(least as usize, "sample", "samples");
            format!(
                " Under {stopping} of {n} {plural} the error stops falling in some case, first at \
                 {samples}."
            )
        }
    };
    Some(text + &end)
}

/// By method and [`Frame::row_axis`]: slope, factor of a doubling, where it stops.
fn digest(frame: &Frame, by_method: &[(Value, Vec<&Fall>)]) -> Table {
    let of = frame.row_axis();
    let heads = if frame.shape.is_swept(of) {
        frame.names.heads(&[of])
    } else {
        Vec::new()
    };
    let names = [
        "slope",
        "a doubling divides by",
        AXES[ENVIRONMENT].plural,
        "of which it stops under",
        "stops at, median",
    ];
    let mut table = Table::with_names(
        [AXES[METHOD].name]
            .into_iter()
            .chain(heads.iter().copied())
            .chain(names),
    );
    for (method, own) in by_method {
        let widths = values(own.iter().map(|fall| fall.curve.first()), of);
        for width in widths
            .iter()
            .map(Some)
            .filter(|_| !heads.is_empty())
            .chain([None])
        {
            let is_own =
                |fall: &&&Fall| width.is_none_or(|width| fall.curve.first().point[of] == *width);
            let group: Vec<&Fall> = own.iter().filter(is_own).copied().collect();
            let Some(factor) = doublings(&group).estimate() else {
                continue;
            };
            let mut row = cells![method];
            if !heads.is_empty() {
                row.extend(
                    width.map_or_else(|| all_head(&heads), |value| frame.names.head_of(of, value)),
                );
            }
            let stops = group
                .iter()
                .filter_map(|fall| Some((fall.curve.first(), fall.stops_at?.into())));
            let stops = Numbers::new(stops, Middle::Median).estimate();
            row.extend(cells![
                number(-factor.value.log2()),
                with_interval(&factor),
                factor.n
            ]);
            row.extend(cells![
                stops.map_or(0, |stops| stops.n),
                stops.map(|stops| number(stops.value))
            ]);
            table.row(row);
        }
    }
    table
}

/// The noise floor is drawn if it is at most this factor below the smallest error.
const FLOOR_WITHIN: f64 = 100.0;
const FLOOR: &str = "noise floor";

/// One panel per value of [`Frame::row_axis`] and environment; lines of one panel and method differ
/// in the other axes of cases. If environments are averaged: one panel per value of
/// [`Frame::row_axis`], one line per method.
fn figure(frame: &Frame, axes: &[AxisId], falls: &[Fall], fixed: &[&Row]) -> Option<Figure> {
    let errors = falls.iter().flat_map(|fall| {
        fall.curve
            .points
            .iter()
            .map(|point| (fall.curve.first(), point.error))
    });
    let is_summed = Numbers::new(errors, Middle::GeometricMean).is_summed();
    let is_panel = |of: &AxisId| *of == frame.row_axis() || (*of == ENVIRONMENT && !is_summed);
    let of_panel: Vec<AxisId> = axes.iter().copied().filter(is_panel).collect();
    let sampled = distinct_in_order(falls.iter().map(|fall| fall.curve.method.to_string()));
    let errors = falls
        .iter()
        .flat_map(|fall| &fall.curve.points)
        .map(|point| point.error);
    let least = errors
        .filter(|error| *error > 0.0)
        .fold(f64::INFINITY, f64::min);
    let floor = |fall: &Fall| {
        frame
            .noise_floor(fall.curve.first())
            .filter(|floor| *floor > least / FLOOR_WITHIN)
    };
    let has_floor = falls.iter().any(|fall| floor(fall).is_some());
    let dashed = fixed
        .iter()
        .map(|row| row.text(METHOD))
        .chain(has_floor.then(|| FLOOR.to_owned()));
    let dashed = distinct_in_order(dashed);
    let series = [&sampled[..], &dashed[..]].concat();
    let index = |name: &str| series.iter().position(|known| known == name).unwrap_or(0);
    let panel = |(key, own): (Key, Vec<&Fall>)| {
        let mut marks: Vec<Mark> = Vec::new();
        if is_summed {
            marks = summed(&own, &|name| index(name));
            let fixed = fixed.iter().filter(|row| fits(&row.key(&of_panel), &key));
            for (name, rows) in grouped(fixed, |row| row.text(METHOD)) {
                let errors = rows
                    .iter()
                    .filter_map(|row| Some((**row, frame.error(row)?)));
                marks.extend(rule(
                    &name,
                    Numbers::new(errors, Middle::GeometricMean),
                    index(&name),
                ));
            }
            let floors = own
                .iter()
                .filter_map(|fall| Some((fall.curve.first(), floor(fall)?)));
            marks.extend(rule(
                FLOOR,
                Numbers::new(floors, Middle::GeometricMean),
                index(FLOOR),
            ));
            return (frame.names.label(&of_panel, &key), marks);
        }
        for fall in &own {
            let dots = fall
                .curve
                .points
                .iter()
                .filter(|point| point.error > 0.0)
                .map(|point| {
                    let row = point.rows[0];
                    let label = frame.names.label(axes, &fall.curve.key);
                    let tip = format!("{}: {} · {label}", frame.way(row), number(point.error));
                    dot(
                        [f64::from(point.count), point.error],
                        index(&row.text(METHOD)),
                        tip,
                        row,
                    )
                });
            marks.extend(joined(dots.collect()));
        }
        for row in fixed.iter().filter(|row| fits(&row.key(&of_panel), &key)) {
            let Some(error) = frame.error(row).filter(|error| *error > 0.0) else {
                continue;
            };
            let rule = Mark::new(Form::HorizontalRule(error), index(&row.text(METHOD)));
            marks.push(
                rule.tip(format!("{}: {}", frame.way(row), number(error)))
                    .cell(&row.cell.id),
            );
        }
        if let Some(floor) = own.first().and_then(|fall| floor(fall)) {
            let rule = Mark::new(Form::HorizontalRule(floor), index(FLOOR));
            marks.push(rule.tip(format!("{FLOOR}: {}", number(floor))));
        }
        (frame.names.label(&of_panel, &key), marks)
    };
    let panels = grouped(falls, |fall| fall.curve.first().key(&of_panel))
        .into_iter()
        .map(panel)
        .collect();
    let figure = Chart {
        title: "Error over sample count",
        note: {
            let mean = if is_summed {
                format!(", geometric mean{INTERVAL}")
            } else {
                String::new()
            };
            let dashes = if dashed.is_empty() {
                String::new()
            } else {
                format!("; dashed: {}", dashed.join(", "))
            };
            format!("{}{mean}{dashes}", frame.metric_name())
        },
        x: Along::Log("samples per pixel"),
        y: Along::Log(frame.metric_name()),
        panels,
        series: series.clone(),
    };
    let mut figure = figure.figure()?;
    figure
        .series
        .iter_mut()
        .skip(sampled.len())
        .for_each(|series| series.is_dashed = true);
    Some(figure)
}

/// The mean error over environments by method and count.
fn summed(own: &[&Fall], index: &dyn Fn(&str) -> usize) -> Vec<Mark> {
    let of_method = |(method, falls): (Value, Vec<&&Fall>)| {
        let points = || {
            falls.iter().flat_map(|fall| {
                fall.curve
                    .points
                    .iter()
                    .map(|point| (fall.curve.first(), point))
            })
        };
        let by_count = grouped(points(), |(_, point)| point.count);
        let dots = by_count.into_iter().flat_map(|(samples, own)| {
            let errors = own
                .iter()
                .map(|(row, point)| (*row, point.error))
                .filter(|(_, error)| *error > 0.0);
            let name = format!("{method} {samples}");
            let at = |error: f64| [f64::from(samples), error];
            Numbers::new(errors, Middle::GeometricMean).marks(
                index(&method.to_string()),
                at,
                (&name, &with_interval),
            )
        });
        joined(dots.collect())
    };
    grouped(own, |fall| fall.curve.method.clone())
        .into_iter()
        .flat_map(of_method)
        .collect()
}

fn rule(name: &str, own: Numbers, series: usize) -> Option<Mark> {
    let mean = own.estimate()?;
    Some(
        Mark::new(Form::HorizontalRule(mean.value), series)
            .tip(format!("{name}: {}", with_interval(&mean))),
    )
}
