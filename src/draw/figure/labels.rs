//! The labels of an axis that have room, and the room that they take.

use super::scale::{Axis, Tick, ticks};
use super::text::{Anchor, DESCENT, LABEL, MIDDLE, Words, is_whole, stack};
use super::{Scale, ScaleKind};

/// Between an axis and its labels, pixels.
pub const OFF: f64 = 6.0;
/// Between two labels side by side, pixels.
const BETWEEN: f64 = 8.0;
/// Between two numbers above each other, pixels.
const RISE: f64 = 22.0;
const LINES: usize = 3;
/// Longest upright name of a step, pixels.
const UPRIGHT_LONGEST: f64 = 120.0;

#[derive(Clone, Debug, PartialEq)]
struct Label {
    value: f64,
    lines: Vec<String>,
    full: String,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Labels {
    all: Vec<Label>,
    is_upright: bool,
    /// Extent across the axis, with the distance to it, pixels.
    pub depth: f64,
}

fn number_labels(ticks: Vec<Tick>) -> Vec<Label> {
    ticks
        .into_iter()
        .map(|tick| Label {
            value: tick.value,
            lines: vec![tick.label.clone()],
            full: tick.label,
        })
        .collect()
}

/// A label for each step, whose lines `wrap` makes of its name.
fn step_labels(names: &[String], wrap: impl Fn(&str) -> Vec<String>) -> Vec<Label> {
    names
        .iter()
        .enumerate()
        .map(|(i, name)| Label {
            value: i as f64,
            lines: wrap(name),
            full: name.clone(),
        })
        .collect()
}

/// Middle and half the width of a number below an axis, pixels.
struct Span {
    middle: f64,
    half: f64,
}

impl Span {
    fn ends_before(&self, next: &Self) -> bool {
        self.middle + self.half + BETWEEN <= next.middle - next.half
    }
}

impl Labels {
    fn new(all: Vec<Label>, is_upright: bool) -> Self {
        Self {
            all,
            is_upright,
            depth: 0.0,
        }
    }

    /// Labels below an axis of `length` pixels; numbers reach at most `over` pixels beyond each
    /// end. `data` are the values of the marks.
    pub fn below(scale: &Scale, length: f64, over: [f64; 2], data: &[f64]) -> Self {
        match &scale.kind {
            ScaleKind::Steps(names) => Self::names_below(scale, names, length),
            _ => Self::numbers_below(scale, length, over, data),
        }
    }

    fn numbers_below(scale: &Scale, length: f64, over: [f64; 2], data: &[f64]) -> Self {
        let axis = Axis::new(&scale.kind, 0.0, length);
        let span = |tick: &Tick| {
            let half = LABEL.width(&tick.label) / 2.0;
            let middle = inward(axis.pixel(tick.value), half, [-over[0], length + over[1]]);
            Span { middle, half }
        };
        let ticks = ticks(&scale.kind, data, |ticks| {
            ticks
                .windows(2)
                .all(|pair| span(&pair[0]).ends_before(&span(&pair[1])))
        });
        Self {
            depth: OFF + LABEL.line(),
            ..Self::new(number_labels(ticks), false)
        }
    }

    /// Names of steps, level if all are whole, else upright.
    fn names_below(scale: &Scale, names: &[String], length: f64) -> Self {
        let step = Axis::new(&scale.kind, 0.0, length).step();
        let level = step_labels(names, |name| LABEL.wrap(name, step - BETWEEN / 2.0, LINES));
        if level
            .iter()
            .all(|label| is_whole(&label.lines, &label.full))
        {
            let mut labels = Self::new(level, false);
            labels.depth = OFF + labels.tallest();
            return labels;
        }
        // Skips names if steps are too narrow.
        let every = (LABEL.line() / step).ceil().max(1.0) as usize;
        let upright = step_labels(names, |name| vec![LABEL.elide(name, UPRIGHT_LONGEST)]);
        let mut labels = Self::new(upright.into_iter().step_by(every).collect(), true);
        labels.depth = OFF + labels.widest();
        labels
    }

    /// Labels to the left of an axis of `length` pixels; names of steps take at most `room` pixels.
    pub fn left(scale: &Scale, length: f64, room: f64, data: &[f64]) -> Self {
        let axis = Axis::new(&scale.kind, 0.0, length);
        let all = match &scale.kind {
            ScaleKind::Steps(names) => step_labels(names, |name| LABEL.wrap(name, room, LINES)),
            kind => number_labels(ticks(kind, data, |ticks| {
                ticks
                    .windows(2)
                    .all(|pair| axis.pixel(pair[1].value) - axis.pixel(pair[0].value) >= RISE)
            })),
        };
        let mut labels = Self::new(all, false);
        let widest = labels.widest();
        if widest > 0.0 {
            labels.depth = OFF + widest;
        }
        labels
    }

    fn widest(&self) -> f64 {
        LABEL.widest(self.all.iter().flat_map(|label| &label.lines))
    }

    /// The labelled values.
    pub fn values(&self) -> Vec<f64> {
        self.all.iter().map(|label| label.value).collect()
    }

    /// Number of truncated labels.
    pub fn truncated_count(&self) -> usize {
        self.all
            .iter()
            .filter(|label| !is_whole(&label.lines, &label.full))
            .count()
    }

    /// Height of the label with the most lines.
    pub fn tallest(&self) -> f64 {
        let line_counts = self.all.iter().map(|label| label.lines.len());
        line_counts.max().unwrap_or(1) as f64 * LABEL.line()
    }

    /// The labels below an axis whose panel ends at `bottom`; level labels stay between two ends.
    pub fn words_below(&self, axis: &Axis, bottom: f64, ends: [f64; 2]) -> Vec<Words> {
        let mut all = Vec::new();
        for label in &self.all {
            let pixel = axis.pixel(label.value);
            let (position, anchor) = if self.is_upright {
                ([pixel + LABEL.size * MIDDLE, bottom + OFF], Anchor::End)
            } else {
                let half = LABEL.widest(&label.lines) / 2.0;
                let y = bottom + OFF + LABEL.line() - LABEL.size * DESCENT;
                ([inward(pixel, half, ends), y], Anchor::Middle)
            };
            let lines = stack(&label.lines, &label.full, position, LABEL, anchor);
            all.extend(lines.map(|words| Words {
                is_upright: self.is_upright,
                ..words
            }));
        }
        all
    }

    /// The labels to the left of an axis whose panel begins at `left`.
    pub fn words_left(&self, axis: &Axis, left: f64) -> Vec<Words> {
        let mut all = Vec::new();
        for label in &self.all {
            let above = (label.lines.len() as f64 - 1.0) / 2.0 * LABEL.line();
            let y = axis.pixel(label.value) + LABEL.size * MIDDLE - above;
            let position = [left - OFF, y];
            all.extend(stack(
                &label.lines,
                &label.full,
                position,
                LABEL,
                Anchor::End,
            ));
        }
        all
    }
}

/// Moves the middle of a label so that it stays between two ends.
fn inward(middle: f64, half: f64, [from, to]: [f64; 2]) -> f64 {
    middle.min(to - half).max(from + half)
}
