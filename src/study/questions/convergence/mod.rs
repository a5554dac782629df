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

mod figure;

use super::prelude::*;
use super::{ERROR, IS_RESOLVED, NOISE_FLOOR};
use crate::study::frame::curve::{Curve, CurvePoint, curves, without_samples};
use crate::study::frame::line::{Line, POINTS_MIN};
use figure::figure;

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
    if !shape.methods().any(|method| method.uses_samples) {
        Some("axes.method has no sampling method")
    } else if shape.values[SAMPLES].len() < POINTS_MIN {
        Some("axes.samples has fewer than three counts")
    } else {
        None
    }
}

/// How the error of a method in a case falls with the sample count.
struct Fall<'r, 'f> {
    curve: Curve<'r, 'f>,
    /// `None` with too few resolved counts.
    line: Option<Line>,
    stops_at: Option<u32>,
}

impl<'r, 'f> Fall<'r, 'f> {
    fn new(curve: Curve<'r, 'f>) -> Self {
        let resolved: Vec<&CurvePoint> = curve
            .points
            .iter()
            .filter(|point| point.is_resolved)
            .collect();
        let logs: Vec<[f64; 2]> = resolved
            .iter()
            .map(|point| [f64::from(point.count).ln(), point.error.ln()])
            .collect();
        let flat_count = logs
            .windows(2)
            .rev()
            .take_while(|ends| is_flat(ends[0], ends[1]))
            .count();
        Self {
            line: Line::fit(&logs),
            stops_at: (flat_count > 0).then(|| resolved[resolved.len() - 1 - flat_count].count),
            curve,
        }
    }

    fn row(&self) -> &'r Row<'f> {
        self.curve.first()
    }
}

