//! The labels of an axis that have room, and the room that they take.

use super::scale::{Axis, Tick, ticks};
use super::text::{DESCENT, LABEL, MIDDLE, Words, is_whole, stack};
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

fn numbers(found: Vec<Tick>) -> Vec<Label> {
    found
        .into_iter()
        .map(|(value, full)| Label {
            value,
            lines: vec![full.clone()],
            full,
        })
        .collect()
}

fn steps(names: &[String], fit: impl Fn(&str) -> Vec<String>) -> Vec<Label> {
    let label = |(i, name): (usize, &String)| Label {
        value: i as f64,
        lines: fit(name),
        full: name.clone(),
    };
    names.iter().enumerate().map(label).collect()
}

impl Labels {
    /// Labels below an axis of `length` pixels; numbers reach at most `over` pixels beyond each
    /// end.
    pub fn below(scale: &Scale, length: f64, over: [f64; 2], tried: &[f64]) -> Self {
        let axis = Axis::new(&scale.kind, 0.0, length);
        let ScaleKind::Steps(names) = &scale.kind else {
            let half = |tick: &Tick| LABEL.width(&tick.1) / 2.0;
            let middle =
                |tick: &Tick| inward(axis.at(tick.0), half(tick), [-over[0], length + over[1]]);
            let is_apart =
                |a: &Tick, b: &Tick| middle(a) + half(a) + BETWEEN <= middle(b) - half(b);
            let found = ticks(&scale.kind, tried, |all| {
                all.windows(2).all(|pair| is_apart(&pair[0], &pair[1]))
            });
            return Self {
                all: numbers(found),
                is_upright: false,
                depth: OFF + LABEL.line(),
            };
        };
        let all = steps(names, |name| {
            LABEL.wrap(name, axis.step() - BETWEEN / 2.0, LINES)
        });
        if all.iter().all(|label| is_whole(&label.lines, &label.full)) {
            let found = Self {
                all,
                is_upright: false,
                depth: 0.0,
            };
            return Self {
                depth: OFF + found.row(),
                ..found
            };
        }
        // Skips names if steps are too narrow.
        let every = (LABEL.line() / axis.step()).ceil().max(1.0) as usize;
        let all = steps(names, |name| vec![LABEL.elide(name, UPRIGHT_LONGEST)])
            .into_iter()
            .step_by(every);
        let found = Self {
            all: all.collect(),
            is_upright: true,
            depth: 0.0,
        };
        Self {
            depth: OFF + found.widest(),
            ..found
        }
    }

    /// Labels along an axis of `length` pixels; names of steps take at most `room` pixels.
    pub fn beside(scale: &Scale, length: f64, room: f64, tried: &[f64]) -> Self {
        let axis = Axis::new(&scale.kind, 0.0, length);
        let is_apart = |a: &Tick, b: &Tick| axis.at(b.0) - axis.at(a.0) >= RISE;
        let all = match &scale.kind {
            ScaleKind::Steps(names) => steps(names, |name| LABEL.wrap(name, room, LINES)),
            kind => numbers(ticks(kind, tried, |all| {
                all.windows(2).all(|pair| is_apart(&pair[0], &pair[1]))
            })),
        };
        let found = Self {
            all,
            is_upright: false,
            depth: 0.0,
        };
        let widest = found.widest();
        Self {
            depth: if widest > 0.0 { OFF + widest } else { 0.0 },
            ..found
        }
    }

    fn widest(&self) -> f64 {
        LABEL.widest(self.all.iter().flat_map(|label| &label.lines))
    }

    pub fn values(&self) -> Vec<f64> {
        self.all.iter().map(|label| label.value).collect()
    }

    /// Number of truncated labels.
    pub fn cut(&self) -> usize {
        self.all
            .iter()
            .filter(|label| !is_whole(&label.lines, &label.full))
            .count()
    }

    /// Height of the label with the most lines.
    pub fn row(&self) -> f64 {
        self.all
            .iter()
            .map(|label| label.lines.len())
            .max()
            .unwrap_or(1) as f64
            * LABEL.line()
    }

    pub fn words_below(&self, axis: &Axis, bottom: f64, [left, right]: [f64; 2]) -> Vec<Words> {
        let words = self.all.iter().flat_map(|label| {
            let (at, anchor, y) = match self.is_upright {
                true => (
                    axis.at(label.value) + LABEL.size * MIDDLE,
                    "end",
                    bottom + OFF,
                ),
                false => {
                    let half = LABEL.widest(&label.lines) / 2.0;
                    let y = bottom + OFF + LABEL.line() - LABEL.size * DESCENT;
                    (
                        inward(axis.at(label.value), half, [left, right]),
                        "middle",
                        y,
                    )
                }
            };
            let words = stack(&label.lines, &label.full, [at, y], LABEL, anchor);
            words.map(|words| Words {
                is_upright: self.is_upright,
                ..words
            })
        });
        words.collect()
    }

    pub fn words_beside(&self, axis: &Axis, left: f64) -> Vec<Words> {
        let words = self.all.iter().flat_map(|label| {
            let above = (label.lines.len() as f64 - 1.0) / 2.0 * LABEL.line();
            let at = [
                left - OFF,
                axis.at(label.value) + LABEL.size * MIDDLE - above,
            ];
            stack(&label.lines, &label.full, at, LABEL, "end")
        });
        words.collect()
    }
}

/// Moves the middle of a label so that it stays between two ends.
fn inward(at: f64, half: f64, [from, to]: [f64; 2]) -> f64 {
    at.min(to - half).max(from + half)
}
