//! How does the error fall with the sample count, and where does it stop?
//!
//! In a case let e(N) be the error of a sampling method with N samples a pixel (geometric mean over point sets). The *slope* is that of the
//! least-squares line of ln e over ln N; plain Monte Carlo has -1 in squared error, and a bias, which no sample removes, draws it towards 0.
//! Points that do not stand clear of the reference's noise are left out: there the error is the reference's. The standard error of the
//! slope comes from the residuals, so that a curve that bends has a large one. Twice the samples divide the error by 2^-slope.
//!
//! An error *stops falling* at the smallest tried count from which on doubling the samples takes off less than [`GAIN_MIN`], up to the
//! largest count that stands clear of the noise. Where bias and variance were parted, their share at the largest count says why.

use super::conditions::{ROUGHNESS, extremes, roughness};
use super::words::{by_axis, cases_sentence, interval_words, label, number, percent, short, with_interval};
use super::{Finding, Question};
use crate::runner::axis::AXES;
use crate::study::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::study::frame::curve::{Curve, CurvePoint, curves, mean, without_samples};
use crate::study::frame::estimate::{Estimate, estimate, median};
use crate::study::frame::line::{Line, POINTS_MIN};
use crate::study::frame::{Frame, Key, Row, Shape, ascending, axis, distinct_in_order, fits};
use crate::study::table::{Column, Table, value_cell};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "convergence",
    asks: "How does the error fall with the sample count, and where does it stop?",
    columns: &[
        Column { name: "error", about: "Error in the metric of the question, geometric mean over point sets." },
        Column { name: "noise_floor", about: "Error that an exact image would have, from the reference's own noise." },
        Column { name: "is_resolved", about: "1 where the error stands clear of that noise, else 0." },
        Column {
            name: "bias_share",
            about: "Squared bias over mean square error; as an unbiased estimate it may fall below 0. Empty without [bias_variance].",
        },
        Column {
            name: "slope",
            about: "Slope of ln error over ln samples of the row's curve, over its resolved counts; -1 is plain Monte Carlo in squared error.",
        },
        Column { name: "slope_standard_error", about: "Standard error of that slope, from the residuals." },
        Column {
            name: "stops_at",
            about: "Tried count from which on twice the samples take off less than 10 % of the error; empty where it falls to the end.",
        },
    ],
    uses_times: false,
    lacks,
    answer,
};

/// A doubling of the samples that takes off less than this part of the error is no fall.
const GAIN_MIN: f64 = 0.1;

fn lacks(shape: &Shape) -> Option<&'static str> {
    let mut methods = crate::shade::METHODS.iter().filter(|method| shape.has("method", &[method.name]));
    match () {
        () if !methods.any(|method| method.uses_samples) => Some("axes.method has no method that samples"),
        () if shape.values[axis("samples")].len() < POINTS_MIN => Some("axes.samples has fewer than three counts"),
        () => None,
    }
}

/// A curve with what is fitted to it.
struct Fall<'r, 'f> {
    curve: Curve<'r, 'f>,
    line: Option<Line>,
    stops_at: Option<u32>,
}

impl Fall<'_, '_> {
    fn of<'r, 'f>(curve: Curve<'r, 'f>) -> Fall<'r, 'f> {
        let resolved: Vec<&CurvePoint> = curve.points.iter().filter(|point| point.is_resolved).collect();
        let logs: Vec<[f64; 2]> =
            resolved.iter().map(|point| [f64::from(point.samples).ln(), point.error.ln()]).collect();
        let is_flat =
            |ends: &[[f64; 2]]| (ends[1][1] - ends[0][1]) / (ends[1][0] - ends[0][0]) > (1.0 - GAIN_MIN).log2();
        let flat = logs.windows(2).rev().take_while(|ends| is_flat(ends)).count();
        let stops_at = (flat > 0).then(|| resolved[resolved.len() - 1 - flat].samples);
        Fall { line: Line::of(&logs), stops_at, curve }
    }

    /// The share of bias at the largest count.
    fn bias_share(&self) -> Option<f64> {
        self.curve.points.last()?.bias_share()
    }
}

fn answer(frame: &Frame) -> Option<Finding> {
    let (axes, images) = (frame.case_axes(), frame.images());
    let fixed = without_samples(&images);
    let falls: Vec<Fall> = curves(frame, &images, &axes).into_iter().map(Fall::of).collect();
    let lead: Vec<&Fall> = falls.iter().filter(|fall| fall.line.is_some()).collect();
    let method = lead.first()?.curve.method.clone();
    let lead: Vec<&Fall> = lead.into_iter().filter(|fall| fall.curve.method == method).collect();
    Some(Finding {
        sentence: sentence(frame, &axes, &lead)?,
        table: table(frame, &axes, &falls, &fixed),
        digest: Some(digest(frame, &falls)),
        figure: figure(frame, &axes, &falls, &fixed),
    })
}

