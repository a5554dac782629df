//! The figure of convergence: errors over sample counts, and the errors that samples compete with.

use super::Fall;
use crate::study::questions::prelude::*;

/// The noise floor is drawn if it is at most this factor below the smallest error.
const FLOOR_WITHIN: f64 = 100.0;

/// What a series of the figure shows.
#[derive(Clone, PartialEq, Eq, Hash)]
enum SeriesKey {
    /// The images of a method, by its code name.
    Method(String),
    /// The noise floor.
    Floor,
}

impl SeriesKey {
    fn of_curve(fall: &Fall) -> Self {
        Self::Method(fall.curve.method.to_string())
    }

    fn label(&self) -> String {
        match self {
            Self::Method(method) => Variant::new(method.as_str()).label(),
            Self::Floor => "noise floor".to_owned(),
        }
    }

    fn series(&self, is_dashed: bool) -> Series {
        match self {
            Self::Method(method) => method_series(self.label(), method, is_dashed),
            Self::Floor => Series {
                is_dashed,
                ..solid(self.label())
            },
        }
    }
}

/// What the panels of the figure share.
struct Drawing<'a, 'r, 'f> {
    frame: &'a Frame<'f>,
    /// The axes of cases.
    axes: &'a [AxisId],
    /// The axes that distinguish panels.
    panel_axes: Vec<AxisId>,
    /// The images of methods without samples.
    fixed: &'a [&'r Row<'f>],
    /// The smallest positive error.
    least_error: f64,
    /// Sampling methods, then rules.
    series: Vec<SeriesKey>,
}

/// One panel per value of [`Frame::row_axis`] and environment; lines of one panel and method differ
/// in the other axes of cases. If environments are averaged: one panel per value of
/// [`Frame::row_axis`], one line per method.
pub(super) fn figure(
    frame: &Frame,
    axes: &[AxisId],
    falls: &[Fall],
    fixed: &[&Row],
) -> Option<Figure> {
    let points = || {
        falls.iter().flat_map(|fall| {
            fall.curve
                .points
                .iter()
                .map(move |point| (fall.row(), point))
        })
    };
    let errors = points().map(|(row, point)| (row, point.error));
    let is_averaged = Numbers::new(errors, Middle::GeometricMean).has_interval();
    let mut panel_axes = axes.to_vec();
    panel_axes.retain(|axis| *axis == frame.row_axis() || (*axis == ENVIRONMENT && !is_averaged));
    let sampled = distinct_in_order(falls.iter().map(|fall| SeriesKey::of_curve(fall)));
    let mut drawing = Drawing {
        frame,
        axes,
        panel_axes,
        fixed,
        least_error: points()
            .map(|(_, point)| point.error)
            .filter(|error| *error > 0.0)
            .fold(f64::INFINITY, f64::min),
        series: sampled.clone(),
    };
    let has_floor = falls.iter().any(|fall| drawing.floor(fall).is_some());
    let rules = fixed.iter().map(|row| SeriesKey::Method(row.text(METHOD)));
    let rules = distinct_in_order(rules.chain(has_floor.then_some(SeriesKey::Floor)));
    drawing.series.extend(rules.iter().cloned());

    let sampled = sampled.iter().map(|key| key.series(false));
    let dashed = rules.iter().map(|key| key.series(true));
    Chart {
        title: "Error over sample count",
        note: note(frame, is_averaged, &rules),
        x: ChartAxis::Log("samples per pixel"),
        y: ChartAxis::Log(frame.metric_name()),
        panels: drawing.panels(falls, is_averaged),
        series: sampled.chain(dashed).collect(),
    }
    .figure()
}

fn note(frame: &Frame, is_averaged: bool, rules: &[SeriesKey]) -> String {
    let mut note = frame.metric_name().to_owned();
    if is_averaged {
        note += &format!(", geometric mean{INTERVAL}");
    }
    if !rules.is_empty() {
        let rules: Vec<String> = rules.iter().map(SeriesKey::label).collect();
        note += &format!("; dashed: {}", rules.join(", "));
    }
    note
}

