//! The error of each method, over the error of the first split sum (the *base*), against the
//! lookups of an environment map per pixel ([`Method::lookups_of_pixel`]); lookups of small tables
//! do not count.

use super::numbers::middle_dot;
use super::prelude::*;
use crate::base::names::Listed;
use crate::instrument::shade::Method;

/// The surface axes that matter most.
pub const SURFACE: [AxisId; 3] = [ALPHA, BRDF, F0];

/// Lookups of an environment map per pixel; `None` for a shader in a file.
fn lookups(row: &Row) -> Option<f64> {
    Method::by_name(&row.text(METHOD))?
        .lookups_of_pixel(row.samples())
        .map(f64::from)
}

/// Images with their error over the base's in the same case.
pub struct Ratios<'r, 'f> {
    /// The first method with a prefiltered map.
    pub base: Value,
    pub rows: Vec<(&'r Row<'f>, f64)>,
}

impl<'r, 'f> Ratios<'r, 'f> {
    /// `None` without a base.
    pub fn new(frame: &Frame, images: &[&'r Row<'f>]) -> Option<Self> {
        let axes = frame.case_axes();
        let base = images.iter().find(|row| uses_prefiltered(row))?.point[METHOD].clone();
        let bases: Vec<(Key, &Row)> = images
            .iter()
            .filter(|row| row.point[METHOD] == base)
            .map(|row| (row.key(&axes), *row))
            .collect();
        let ratio = |row: &Row| {
            let key = row.key(&axes);
            let (_, base) = bases.iter().find(|(base, _)| agree(base, &key))?;
            let ratio = frame.error(row)? / frame.error(base)?;
            (ratio.is_finite() && ratio > 0.0).then_some(ratio)
        };
        let rows = images.iter().filter_map(|row| Some((*row, ratio(row)?)));
        Some(Self {
            rows: rows.collect(),
            base,
        })
    }
}

fn uses_prefiltered(row: &Row) -> bool {
    Method::by_name(&row.text(METHOD)).is_some_and(Method::uses_prefiltered)
}

/// The images of one method with the same parameters.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Curve {
    method: String,
    name: String,
    /// Whether the method has no samples, so that the curve has one point.
    is_fixed: bool,
}

/// A number of lookups.
struct Point {
    /// `None` if the lookups are unknown.
    position: Option<[f64; 2]>,
    mark: Mark,
}

/// One panel per value of [`Frame::row_axis`]; of other swept surfaces the first. A sampling method
/// is a line over its counts. Another method is a dot at its lookups, from which a dashed line
/// leads to the right: sampling wins where its line is below.
pub fn figure(frame: &Frame) -> Option<Figure> {
    let images = frame.images();
    let Ratios { base, mut rows } = Ratios::new(frame, &images)?;
    let row_axis = frame.row_axis();
    let others: Vec<AxisId> = SURFACE
        .into_iter()
        .filter(|axis| *axis != row_axis && frame.shape.is_swept(*axis))
        .collect();
    let surface = rows.first()?.0.key(&others);
    rows.retain(|(row, _)| row.key(&others) == surface);

    let parameters = frame.swept(&[Part::Parameter, Part::Table]);
    let curve = |row: &Row| Curve {
        method: row.text(METHOD),
        name: curve_name(frame, &parameters, row),
        is_fixed: row.samples().is_none(),
    };
    let mut curves = distinct_in_order(rows.iter().map(|(row, _)| curve(row)));
    curves.sort_by_key(|curve| !curve.is_fixed);
    let most_lookups = rows
        .iter()
        .filter_map(|(row, _)| lookups(row))
        .fold(0.0, f64::max);

    let mut panels = Vec::new();
    for (value, rows) in grouped_ascending(rows, row_axis, |(row, _)| row) {
        let mut marks = Vec::new();
        for (curve, rows) in grouped(rows, |(row, _)| curve(row)) {
            let series = step(&curves, &curve) as usize;
            let points = points(frame, series, &rows);
            marks.extend(curve_marks(&curve, series, points, most_lookups));
        }
        let is_swept = frame.shape.is_swept(row_axis);
        let title = is_swept.then(|| frame.names.heading(row_axis, &value));
        panels.push(ChartPanel {
            title: title.unwrap_or_default(),
            marks,
        });
    }
    let metric = frame.metric_name();
    Chart {
        title: "Error against map lookups per pixel",
        note: commas([
            metric,
            &format!("relative to {}", Variant::new(base.to_string()).label()),
            "median environment",
            &frame.names.comma_label(&others, &surface),
        ]) + "; dashed: without samples; sampling wins where its line is below",
        x: ChartAxis::Log("map lookups per pixel"),
        y: ChartAxis::Log(&format!("relative {metric}")),
        panels,
        series: curves
            .into_iter()
            .map(|curve| method_series(curve.name, &curve.method, curve.is_fixed))
            .collect(),
    }
    .figure()
}

/// The title of a method, since the word `sampled` alone also means a prefilter, and its swept
/// parameters.
fn curve_name(frame: &Frame, parameters: &[AxisId], row: &Row) -> String {
    let title = Method::by_name(&row.text(METHOD)).map_or("", |method| method.title);
    let parameters = frame.names.comma_label(parameters, &row.key(parameters));
    commas([title, &parameters])
}

/// The median ratio of each sample count of a curve.
fn points(frame: &Frame, series: usize, rows: &[(&Row, f64)]) -> Vec<Point> {
    let mut points = Vec::new();
    for (variant, rows) in grouped(rows.iter().copied(), |(row, _)| frame.variant(row)) {
        let numbers = Numbers::new(rows.iter().copied(), Middle::Median);
        let Some(median) = numbers.estimate() else {
            continue;
        };
        points.push(match lookups(rows[0].0) {
            Some(lookups) => {
                let position = [lookups, median.value];
                let dot = middle_dot(&median, series, &variant.label(), position, &with_interval);
                Point {
                    position: Some(position),
                    mark: Mark {
                        cell: only(&numbers.rows().collect::<Vec<_>>()),
                        ..dot
                    },
                }
            }
            None => Point {
                position: None,
                mark: Mark::new(Form::HorizontalRule(median.value), series).tip(format!(
                    "{}: {}",
                    variant.label(),
                    with_interval(&median)
                )),
            },
        });
    }
    points
}

/// The points of a curve with its line: through the points of a sampling method, to the right of
/// another one.
fn curve_marks(curve: &Curve, series: usize, points: Vec<Point>, most_lookups: f64) -> Vec<Mark> {
    let first = points.first().and_then(|point| point.position);
    let marks: Vec<Mark> = points.into_iter().map(|point| point.mark).collect();
    if !curve.is_fixed {
        return joined(marks);
    }
    let line = first.map(|[x, y]| {
        let line = Form::Line(vec![[x, y], [most_lookups, y]]);
        Mark::new(line, series)
    });
    line.into_iter().chain(marks).collect()
}