fn table(frame: &Frame, axes: &[usize], falls: &[Fall], fixed: &[&Row]) -> Table {
    let columns: Vec<usize> = axes.iter().copied().chain([axis("method"), axis("samples")]).collect();
    let mut table = Table::new(&columns, QUESTION.columns);
    for fall in falls {
        for point in &fall.curve.points {
            let mut row: Vec<Cell> = fall.curve.key.iter().chain([&fall.curve.method]).map(value_cell).collect();
            row.extend([
                Cell::Integer(point.samples.into()),
                point.error.into(),
                frame.noise_floor(point.rows[0]).into(),
            ]);
            row.extend([Cell::Integer(point.is_resolved.into()), point.bias_share().into()]);
            row.extend([fall.line.map(|line| line.slope).into(), fall.line.map(|line| line.standard_error).into()]);
            row.push(fall.stops_at.map_or(Cell::Missing, |n| Cell::Integer(n.into())));
            table.row(row);
        }
    }
    for row in fixed {
        let mut cells: Vec<Cell> = row.key(&columns).iter().map(value_cell).collect();
        cells.extend([frame.error(row).into(), frame.noise_floor(row).into()]);
        cells.push(Cell::Integer(frame.is_resolved(row).into()));
        cells.extend([Cell::Missing, Cell::Missing, Cell::Missing, Cell::Missing]);
        table.row(cells);
    }
    table
}

/// By which factor twice the samples divide the error, at the median slope.
fn doubling(falls: &[&Fall]) -> Option<Estimate> {
    let environment = axis("environment");
    let slope = |fall: &&Fall| Some((fall.curve.first().point.0[environment].clone(), fall.line?.slope));
    estimate(&falls.iter().filter_map(slope).collect::<Vec<_>>(), |slopes| (-median(slopes)).exp2())
}

fn slope(falls: &[&Fall]) -> f64 {
    median(&falls.iter().filter_map(|fall| Some(fall.line?.slope)).collect::<Vec<_>>())
}

/// Factors that differ by less are told as one.
const CHANGE_MIN: f64 = 1.1;

fn sentence(frame: &Frame, axes: &[usize], falls: &[&Fall]) -> Option<String> {
    let (middle, first) = (doubling(falls)?, falls.first()?);
    let scope = match falls.len() {
        1 => format!(", under {}", short(axis("environment"), &first.curve.first().point.0[axis("environment")])),
        _ => ", in the median case".to_owned(),
    };
    let (factor, interval) = (number(middle.value), interval_words(&middle, number));
    let mut text = format!(
        "Twice the samples divide the `{}` of `{}` by **{factor}**{interval}{scope} (slope {}).",
        frame.metric_name(),
        first.curve.method,
        number(slope(falls))
    );
    let of =
        |own: &[&&Fall]| doubling(&own.iter().map(|fall| **fall).collect::<Vec<_>>()).map_or(f64::NAN, |one| one.value);
    if let Some((of, ends)) = extremes(falls, |fall| fall.curve.first(), of, CHANGE_MIN) {
        text += &by_axis("the factor", of, &ends, number);
    }
    let stops: Vec<u32> = falls.iter().filter_map(|fall| fall.stops_at).collect();
    text += &match (stops.iter().min(), falls.len()) {
        (None, n) => cases_sentence(&falls.iter().map(|fall| fall.curve.first()).collect::<Vec<_>>(), axes, n),
        (Some(least), 1) => format!(" It stops falling at {least} samples."),
        (Some(least), n) => format!(" In {} of {n} cases it stops falling, from {least} samples on.", stops.len()),
    };
    Some(text)
}

/// By method and alpha: slope, factor of a doubling, where it stops, and bias at the largest count.
fn digest(frame: &Frame, falls: &[Fall]) -> Table {
    let alpha = axis("alpha");
    let has_bias = falls.iter().any(|fall| fall.bias_share().is_some());
    let mut names: Vec<&str> = vec![AXES[axis("method")].name];
    let is_by_alpha = frame.shape.is_swept(alpha);
    names.extend(if is_by_alpha { vec![AXES[alpha].name, ROUGHNESS] } else { Vec::new() });
    names.extend(["slope", "a doubling divides by", "cases", "cases that stop", "stops at, median"]);
    names.extend(has_bias.then_some("bias share at most samples"));
    let mut table = Table::with_names(names.into_iter().map(str::to_owned).collect());
    for method in distinct_in_order(falls.iter().map(|fall| fall.curve.method.clone())) {
        let own: Vec<&Fall> = falls.iter().filter(|fall| fall.curve.method == method && fall.line.is_some()).collect();
        let width = |fall: &Fall| fall.curve.first().point.0[alpha].clone();
        let widths = ascending(distinct_in_order(own.iter().map(|fall| width(fall))));
        let each = widths.iter().map(Some).filter(|_| is_by_alpha);
        for value in each.chain([None]) {
            let group: Vec<&Fall> =
                own.iter().copied().filter(|fall| value.is_none_or(|value| width(fall) == *value)).collect();
            let Some(factor) = doubling(&group) else { continue };
            let stops: Vec<f64> = group.iter().filter_map(|fall| fall.stops_at.map(f64::from)).collect();
            let mut row = vec![Cell::Text(method.to_string())];
            if is_by_alpha {
                row.push(Cell::Text(value.map_or("all".to_owned(), |value| short(alpha, value))));
                row.push(value.and_then(roughness).into());
            }
            row.extend([Cell::Text(number(slope(&group))), Cell::Text(with_interval(&factor))]);
            row.extend([group.len(), stops.len()].map(|n| Cell::Integer(n as u64)));
            row.push(Some(median(&stops)).filter(|n| !n.is_nan()).into());
            if has_bias {
                let share = mean(group.iter().filter_map(|fall| fall.bias_share()));
                row.push(share.map_or(Cell::Missing, |share| Cell::Text(percent(share.max(0.0)))));
            }
            table.row(row);
        }
    }
    table
}

