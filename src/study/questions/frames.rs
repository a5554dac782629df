//! From how many frames on does sampling with a few samples a frame beat a method without samples?
//!
//! [`super::break_even`] with frames in place of samples: a curve has one sample count, motion and
//! history. Images of one frame belong to every motion. The last frame is compared, so under motion
//! the error has the lag of the frames before.

use super::break_even::{
    HI, LO, METRIC, N, Pair, conditions, counted, digest, ends, lacks_counts, pairs, table,
};
use super::by_lookups::ratios;
use super::numbers::middle_marks;
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
        along: FRAMES,
        ..frame.like(frame.run, frame.metric_name())
    };
    let (all, axes) = (pairs(frame), conditions(frame));
    let finite = |x: f64| Cell::from(Some(x).filter(|x| x.is_finite()));
    Some(Finding {
        sentence: sentence(frame, &axes, &all)?,
        table: table(frame, &axes, QUESTION.columns, &all, |own| {
            own.last.map(finite).into()
        }),
        digest: Some(digest(frame, &axes, &all, "frames")),
        figure: figure(frame),
    })
}

/// The words of a way to sample: "1 sample a frame, light".
fn way(frame: &Frame, axes: &[AxisId], key: &[Value], is_shown: impl Fn(AxisId) -> bool) -> String {
    let samples = axes
        .iter()
        .position(|axis| *axis == SAMPLES)
        .map(|place| match &key[place] {
            Value::Count(1) => "1 sample a frame".to_owned(),
            count => format!("{count} samples a frame"),
        });
    let others = frame
        .names
        .label_where(axes, key, |axis| axis != SAMPLES && is_shown(axis));
    commas([
        samples.as_deref().unwrap_or(""),
        &others.replace(" · ", ", "),
    ])
}

/// The range of the first pair, for its first way with its errors at the end, and then for the way
/// with the most frames.
fn sentence(frame: &Frame, axes: &[AxisId], all: &[Pair]) -> Option<String> {
    let first = all.first()?;
    let own = all
        .iter()
        .filter(|own| (&own.sampled, &own.fixed) == (&first.sampled, &first.fixed));
    let ways = grouped(own, |own| {
        way(frame, axes, &own.key, |axis| axis != frame.row_axis())
    });
    let counts = |own: &[&Pair]| {
        let [least, most] = ends(own)?;
        let count = |own: &Pair| counted(own.crossing.value, &own.tried);
        let (least, most) = (count(least), count(most));
        Some(if least == most {
            least
        } else {
            format!("{least} to {most}")
        })
    };
    let most = |own: &[&Pair]| own.iter().map(|own| own.crossing.value).fold(0.0, f64::max);
    let (name, lead) = ways.first()?;
    let slowest = ways
        .iter()
        .reduce(|a, b| if most(&b.1) > most(&a.1) { b } else { a })?;
    let at = |name: &str| {
        if name.is_empty() {
            String::new()
        } else {
            format!(" with {name}")
        }
    };
    let slow = if slowest.0 == *name {
        String::new()
    } else {
        format!(" It needs {}{}.", counts(&slowest.1)?, at(&slowest.0))
    };
    let [most, end] = [
        lead[0].tried.last()?.to_string(),
        range(lead.iter().map(|own| own.last[0])),
    ];
    let count = counts(lead)?;
    let beats = match count.strip_prefix("more than ") {
        Some(most) => format!(
            "does not beat `{}` in `{}` within **{most} frames**",
            first.fixed, first.metric
        ),
        None => format!(
            "beats `{}` in `{}` from **{count} frames** on",
            first.fixed, first.metric
        ),
    };
    let end = format!("After {most} frames it has {end} times the error.");
    Some(format!(
        "`{}` {beats}{}. {end}{slow}",
        first.sampled,
        at(name)
    ))
}

