//! Moves dots that would hide each other on a step, with their intervals, into lanes.

use super::scale::Axis;
use super::{Panel, ScaleKind, Shape};
use std::collections::{BTreeSet, HashMap};

/// Marks closer than this, as a share of the other axis, hide each other.
const NEAR: f64 = 0.04;
const LANES: usize = 12;
/// Distance of two lanes, pixels.
pub const PITCH: f64 = 8.0;
/// Distance of two lines that would hide each other, pixels.
const LINE_PITCH: f64 = 4.0;
/// Share of a step that lanes may fill.
const FILLED: f64 = 0.9;

/// The lanes of the marks of a panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dodge {
    /// Steps run along y.
    pub is_y: bool,
    /// By mark; 0 is the middle of the step.
    lanes: Vec<f64>,
    /// The most lanes of a step.
    pub count: usize,
    /// The lanes of points that lines of several series share; 0 is the middle.
    shared: HashMap<LinePoint, f64>,
}

/// A point of the line of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct LinePoint {
    series: Option<usize>,
    position: ExactPosition,
}

/// A position that can be a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct ExactPosition([u64; 2]);

impl ExactPosition {
    /// `None` for NaN, which equals no position, not even its own.
    fn new(position: [f64; 2]) -> Option<Self> {
        let is_number = position.iter().all(|value| !value.is_nan());
        // Both zeros get the same bits.
        is_number.then(|| Self(position.map(|value| (value + 0.0).to_bits())))
    }
}

impl LinePoint {
    fn new(series: Option<usize>, position: [f64; 2]) -> Option<Self> {
        let position = ExactPosition::new(position)?;
        Some(Self { series, position })
    }
}

/// A dot on a step, with its interval.
struct StepDot {
    /// The dot and its interval.
    marks: Vec<usize>,
    step: f64,
    series: Option<usize>,
    extent: Extent,
}

/// Ends on the axis across the steps, as shares of the domain.
#[derive(Clone, Copy)]
struct Extent {
    start: f64,
    end: f64,
}

impl Extent {
    fn is_apart_from(&self, other: &Self) -> bool {
        self.start > other.end + NEAR || self.end + NEAR < other.start
    }
}

impl Dodge {
    /// On each step a dot takes the first free lane.
    pub fn new(panel: &Panel) -> Self {
        let is_y = matches!(panel.y.kind, ScaleKind::Steps(_));
        let mut dodge = Self {
            is_y,
            lanes: vec![0.0; panel.marks.len()],
            count: 1,
            shared: shared_points(panel),
        };
        let mut dots = step_dots(panel, is_y);
        dots.sort_by(|a, b| a.step.total_cmp(&b.step).then(a.series.cmp(&b.series)));
        for step in dots.chunk_by(|a, b| a.step == b.step) {
            dodge.take_lanes(step);
        }
        dodge
    }

    fn take_lanes(&mut self, dots: &[StepDot]) {
        let mut lanes: Vec<Vec<Extent>> = Vec::new();
        for dot in dots {
            let lane = lanes
                .iter()
                .position(|lane| lane.iter().all(|taken| dot.extent.is_apart_from(taken)))
                .unwrap_or(lanes.len())
                .min(LANES - 1);
            if lane == lanes.len() {
                lanes.push(Vec::new());
            }
            lanes[lane].push(dot.extent);
            for &mark in &dot.marks {
                self.lanes[mark] = lane as f64;
            }
        }
        let middle = (lanes.len() as f64 - 1.0) / 2.0;
        for &mark in dots.iter().flat_map(|dot| &dot.marks) {
            self.lanes[mark] -= middle;
        }
        self.count = self.count.max(lanes.len());
    }

    /// Pixels from a point to the lane of a series, downwards.
    pub fn shift(&self, series: Option<usize>, position: [f64; 2]) -> f64 {
        let lane = LinePoint::new(series, position).and_then(|point| self.shared.get(&point));
        lane.map_or(0.0, |lane| lane * LINE_PITCH)
    }

    /// Pixels from the middle of the step.
    pub fn offset(&self, mark: usize, step: f64) -> f64 {
        self.lanes[mark] * PITCH.min(step * FILLED / self.count as f64)
    }
}

/// Gives each series of a shared point a lane, so that no line hides another.
fn shared_points(panel: &Panel) -> HashMap<LinePoint, f64> {
    let mut series_at: HashMap<ExactPosition, BTreeSet<Option<usize>>> = HashMap::new();
    for mark in &panel.marks {
        if let Shape::Line(positions) = &mark.shape {
            for position in positions.iter().filter_map(|at| ExactPosition::new(*at)) {
                series_at.entry(position).or_default().insert(mark.series);
            }
        }
    }
    let mut lanes = HashMap::new();
    for (position, all_series) in series_at {
        let count = all_series.len();
        for (index, series) in all_series.into_iter().enumerate().filter(|_| count > 1) {
            let lane = index as f64 - (count as f64 - 1.0) / 2.0;
            lanes.insert(LinePoint { series, position }, lane);
        }
    }
    lanes
}

/// The dots on steps, each with the interval of its series; none if lines join dots.
fn step_dots(panel: &Panel, is_y: bool) -> Vec<StepDot> {
    let has_line = panel
        .marks
        .iter()
        .any(|mark| matches!(mark.shape, Shape::Line(_)));
    if has_line || !(is_y || matches!(panel.x.kind, ScaleKind::Steps(_))) {
        return Vec::new();
    }
    // The coordinate of steps, and the coordinate of numbers.
    let [step_coordinate, coordinate] = if is_y { [1, 0] } else { [0, 1] };
    let scale = if is_y { &panel.x } else { &panel.y };
    let axis = Axis::new(&scale.kind, 0.0, 1.0);
    let mut dots = Vec::new();
    for (i, mark) in panel.marks.iter().enumerate() {
        let Shape::Dot(position) = mark.shape else {
            continue;
        };
        let share = axis.pixel(position[coordinate]);
        let intervals = panel.marks.iter().enumerate().filter_map(|(k, other)| {
            let Shape::Whisker(a, b) = other.shape else {
                return None;
            };
            let start = axis.pixel(a[coordinate]);
            let end = axis.pixel(b[coordinate]);
            let is_of_dot = other.series == mark.series
                && a[step_coordinate] == position[step_coordinate]
                && start <= share
                && share <= end;
            is_of_dot.then_some((k, Extent { start, end }))
        });
        // If there are several, the nearest in the list.
        let interval = intervals.min_by_key(|(k, _)| k.abs_diff(i));
        let mut marks = vec![i];
        marks.extend(interval.map(|(k, _)| k));
        let point = Extent {
            start: share,
            end: share,
        };
        dots.push(StepDot {
            marks,
            step: position[step_coordinate],
            series: mark.series,
            extent: interval.map_or(point, |(_, extent)| extent),
        });
    }
    dots
}