/// Panels of a figure; the table has the others.
const PANELS_MAX: usize = 12;
/// The noise floor is drawn where it is no further than this below the smallest error.
const FLOOR_WITHIN: f64 = 100.0;
const FLOOR: &str = "noise floor";

/// Small multiples by alpha and environment; lines of one panel and method differ in the other axes of cases.
fn figure(frame: &Frame, axes: &[usize], falls: &[Fall], fixed: &[&Row]) -> Option<Figure> {
    let mut series: Vec<Series> = Vec::new();
    let mut index = |name: &str, is_dashed: bool| {
        series.iter().position(|known| known.name == name).unwrap_or_else(|| {
            series.push(Series { name: name.to_owned(), is_dashed });
            series.len() - 1
        })
    };
    let of_panel: Vec<usize> =
        axes.iter().copied().filter(|of| [axis("alpha"), axis("environment")].contains(of)).collect();
    let key = |row: &Row| row.key(&of_panel);
    let mut keys = distinct_in_order(falls.iter().map(|fall| key(fall.curve.first())));
    let panel_count = keys.len();
    keys.truncate(PANELS_MAX);
    let points = || falls.iter().flat_map(|fall| &fall.curve.points);
    let errors: Vec<f64> = points()
        .map(|point| point.error)
        .chain(fixed.iter().filter_map(|row| frame.error(row)))
        .filter(|x| *x > 0.0)
        .collect();
    let least = errors.iter().copied().reduce(f64::min)?;
    let floor = |row: &Row| frame.noise_floor(row).filter(|floor| *floor > least / FLOOR_WITHIN);
    let floors = falls.iter().filter_map(|fall| floor(fall.curve.first()));
    let y = Scale::log(frame.metric_name(), errors.iter().copied().chain(floors))?;
    let x = Scale::log("samples a pixel", points().map(|point| f64::from(point.samples)))?;
    let mut panel = |wanted: &Key| {
        let mut marks = Vec::new();
        let own = || falls.iter().filter(|fall| key(fall.curve.first()) == *wanted);
        for fall in own() {
            let series = index(&fall.curve.method.to_string(), false);
            let places = fall.curve.points.iter().map(|point| ([f64::from(point.samples), point.error], point));
            let places: Vec<([f64; 2], &CurvePoint)> = places.filter(|(at, _)| at[1] > 0.0).collect();
            marks.push(Mark::new(Form::Line(places.iter().map(|(at, _)| *at).collect()), series));
            for (at, point) in places {
                let row = point.rows[0];
                let tip = format!("{}: {} · {}", frame.way(row), number(point.error), label(axes, &fall.curve.key));
                marks.push(Mark::new(Form::Dot(at), series).tip(tip).cell(&row.cell.id));
            }
        }
        for row in fixed.iter().filter(|row| fits(&key(row), wanted)) {
            let Some(error) = frame.error(row).filter(|error| *error > 0.0) else { continue };
            let tip = format!("{}: {}", frame.way(row), number(error));
            let series = index(&row.text(axis("method")), true);
            marks.push(Mark::new(Form::HorizontalRule(error), series).tip(tip).cell(&row.cell.id));
        }
        if let Some(floor) = own().next().and_then(|fall| floor(fall.curve.first())) {
            marks.push(
                Mark::new(Form::HorizontalRule(floor), index(FLOOR, true)).tip(format!("{FLOOR}: {}", number(floor))),
            );
        }
        Panel { title: label(&of_panel, wanted), x: x.clone(), y: y.clone(), marks }
    };
    let panels: Vec<Panel> = keys.iter().map(&mut panel).collect();
    let cut = if panel_count > panels.len() {
        format!("; the first {} of {panel_count} panels", panels.len())
    } else {
        String::new()
    };
    let dashed = match series.iter().any(|one| one.name == FLOOR) {
        true => "dashed: methods without samples, and the reference's noise",
        false => "dashed: methods without samples",
    };
    Some(Figure {
        title: "Error over sample count".to_owned(),
        note: format!("{}; {dashed}{cut}", frame.metric_name()),
        panels,
        series,
        ramp: None,
    })
}
