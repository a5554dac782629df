//! From how many frames on does sampling with a few samples a frame beat a method without samples?
//!
//! [`super::break_even`] with frames in place of samples: a curve has one sample count, motion and history. Images of one frame belong to
//! every motion. The last frame is compared, so under motion the error has the lag of the frames before.

use super::break_even::{HI, LO, METRIC, N, Pair, conditions, counted, digest, ends, pairs, table};
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
            "Frame count from which sampling errs less, median over environments; empty if above the largest tried count.",
        ),
        LO,
        HI,
        N,
        column("largest_tried", "Largest frame count tried in every case."),
        column("ratio", "Error at that count over the error of the method without samples, median over environments."),
        column("lag_bias", "`lag_bias` at that count, median over environments."),
        column("flicker", "`flicker` at that count, median over environments."),
    ],
    lacks,
    answer,
    ..Question::PLAIN
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    match () {
        () if !shape.methods().any(|method| method.uses_point_set) => Some("axes.method has no sampling method"),
        () if shape.methods().all(|method| method.uses_samples) => Some("axes.method has no method without samples"),
        () if !shape.is_swept(FRAMES) => Some("axes.frames has fewer than two counts"),
        () => None,
    }
}

fn answer(frame: &Frame) -> Option<Finding> {
    let frame = &Frame { along: FRAMES, ..frame.like(frame.run, frame.metric_name()) };
    let (all, axes) = (pairs(frame), conditions(frame));
    let finite = |x: f64| Cell::from(Some(x).filter(|x| x.is_finite()));
    Some(Finding {
        sentence: sentence(frame, &axes, &all)?,
        table: table(frame, &axes, QUESTION.columns, &all, |own| own.last.map(finite).into()),
        digest: Some(digest(frame, &axes, &all)),
        figure: None,
    })
}

/// The words of a pair's ways: "1 sample a frame, light".
fn way(frame: &Frame, axes: &[usize], key: &[Value]) -> String {
    let samples = axes.iter().position(|axis| *axis == SAMPLES).map(|place| match &key[place] {
        Value::Count(1) => "1 sample a frame".to_owned(),
        count => format!("{count} samples a frame"),
    });
    let others = frame.names.label_where(axes, key, |axis| axis != SAMPLES && axis != frame.row_axis());
    commas([samples.as_deref().unwrap_or(""), &others])
}

/// The range of the first pair, for its first way and then for the way with the most frames.
fn sentence(frame: &Frame, axes: &[usize], all: &[Pair]) -> Option<String> {
    let first = all.first()?;
    let own = all.iter().filter(|own| (&own.sampled, &own.fixed) == (&first.sampled, &first.fixed));
    let ways = grouped(own, |own| way(frame, axes, &own.key));
    let counts = |own: &[&Pair]| {
        let [least, most] = ends(own)?;
        let count = |own: &Pair| counted(own.crossing.value, &own.tried);
        let (least, most) = (count(least), count(most));
        Some(if least == most { least } else { format!("{least} to {most}") })
    };
    let most = |own: &[&Pair]| own.iter().map(|own| own.crossing.value).fold(0.0, f64::max);
    let (name, lead) = ways.first()?;
    let slowest = ways.iter().reduce(|a, b| if most(&b.1) > most(&a.1) { b } else { a })?;
    let at = |name: &str| if name.is_empty() { String::new() } else { format!(" with {name}") };
    let slow = if slowest.0 == *name {
        String::new()
    } else {
        format!(" It needs {}{}.", counts(&slowest.1)?, at(&slowest.0))
    };
    Some(format!(
        "`{}` beats `{}` in `{}` from **{} frames** on{}.{slow}",
        first.sampled,
        first.fixed,
        first.metric,
        counts(lead)?,
        at(name),
    ))
}