/// Whether doubling the samples between two points removes less than [`GAIN_MIN`] of the error;
/// coordinates are logarithms.
fn is_flat([x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> bool {
    (y1 - y0) / (x1 - x0) > (1.0 - GAIN_MIN).log2()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let axes = frame.case_axes();
    let images = frame.images();
    let fixed = without_samples(&images);
    let falls: Vec<Fall> = curves(frame, &images, &axes)
        .into_iter()
        .map(Fall::new)
        .collect();
    let fitted: Vec<&Fall> = falls.iter().filter(|fall| fall.line.is_some()).collect();
    let by_method = grouped(fitted, |fall| fall.curve.method.clone());
    Some(Finding {
        sentences: sentences(frame, &by_method.first()?.1)?,
        table: table(frame, &falls, &fixed),
        digest: Some(digest(frame, &by_method).without_empty()),
        figure: figure(frame, &axes, &falls, &fixed),
    })
}

fn table(frame: &Frame, falls: &[Fall], fixed: &[&Row]) -> Table {
    let case_axes = frame.table_axes();
    let axes = [&case_axes[..], &[METHOD, SAMPLES]].concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for fall in falls {
        for point in &fall.curve.points {
            let mut row = fall.row().cells(&case_axes);
            row.extend(cells![
                &Variant::new(fall.curve.method.to_string()),
                point.count,
                point.error,
                frame.noise_floor(point.rows[0]),
                point.is_resolved,
                fall.line.map(|line| line.slope),
                fall.line.map(|line| line.standard_error),
                fall.stops_at
            ]);
            table.row(row);
        }
    }
    for image in fixed {
        let mut row = image.cells(&axes);
        row.extend(cells![
            frame.error(image),
            frame.noise_floor(image),
            frame.is_resolved(image),
            Cell::Missing,
            Cell::Missing,
            Cell::Missing
        ]);
        table.row(row);
    }
    table
}

/// The factor by which doubling the samples divides the error of each curve.
fn doublings<'r, 'f>(falls: &[&Fall<'r, 'f>]) -> Numbers<'r, 'f> {
    let factors = falls
        .iter()
        .filter_map(|fall| Some((fall.row(), (-fall.line?.slope).exp2())));
    Numbers::new(factors, Middle::Median)
}

/// The number of environments of these curves that count.
fn light_count(falls: &[&Fall], all: &Numbers) -> usize {
    let rows = falls.iter().map(|fall| fall.row());
    values(rows.filter(|row| all.counts(row)), ENVIRONMENT).len()
}

/// Smaller ratios of factors are not mentioned.
const CHANGE_MIN: f64 = 1.1;

fn sentences(frame: &Frame, falls: &[&Fall]) -> Option<Sentences> {
    let doublings = doublings(falls);
    let median = doublings.estimate()?;
    let headline = statement![
        "Doubling the samples divides the ",
        Phrase::Metric(frame.metric_name()),
        " of ",
        Phrase::Method(Variant::new(falls.first()?.curve.method.to_string())),
        " by ",
        estimated(&median).strong(),
        doublings.light(frame, ", in the median environment"),
        " (slope ",
        Number::rounded(-median.value.log2()),
        ")."
    ];
    let extremes = doublings.extremes(frame, "the factor", CHANGE_MIN, |factor| {
        Number::rounded(factor).into()
    });
    let sentences = Sentences::new(headline);
    match stop_statement(frame, falls, &doublings) {
        Some(stop) => Some(sentences.with_details(extremes.into_iter().chain([stop]))),
        None => Some(
            sentences
                .with_details(extremes)
                .with_scope(doublings.scope(frame)),
        ),
    }
}

/// Where the error stops falling; `None` if it falls to the end.
fn stop_statement(frame: &Frame, falls: &[&Fall], doublings: &Numbers) -> Option<Statement> {
    let stopping: Vec<&Fall> = falls
        .iter()
        .copied()
        .filter(|fall| fall.stops_at.is_some() && doublings.counts(fall.row()))
        .collect();
    let least = stopping.iter().filter_map(|fall| fall.stops_at).min()?;
    let samples = Quantity::new(Number::Count(least.into())).unit(Unit::SAMPLES);
    let light_count = self::light_count(falls, doublings);
    if light_count == 1 {
        let row_axis = frame.row_axis();
        let stopping = values(stopping.iter().map(|fall| fall.row()), row_axis);
        let stopping = stopping
            .iter()
            .map(|value| frame.names.short_phrase(row_axis, value).into());
        let places = frame.shape.is_swept(row_axis).then(|| {
            let name = frame.names.name(row_axis);
            statement![
                format!(" at {name} "),
                Statement::listed(stopping.collect())
            ]
        });
        return Some(statement![
            "It stops falling",
            places,
            ", from ",
            samples,
            "."
        ]);
    }
    Some(statement![
        "Under ",
        Number::Count(self::light_count(&stopping, doublings) as u64),
        " of ",
        Number::Count(light_count as u64),
        format!(
            " {} the error stops falling in some case, first at ",
            AXES[ENVIRONMENT].plural
        ),
        samples,
        "."
    ])
}

/// By method and [`Frame::row_axis`]: slope, factor of a doubling, where it stops.
fn digest(frame: &Frame, by_method: &[(Value, Vec<&Fall>)]) -> Table {
    let row_axis = frame.row_axis();
    let is_swept = frame.shape.is_swept(row_axis);
    let row_heads = if is_swept {
        frame.names.heads(&[row_axis])
    } else {
        Vec::new()
    };
    let mut heads = vec![AXES[METHOD].name];
    heads.extend(&row_heads);
    heads.extend([
        "slope",
        "a doubling divides by",
        AXES[ENVIRONMENT].plural,
        "of which it stops under",
        "stops at, median",
    ]);
    let mut table = Table::with_names(heads);
    for (method, falls) in by_method {
        if is_swept {
            for value in values(falls.iter().map(|fall| fall.row()), row_axis) {
                let falls: Vec<&Fall> = falls
                    .iter()
                    .copied()
                    .filter(|fall| fall.row().point[row_axis] == value)
                    .collect();
                let head = frame.names.head_of(row_axis, &value);
                digest_row(&mut table, method, head, &falls);
            }
            digest_row(&mut table, method, all_head(&row_heads), falls);
        } else {
            digest_row(&mut table, method, Vec::new(), falls);
        }
    }
    table
}

/// Adds the row of a group of curves, if some have a slope.
fn digest_row(table: &mut Table, method: &Value, head: Vec<Cell>, falls: &[&Fall]) {
    let Some(factor) = doublings(falls).estimate() else {
        return;
    };
    let stops = falls
        .iter()
        .filter_map(|fall| Some((fall.row(), f64::from(fall.stops_at?))));
    let stops = Numbers::new(stops, Middle::Median).estimate();
    let mut row = cells![&Variant::new(method.to_string())];
    row.extend(head);
    row.extend(cells![
        Number::rounded(-factor.value.log2()),
        estimated(&factor),
        factor.n,
        stops.map_or(0, |stops| stops.n),
        stops.map(|stops| Number::rounded(stops.value))
    ]);
    table.row(row);
}
