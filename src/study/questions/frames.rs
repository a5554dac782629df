//! From how many frames on does sampling with a few samples a frame beat a method without samples?
//!
//! [`super::break_even`] with frames in place of samples: a curve has one sample count, motion and
//! history. Images of one frame belong to every motion. The last frame is compared, so under motion
//! the error has the lag of the frames before.

use super::break_even::{
    Ends, HI, LO, METRIC, N, Pair, conditions, digest, lacks_counts, pairs, table,
};
use super::by_lookups::Ratios;
use super::numbers::middle_dot;
use super::prelude::*;
use super::{FIXED, SAMPLED};

pub const QUESTION: Question = Question {
    name: "frames",
    asks: "From how many frames on does sampling beat a method without samples?",
    columns: &[
        METRIC,
        FIXED,
        SAMPLED,
        column(
            "break_even",
            "Frames from which sampling errs less, median over environments; empty above all \
             tried.",
        ),
        LO,
        HI,
        N,
        column("largest_tried", "Largest frame count tried in every case."),
        column(
            "ratio",
            "Error at that count over the error of the method without samples, median over \
             environments.",
        ),
        column(
            "lag_bias",
            "`lag_bias` at that count, median over environments.",
        ),
        column(
            "flicker",
            "`flicker` at that count, median over environments.",
        ),
    ],
    lacks,
    answer,
    ..Question::PLAIN
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    lacks_counts(shape, FRAMES, "axes.frames has fewer than two counts")
}

fn answer(frame: &Frame) -> Option<Finding> {
    let frame = &Frame {
        curve_axis: FRAMES,
        ..frame.like(frame.run, frame.metric_name())
    };
    let all = pairs(frame);
    let axes = conditions(frame);
    Some(Finding {
        sentences: sentences(frame, &axes, &all)?,
        table: table(frame, &axes, QUESTION.columns, &all, last_cells),
        digest: Some(digest(frame, &axes, &all, "frames")),
        figure: figure(frame),
    })
}

/// Error over the other method's, lag bias and flicker at the largest count.
fn last_cells(pair: &Pair) -> Vec<Cell> {
    let last = &pair.at_largest;
    [last.ratio, last.lag_bias, last.flicker]
        .map(|x| Cell::from(Some(x).filter(|x| x.is_finite())))
        .into()
}

/// How a method samples: "1 sample a frame, light", by the axes with `is_shown`; a method by its
/// label.
fn sampling(
    frame: &Frame,
    axes: &[AxisId],
    key: &[Value],
    is_shown: impl Fn(AxisId) -> bool,
) -> String {
    let mut samples = String::new();
    let mut others = Vec::new();
    for (&axis, value) in axes.iter().zip(key) {
        if axis == SAMPLES {
            samples = match value {
                Value::Count(1) => "1 sample a frame".to_owned(),
                count => format!("{count} samples a frame"),
            };
        } else if is_shown(axis) && axis == METHOD {
            others.push(Variant::new(value.to_string()).label());
        } else if is_shown(axis) && *value != Value::Unset {
            others.push(frame.names.value_label(axis, value));
        }
    }
    commas([&samples, &others.join(", ")])
}

/// " with 1 sample a frame"; empty without words.
fn with(sampling: &str) -> Statement {
    if sampling.is_empty() {
        Statement::default()
    } else {
        statement![" with ", sampling]
    }
}

/// The range of the first pair of methods, for its first sampling with its errors at the end, and
/// then for the sampling with the most frames.
fn sentences(frame: &Frame, axes: &[AxisId], all: &[Pair]) -> Option<Sentences> {
    let first = all.first()?;
    let same = all.iter().filter(|pair| pair.methods == first.methods);
    let by_sampling = grouped(same, |pair| {
        sampling(frame, axes, &pair.key, |axis| axis != frame.row_axis())
    });
    let (name, pairs) = by_sampling.first()?;
    let extent = Ends::find(pairs)?.extent();
    let (beats, end) = match extent.least {
        Number::MoreThan(most) => (" does not beat ", {
            let frames = Quantity::new(Number::Count(most))
                .unit(Unit::FRAMES)
                .strong();
            statement![" within ", frames]
        }),
        _ => (" beats ", {
            let frames = Quantity::new(extent).unit(Unit::FRAMES).strong();
            statement![" from ", frames, " on"]
        }),
    };
    let headline = statement![
        Phrase::Method(Variant::new(&first.methods.sampled)),
        beats,
        Phrase::Method(Variant::new(&first.methods.fixed)),
        " in ",
        Phrase::Metric(first.metric),
        end,
        with(name),
        "."
    ];
    let ratios = pairs.iter().map(|pair| pair.at_largest.ratio);
    let mut details = vec![statement![
        "After ",
        Quantity::new(Number::Count(pairs[0].tried.largest()?.into())).unit(Unit::FRAMES),
        " it has ",
        Quantity::new(Extent::from_values(ratios)),
        " times the error."
    ]];
    let (slowest, pairs) = by_sampling.iter().reduce(|a, b| {
        if most_frames(&b.1) > most_frames(&a.1) {
            b
        } else {
            a
        }
    })?;
    if slowest != name {
        details.push(statement![
            "It needs ",
            Quantity::new(Ends::find(pairs)?.extent()),
            with(slowest),
            "."
        ]);
    }
    Some(Sentences::new(headline).with_details(details))
}

fn most_frames(pairs: &[&Pair]) -> f64 {
    let crossings = pairs.iter().map(|pair| pair.crossing.value);
    crossings.fold(0.0, f64::max)
}

