//! The labels of an axis: which of them have room, on how many lines, and how much room they take.

use super::scale::{Axis, Tick, minor, ticks};
use super::text::{DESCENT, Font, LINE, MIDDLE};
use super::words::{Anchor, Words};
use super::{Scale, ScaleKind};

/// Of labels.
pub const FONT: Font = Font::new(11.0);
/// Between an axis and its labels, pixels.
pub const OFF: f64 = 6.0;
/// Between two labels side by side, pixels.
const BETWEEN: f64 = 8.0;
/// Between two labels of numbers above each other, pixels: closer ones crowd.
const RISE: f64 = 22.0;
/// Lines of a step's name.
const LINES: usize = 3;
/// The longest name of a step below an axis, pixels.
const UPRIGHT_LONGEST: f64 = 120.0;
/// Between the lines of minor ticks, pixels: closer ones are grey.
const MINOR_LEAST: f64 = 3.0;

/// A label with its value.
#[derive(Clone, Debug, PartialEq)]
struct Label {
    value: f64,
    lines: Vec<String>,
    full: String,
}

/// The labels of one axis of a panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Labels {
    all: Vec<Label>,
    is_upright: bool,
    minor: Vec<f64>,
    /// Pixels across the axis, with the distance to it.
    pub depth: f64,
    /// Lines of the label that has most.
    pub lines: usize,
}

fn line(text: &str) -> Vec<String> {
    vec![text.to_owned()]
}

fn numbers(found: Vec<Tick>) -> Vec<Label> {
    found.into_iter().map(|tick| Label { value: tick.value, lines: line(&tick.label), full: tick.label }).collect()
}

/// Minor ticks where they can be told apart.
fn fine(kind: &ScaleKind, axis: &Axis) -> Vec<f64> {
    let all = minor(kind);
    let places: Vec<f64> = all.iter().filter_map(|value| axis.open(*value)).collect();
    let is_wide = places.windows(2).all(|pair| (pair[1] - pair[0]).abs() >= MINOR_LEAST);
    if is_wide { all } else { Vec::new() }
}

impl Labels {
    /// Below an axis of `length` pixels; a label reaches at most `over` pixels beyond its ends.
    pub fn below(scale: &Scale, length: f64, over: f64, tried: &[f64]) -> Self {
        let axis = Axis::new(&scale.kind, 0.0, length);
        let ScaleKind::Steps(names) = &scale.kind else {
            let fits = |found: &[Tick]| {
                let ends = found.iter().filter_map(|tick| span(&axis, tick.value, &tick.label, length, over));
                let ends: Vec<[f64; 2]> = ends.collect();
                ends.windows(2).all(|pair| pair[0][1] + BETWEEN <= pair[1][0])
            };
            let all = numbers(ticks(&scale.kind, tried, fits));
            let depth = OFF + FONT.size * LINE;
            return Self { all, depth, lines: 1, minor: fine(&scale.kind, &axis), ..Self::default() };
        };
        let room = axis.step() - BETWEEN / 2.0;
        let steps = || names.iter().enumerate().map(|(i, name)| (i as f64, name));
        if names.iter().all(|name| FONT.wraps(name, room, LINES)) {
            let all: Vec<Label> = steps()
                .map(|(value, name)| Label { value, lines: FONT.wrap(name, room, LINES), full: name.clone() })
                .collect();
            let lines = all.iter().map(|label| label.lines.len()).max().unwrap_or(0);
            return Self { all, depth: OFF + lines as f64 * FONT.size * LINE, lines, ..Self::default() };
        }
        let every = (FONT.size * LINE / axis.step()).ceil().max(1.0) as usize;
        let label = |(value, name): (f64, &String)| Label {
            value,
            lines: line(&FONT.elide(name, UPRIGHT_LONGEST)),
            full: name.clone(),
        };
        let all: Vec<Label> = steps().step_by(every).map(label).collect();
        let longest = all.iter().map(|label| FONT.width(&label.lines[0])).fold(0.0, f64::max);
        Self { all, is_upright: true, depth: OFF + longest, lines: 1, ..Self::default() }
    }