/// Error over the first split sum's, against the frames: one panel per value of [`Frame::row_axis`]
/// and motion, one line per way to sample with several counts. Methods without samples are dashed.
fn figure(frame: &Frame) -> Option<Figure> {
    let (images, names, of) = (frame.images(), &frame.names, frame.row_axis());
    let (all, base) = ratios(frame, &images)?;
    let (fixed, sampled): (Vec<_>, Vec<_>) = all
        .into_iter()
        .partition(|(row, _)| row.samples().is_none());
    let axes = frame
        .swept(&[Part::Method, Part::Count, Part::Parameter])
        .into_iter();
    let axes: Vec<AxisId> = axes
        .filter(|axis| ![FRAMES, MOTION].contains(axis))
        .collect();
    let rows = |own: &[(&'_ Row, f64)], axis| {
        distinct_in_order(own.iter().map(|(row, _)| row.point[axis].clone()))
    };
    let mut ways = grouped(sampled, |(row, _)| row.key(&axes));
    ways.retain(|(_, own)| rows(own, FRAMES).len() > 2);
    let differs = |place: usize| ways.iter().any(|(key, _)| key[place] != ways[0].0[place]);
    let shown: Vec<AxisId> = (0..axes.len())
        .filter(|place| differs(*place))
        .map(|place| axes[place])
        .collect();
    let fixed = grouped(fixed, |(row, _)| row.text(METHOD));
    let way = |key: &Key| way(frame, &axes, key, |axis| shown.contains(&axis));
    let series = fixed
        .iter()
        .map(|(name, _)| name.clone())
        .chain(ways.iter().map(|(key, _)| way(key)));
    let series: Vec<String> = series.collect();
    let mut panels = Vec::new();
    for value in ascending(fixed.first().map(|(_, own)| rows(own, of))?) {
        let motions = distinct_in_order(ways.iter().flat_map(|(_, own)| rows(own, MOTION)));
        for motion in motions {
            let is_own = |row: &Row| {
                row.point[of] == value && fits(&row.key(&[MOTION]), std::slice::from_ref(&motion))
            };
            let mut marks: Vec<Mark> = Vec::new();
            for (place, (name, all)) in fixed.iter().enumerate() {
                let Some(middle) = Numbers::new(
                    all.iter().copied().filter(|(row, _)| is_own(row)),
                    Middle::Median,
                )
                .estimate() else {
                    continue;
                };
                let rule = Mark::new(Form::HorizontalRule(middle.value), place);
                marks.push(rule.tip(format!("{name}: {}", with_interval(&middle))));
            }
            for (place, (key, all)) in ways.iter().enumerate() {
                let dot = |(count, own): (Value, Vec<(&Row, f64)>)| {
                    let middle = Numbers::new(own, Middle::Median).estimate()?;
                    let tip = format!("{}, {count} frames", way(key));
                    let at = |y| [f64::from(count.count()), y];
                    Some(
                        middle_marks(&middle, fixed.len() + place, at, (&tip, &with_interval))
                            .swap_remove(0),
                    )
                };
                let counts = grouped_ascending(
                    all.iter().copied().filter(|(row, _)| is_own(row)),
                    FRAMES,
                    |(row, _)| row,
                );
                marks.extend(joined(counts.into_iter().filter_map(dot).collect()));
            }
            panels.push((
                commas([&names.heading(of, &value), &names.one(MOTION, &motion)]),
                marks,
            ));
        }
    }
    let mut figure = Chart {
        title: "Error against frames",
        note: commas([
            frame.metric_name(),
            &format!("relative to {base}"),
            "median environment",
        ]) + "; dashed: without samples; sampling wins where its line is below",
        x: Along::Log("frames"),
        y: Along::Log(&format!("relative {}", frame.metric_name())),
        panels,
        series,
    }
    .figure()?;
    figure
        .series
        .iter_mut()
        .take(fixed.len())
        .for_each(|own| own.is_dashed = true);
    Some(figure)
}