/// The images of one method or of one sampling, in all panels.
struct Curve<'r, 'f> {
    /// The label of a method without samples; how another one samples.
    name: String,
    method: String,
    /// Whether the method has no samples.
    is_fixed: bool,
    rows: Vec<(&'r Row<'f>, f64)>,
}

impl Curve<'_, '_> {
    /// The median ratio without samples, as a line across the panel.
    fn rule(&self, series: usize, panel: &PanelKey) -> Option<Mark> {
        let rows = self.rows.iter().copied();
        let rows = rows.filter(|(row, _)| panel.contains(row));
        let median = Numbers::new(rows, Middle::Median).estimate()?;
        let rule = Mark::new(Form::HorizontalRule(median.value), series);
        Some(rule.tip(format!("{}: {}", self.name, with_interval(&median))))
    }

    /// The median ratio by frames.
    fn line(&self, series: usize, panel: &PanelKey) -> Vec<Mark> {
        let rows = self.rows.iter().copied();
        let rows = rows.filter(|(row, _)| panel.contains(row));
        let mut dots = Vec::new();
        for (count, rows) in grouped_ascending(rows, FRAMES, |(row, _)| row) {
            let Some(median) = Numbers::new(rows, Middle::Median).estimate() else {
                continue;
            };
            let frames = Number::Count(count.count().into());
            let frames = Quantity::new(frames).unit(Unit::FRAMES);
            let name = format!("{}, {frames}", self.name);
            let position = [f64::from(count.count()), median.value];
            dots.push(middle_dot(&median, series, &name, position, &with_interval));
        }
        joined(dots)
    }

    fn values(&self, axis: AxisId) -> Vec<Value> {
        distinct_in_order(self.rows.iter().map(|(row, _)| row.point[axis].clone()))
    }
}

/// What a panel shows.
struct PanelKey {
    row_axis: AxisId,
    value: Value,
    motion: Value,
}

impl PanelKey {
    /// Images of one frame belong to every motion.
    fn contains(&self, row: &Row) -> bool {
        row.point[self.row_axis] == self.value
            && agree(&row.key(&[MOTION]), std::slice::from_ref(&self.motion))
    }
}

/// The methods without samples, then each sampling with several counts.
fn curves<'r, 'f>(frame: &Frame, rows: Vec<(&'r Row<'f>, f64)>) -> Vec<Curve<'r, 'f>> {
    let (fixed, sampled): (Vec<_>, Vec<_>) = rows
        .into_iter()
        .partition(|(row, _)| row.samples().is_none());
    let mut axes = frame.swept(&[Part::Method, Part::Count, Part::Parameter]);
    axes.retain(|axis| ![FRAMES, MOTION].contains(axis));
    let mut by_key = grouped(sampled, |(row, _)| row.key(&axes));
    by_key.retain(|(_, rows)| {
        distinct_in_order(rows.iter().map(|(row, _)| &row.point[FRAMES])).len() > 2
    });
    // Axes on which the samplings differ.
    let mut shown = Vec::new();
    for (index, axis) in axes.iter().enumerate() {
        if by_key
            .iter()
            .any(|(key, _)| key[index] != by_key[0].0[index])
        {
            shown.push(*axis);
        }
    }
    let fixed = grouped(fixed, |(row, _)| row.text(METHOD))
        .into_iter()
        .map(|(method, rows)| Curve {
            name: Variant::new(method.as_str()).label(),
            method,
            is_fixed: true,
            rows,
        });
    let sampled = by_key.into_iter().map(|(key, rows)| Curve {
        name: sampling(frame, &axes, &key, |axis| shown.contains(&axis)),
        method: rows[0].0.text(METHOD),
        is_fixed: false,
        rows,
    });
    fixed.chain(sampled).collect()
}

/// Error over the first split sum's, against the frames: one panel per value of [`Frame::row_axis`]
/// and motion, one line per sampling with several counts. Methods without samples are dashed.
fn figure(frame: &Frame) -> Option<Figure> {
    let images = frame.images();
    let row_axis = frame.row_axis();
    let Ratios { base, rows } = Ratios::new(frame, &images)?;
    let curves = curves(frame, rows);
    let fixed = curves.first().filter(|curve| curve.is_fixed)?;
    let sampled = curves.iter().filter(|curve| !curve.is_fixed);
    let mut motions = distinct_in_order(sampled.flat_map(|curve| curve.values(MOTION)));
    // Images of one frame have no motion, and are in the panel of every motion.
    if motions.len() > 1 {
        motions.retain(|motion| *motion != Value::Unset);
    }
    let mut panels = Vec::new();
    for value in ascending(fixed.values(row_axis)) {
        for motion in &motions {
            let key = PanelKey {
                row_axis,
                value: value.clone(),
                motion: motion.clone(),
            };
            let mut marks = Vec::new();
            for (series, curve) in curves.iter().enumerate() {
                if curve.is_fixed {
                    marks.extend(curve.rule(series, &key));
                } else {
                    marks.extend(curve.line(series, &key));
                }
            }
            let title = commas([
                &frame.names.heading(row_axis, &value),
                &frame.names.value_label(MOTION, motion),
            ]);
            panels.push(ChartPanel { title, marks });
        }
    }
    let metric = frame.metric_name();
    Chart {
        title: "Error against frames",
        note: commas([
            metric,
            &format!("relative to {}", Variant::new(base.to_string()).label()),
            "median environment",
        ]) + "; dashed: without samples; sampling wins where its line is below",
        x: ChartAxis::Log("frames"),
        y: ChartAxis::Log(&format!("relative {metric}")),
        panels,
        series: curves
            .iter()
            .map(|curve| {
                if curve.is_fixed {
                    method_series(&curve.name, &curve.method, true)
                } else {
                    solid(&curve.name)
                }
            })
            .collect(),
    }
    .figure()
}