impl<'r, 'f> Drawing<'_, 'r, 'f> {
    fn panels(&self, falls: &[Fall<'r, 'f>], is_averaged: bool) -> Vec<ChartPanel> {
        let by_panel = grouped(falls, |fall| fall.row().key(&self.panel_axes));
        let panel = |(key, falls): (Vec<Value>, Vec<&Fall<'r, 'f>>)| ChartPanel {
            title: self.frame.names.label(&self.panel_axes, &key),
            marks: if is_averaged {
                self.averages(&key, &falls)
            } else {
                self.images(&key, &falls)
            },
        };
        by_panel.into_iter().map(panel).collect()
    }

    fn index(&self, key: &SeriesKey) -> usize {
        self.series
            .iter()
            .position(|known| known == key)
            .unwrap_or(0)
    }

    /// The noise floor of a curve, if it is near the errors.
    fn floor(&self, fall: &Fall) -> Option<f64> {
        self.frame
            .noise_floor(fall.row())
            .filter(|floor| *floor > self.least_error / FLOOR_WITHIN)
    }

    /// The images without samples of a panel.
    fn fixed(&self, key: &[Value]) -> impl Iterator<Item = &'r Row<'f>> {
        self.fixed
            .iter()
            .copied()
            .filter(move |row| agree(&row.key(&self.panel_axes), key))
    }

    /// The means over environments: lines by method, then rules.
    fn averages(&self, key: &[Value], falls: &[&Fall<'r, 'f>]) -> Vec<Mark> {
        let mut marks = Vec::new();
        for (series, falls) in grouped(falls.iter().copied(), |fall| SeriesKey::of_curve(fall)) {
            marks.extend(self.average_line(&series, &falls));
        }
        for (series, rows) in grouped(self.fixed(key), |row| SeriesKey::Method(row.text(METHOD))) {
            let errors = rows
                .into_iter()
                .filter_map(|row| Some((row, self.frame.error(row)?)));
            marks.extend(self.average_rule(&series, errors));
        }
        let floors = falls
            .iter()
            .filter_map(|fall| Some((fall.row(), self.floor(fall)?)));
        marks.extend(self.average_rule(&SeriesKey::Floor, floors));
        marks
    }

    /// The mean error of a method by count.
    fn average_line(&self, series: &SeriesKey, falls: &[&Fall<'r, 'f>]) -> Vec<Mark> {
        let points = falls
            .iter()
            .flat_map(|fall| fall.curve.points.iter().map(|point| (fall.row(), point)));
        let mut dots = Vec::new();
        for (samples, points) in grouped(points, |(_, point)| point.count) {
            let row = points[0].0;
            let variant = Variant {
                samples: Some(samples),
                ..Variant::new(row.text(METHOD))
            };
            let errors = points
                .into_iter()
                .map(|(row, point)| (row, point.error))
                .filter(|(_, error)| *error > 0.0);
            dots.extend(Numbers::new(errors, Middle::GeometricMean).marks(
                self.index(series),
                &variant.label(),
                |error| [f64::from(samples), error],
                &with_interval,
            ));
        }
        joined(dots)
    }

    fn average_rule(
        &self,
        series: &SeriesKey,
        numbers: impl IntoIterator<Item = (&'r Row<'f>, f64)>,
    ) -> Option<Mark> {
        let mean = Numbers::new(numbers, Middle::GeometricMean).estimate()?;
        let rule = Mark::new(Form::HorizontalRule(mean.value), self.index(series));
        Some(rule.tip(format!("{}: {}", series.label(), with_interval(&mean))))
    }

    /// The images under one environment: a line for each curve, a rule for each image without
    /// samples, and the noise floor.
    fn images(&self, key: &[Value], falls: &[&Fall]) -> Vec<Mark> {
        let frame = self.frame;
        let mut marks = Vec::new();
        for fall in falls {
            let label = frame.names.label(self.axes, &fall.curve.key);
            let points = fall.curve.points.iter().filter(|point| point.error > 0.0);
            let dots = points.map(|point| {
                let row = point.rows[0];
                let series = self.index(&SeriesKey::Method(row.text(METHOD)));
                let variant = frame.variant(row).label();
                let tip = format!("{variant}: {} · {label}", number(point.error));
                dot([f64::from(point.count), point.error], series, tip, row)
            });
            marks.extend(joined(dots.collect()));
        }
        for row in self.fixed(key) {
            let Some(error) = frame.error(row).filter(|error| *error > 0.0) else {
                continue;
            };
            let series = self.index(&SeriesKey::Method(row.text(METHOD)));
            let tip = format!("{}: {}", frame.variant(row).label(), number(error));
            let rule = Mark::new(Form::HorizontalRule(error), series);
            marks.push(rule.tip(tip).cell(&*row.cell.id));
        }
        if let Some(floor) = falls.first().and_then(|fall| self.floor(fall)) {
            let rule = Mark::new(Form::HorizontalRule(floor), self.index(&SeriesKey::Floor));
            let tip = format!("{}: {}", SeriesKey::Floor.label(), number(floor));
            marks.push(rule.tip(tip));
        }
        marks
    }
}
