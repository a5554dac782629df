//! The labels of an axis: which of them have room, on how many lines, and how much room they take.

use super::scale::{Axis, Tick, minor, ticks};
use super::text::{DESCENT, Font, LINE, MIDDLE, is_whole};
use super::words::{Anchor, Words};
use super::{Scale, ScaleKind};

/// Of labels, and of those below an axis that would otherwise stand upright.
pub const FONT: Font = Font::new(11.0);
const SMALL: Font = Font::new(10.0);
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
#[derive(Clone, Debug, PartialEq)]
pub struct Labels {
    all: Vec<Label>,
    font: Font,
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
fn fine(kind: &ScaleKind, axis: &Axis, labels: &[Label]) -> Vec<f64> {
    let labelled: Vec<f64> = labels.iter().map(|label| label.value).collect();
    let all = minor(kind, &labelled);
    let places: Vec<f64> = all.iter().filter_map(|value| axis.open(*value)).collect();
    let is_wide = places.windows(2).all(|pair| (pair[1] - pair[0]).abs() >= MINOR_LEAST);
    if is_wide { all } else { Vec::new() }
}

impl Labels {
    fn new(all: Vec<Label>) -> Self {
        Self { all, font: FONT, is_upright: false, minor: Vec::new(), depth: 0.0, lines: 1 }
    }

    /// Below an axis of `length` pixels; a label of a number reaches at most `over` pixels beyond each end.
    pub fn below(scale: &Scale, length: f64, over: [f64; 2], tried: &[f64]) -> Self {
        let axis = Axis::new(&scale.kind, 0.0, length);
        let ScaleKind::Steps(names) = &scale.kind else {
            let fits = |found: &[Tick]| {
                let ends = found.iter().filter_map(|tick| span(&axis, tick.value, &tick.label, length, over));
                let ends: Vec<[f64; 2]> = ends.collect();
                ends.windows(2).all(|pair| pair[0][1] + BETWEEN <= pair[1][0])
            };
            let all = numbers(ticks(&scale.kind, tried, fits));
            let (minor, depth) = (fine(&scale.kind, &axis, &all), OFF + FONT.size * LINE);
            return Self { minor, depth, ..Self::new(all) };
        };
        [FONT, SMALL].into_iter().find_map(|font| Self::flat(names, font, axis.step())).unwrap_or_else(|| {
            // Names of steps that are still too narrow for them are left out in turn.
            let every = (FONT.size * LINE / axis.step()).ceil().max(1.0) as usize;
            let label = |(i, name): (usize, &String)| Label {
                value: i as f64,
                lines: line(&FONT.elide(name, UPRIGHT_LONGEST)),
                full: name.clone(),
            };
            let all: Vec<Label> = names.iter().enumerate().step_by(every).map(label).collect();
            let longest = all.iter().map(|label| FONT.width(&label.lines[0])).fold(0.0, f64::max);
            Self { is_upright: true, depth: OFF + longest, ..Self::new(all) }
        })
    }

    /// Names of steps on a few lines below each; `None` where one has no room.
    fn flat(names: &[String], font: Font, step: f64) -> Option<Self> {
        let room = step - BETWEEN / 2.0;
        let label = |(i, name): (usize, &String)| {
            let lines = font.wrap_list(name, room, LINES);
            is_whole(&lines, name).then(|| Label { value: i as f64, lines, full: name.clone() })
        };
        let all: Vec<Label> = names.iter().enumerate().map(label).collect::<Option<_>>()?;
        let lines = all.iter().map(|label| label.lines.len()).max().unwrap_or(0);
        Some(Self { font, depth: OFF + lines as f64 * font.size * LINE, lines, ..Self::new(all) })
    }

    /// Beside an axis; names of steps take at most `room` pixels, numbers stand along `length` pixels.
    pub fn beside(scale: &Scale, length: f64, room: f64, tried: &[f64]) -> Self {
        let all: Vec<Label> = match &scale.kind {
            ScaleKind::Steps(names) => {
                let label = |(i, name): (usize, &String)| Label {
                    value: i as f64,
                    lines: FONT.wrap_list(name, room, LINES),
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
        let minor = fine(&scale.kind, &Axis::new(&scale.kind, 0.0, length), &all);
        Self { depth: if widest > 0.0 { OFF + widest } else { 0.0 }, lines, minor, ..Self::new(all) }
    }

    /// Labelled values and their whole labels.
    pub fn ticks(&self) -> impl Iterator<Item = (f64, &str)> {
        self.all.iter().map(|label| (label.value, label.full.as_str()))
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
    pub fn words_below(&self, axis: &Axis, [left, right]: [f64; 2], bottom: f64, over: [f64; 2]) -> Vec<Words> {
        let mut words = Vec::new();
        for label in &self.all {
            let Some(at) = axis.open(label.value) else { continue };
            if self.is_upright {
                let place = [at + FONT.size * MIDDLE, bottom + OFF];
                let own = Words::new(&label.lines[0], place, FONT, "fig-muted").upright().anchor(Anchor::End);
                words.push(own.of(&label.full));
                continue;
            }
            let font = self.font;
            let class = if font == SMALL { "fig-muted fig-small" } else { "fig-muted" };
            for (i, text) in label.lines.iter().enumerate() {
                let half = font.width(text) / 2.0;
                let at = if axis.has_steps() { at } else { inward(at, half, [left - over[0], right + over[1]]) };
                let y = bottom + OFF + (i + 1) as f64 * font.size * LINE - font.size * DESCENT;
                words.push(Words::new(text, [at, y], font, class).anchor(Anchor::Middle).of(&label.full));
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
fn span(axis: &Axis, value: f64, label: &str, length: f64, over: [f64; 2]) -> Option<[f64; 2]> {
    let half = FONT.width(label) / 2.0;
    let middle = inward(axis.open(value)?, half, [-over[0], length + over[1]]);
    Some([middle - half, middle + half])
}