    /// Beside an axis; names of steps take at most `room` pixels, numbers stand along `length` pixels.
    pub fn beside(scale: &Scale, length: f64, room: f64, tried: &[f64]) -> Self {
        let all: Vec<Label> = match &scale.kind {
            ScaleKind::Steps(names) => {
                let label = |(i, name): (usize, &String)| Label {
                    value: i as f64,
                    lines: FONT.wrap(name, room, LINES),
                    full: name.clone(),
                };
                names.iter().enumerate().map(label).collect()
            }
            kind => {
                let axis = Axis::new(kind, 0.0, length);
                let rise =
                    |found: &[Tick]| -> Vec<f64> { found.iter().filter_map(|tick| axis.open(tick.value)).collect() };
                let fits = |found: &[Tick]| rise(found).windows(2).all(|pair| pair[1] - pair[0] >= RISE);
                numbers(ticks(kind, tried, fits))
            }
        };
        let widest = all.iter().flat_map(|label| &label.lines).map(|line| FONT.width(line)).fold(0.0, f64::max);
        let lines = all.iter().map(|label| label.lines.len()).max().unwrap_or(1);
        let minor = fine(&scale.kind, &Axis::new(&scale.kind, 0.0, length));
        Self { depth: if widest > 0.0 { OFF + widest } else { 0.0 }, all, lines, minor, is_upright: false }
    }

    /// The height of a row whose name has the most lines.
    pub fn row(&self) -> f64 {
        self.lines as f64 * FONT.size * LINE
    }

    /// Pixels of labelled ticks and of those between them.
    pub fn places(&self, axis: &Axis) -> (Vec<f64>, Vec<f64>) {
        let at = |value: f64| axis.place(value).filter(|place| place.beyond == 0).map(|place| place.at);
        let major: Vec<f64> = self.all.iter().filter_map(|label| at(label.value)).collect();
        let minor = self.minor.iter().filter(|value| self.all.iter().all(|label| label.value != **value));
        (major, minor.filter_map(|value| at(*value)).collect())
    }

    /// Words below a panel whose axis runs from `left` to `right`.
    pub fn words_below(&self, axis: &Axis, [left, right]: [f64; 2], bottom: f64, over: f64) -> Vec<Words> {
        let mut words = Vec::new();
        for label in &self.all {
            let Some(at) = axis.open(label.value) else { continue };
            if self.is_upright {
                let place = [at + FONT.size * MIDDLE, bottom + OFF];
                let own = Words::new(&label.lines[0], place, FONT, "fig-muted").upright().anchor(Anchor::End);
                words.push(own.of(&label.full));
                continue;
            }
            for (i, text) in label.lines.iter().enumerate() {
                let half = FONT.width(text) / 2.0;
                let at = if axis.has_steps() { at } else { inward(at, half, [left - over, right + over]) };
                let y = bottom + OFF + (i + 1) as f64 * FONT.size * LINE - FONT.size * DESCENT;
                words.push(Words::new(text, [at, y], FONT, "fig-muted").anchor(Anchor::Middle).of(&label.full));
            }
        }
        words
    }

    /// Words beside a panel whose left border is given.
    pub fn words_beside(&self, axis: &Axis, left: f64) -> Vec<Words> {
        let mut words = Vec::new();
        for label in &self.all {
            let Some(at) = axis.open(label.value) else { continue };
            let first = at + FONT.size * MIDDLE - (label.lines.len() as f64 - 1.0) / 2.0 * FONT.size * LINE;
            for (i, text) in label.lines.iter().enumerate() {
                let place = [left - OFF, first + i as f64 * FONT.size * LINE];
                words.push(Words::new(text, place, FONT, "fig-muted").anchor(Anchor::End).of(&label.full));
            }
        }
        words
    }
}

/// The middle of a label that stays between two ends.
fn inward(at: f64, half: f64, [from, to]: [f64; 2]) -> f64 {
    at.min(to - half).max(from + half)
}

/// The ends of a label along its axis.
fn span(axis: &Axis, value: f64, label: &str, length: f64, over: f64) -> Option<[f64; 2]> {
    let half = FONT.width(label) / 2.0;
    let middle = inward(axis.open(value)?, half, [-over, length + over]);
    Some([middle - half, middle + half])
}
