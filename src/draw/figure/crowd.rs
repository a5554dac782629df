//! Leaves dots out of crowded panels: thousands of dots, each with a halo, would hide their own
//! curve.

use super::{Figure, Panel, Shape};
use std::collections::{HashMap, HashSet};

/// Panels with more dots are crowded.
const DOTS_MAX: usize = 250;
/// In a crowded panel a dot is drawn if no dot of its series is nearer along both axes, pixels:
/// about the size of a marker.
const NEAR: f64 = 8.0;
/// The end of the note of a figure with a crowded panel.
const NOTE: &str = "; where dots of a series touch, one is drawn";

/// A square of [`NEAR`] pixels, which has room for one dot of a series.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Square {
    series: Option<usize>,
    column: i64,
    row: i64,
}

impl Square {
    fn of(series: Option<usize>, [x, y]: [f64; 2]) -> Self {
        Self {
            series,
            column: (x / NEAR).floor() as i64,
            row: (y / NEAR).floor() as i64,
        }
    }

    /// This square and the eight around it.
    fn and_neighbours(self) -> impl Iterator<Item = Self> {
        let columns = self.column - 1..=self.column + 1;
        columns.flat_map(move |column| {
            (self.row - 1..=self.row + 1).map(move |row| Self {
                column,
                row,
                ..self
            })
        })
    }
}

/// Where an interval meets its dot.
#[derive(PartialEq, Eq, Hash)]
struct Foot {
    series: Option<usize>,
    /// The axis across the interval, 0 or 1.
    across: usize,
    /// Of the coordinate on that axis.
    bits: u64,
}

impl Foot {
    fn new(series: Option<usize>, across: usize, position: [f64; 2]) -> Self {
        Self {
            series,
            across,
            bits: position[across].to_bits(),
        }
    }
}

/// The indices of the marks of a crowded panel that are not drawn: dots without room, and their
/// intervals. `pixels` places a dot.
pub fn left_out(
    panel: &Panel,
    pixels: impl Fn(usize, [f64; 2]) -> Option<[f64; 2]>,
) -> HashSet<usize> {
    let mut left_out = HashSet::new();
    if !is_crowded(panel) {
        return left_out;
    }
    let mut drawn: HashMap<Square, [f64; 2]> = HashMap::new();
    let mut feet: HashSet<Foot> = HashSet::new();
    for (index, mark) in panel.marks.iter().enumerate() {
        let Shape::Dot(position) = mark.shape else {
            continue;
        };
        let Some(pixel) = pixels(index, position) else {
            continue;
        };
        let square = Square::of(mark.series, pixel);
        let is_near = |other: &[f64; 2]| (0..2).all(|i| (other[i] - pixel[i]).abs() < NEAR);
        let mut around = square.and_neighbours();
        if around.any(|near| drawn.get(&near).is_some_and(is_near)) {
            left_out.insert(index);
        } else {
            drawn.insert(square, pixel);
            feet.extend((0..2).map(|across| Foot::new(mark.series, across, position)));
        }
    }
    for (index, mark) in panel.marks.iter().enumerate() {
        let Shape::Whisker(start, end) = mark.shape else {
            continue;
        };
        let across = usize::from(start[0] != end[0]);
        if !feet.contains(&Foot::new(mark.series, across, start)) {
            left_out.insert(index);
        }
    }
    left_out
}

fn is_crowded(panel: &Panel) -> bool {
    let is_dot = |shape: &Shape| matches!(shape, Shape::Dot(_));
    let dots = panel.marks.iter().filter(|mark| is_dot(&mark.shape));
    dots.count() > DOTS_MAX
}

impl Figure {
    /// The note, with what is left out.
    pub fn whole_note(&self) -> String {
        let is_crowded = self.panels.iter().any(is_crowded);
        let end = if is_crowded { NOTE } else { "" };
        format!("{}{end}", self.note)
    }
}
