//! Moves dots that would hide each other on a step, with their intervals, into lanes.

use super::scale::Axis;
use super::{Panel, ScaleKind, Shape};
use std::collections::BTreeSet;

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
    /// Points that lines of several series share.
    shared: Vec<SharedPoint>,
}

/// A point of a line that lines of other series share.
#[derive(Clone, Debug, PartialEq)]
struct SharedPoint {
    point: LinePoint,
    /// 0 is the middle.
    lane: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct LinePoint {
    series: Option<usize>,
    position: [f64; 2],
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
        let point = LinePoint { series, position };
        let shared = self.shared.iter().find(|shared| shared.point == point);
        shared.map_or(0.0, |shared| shared.lane * LINE_PITCH)
    }

    /// Pixels from the middle of the step.
    pub fn offset(&self, mark: usize, step: f64) -> f64 {
        self.lanes[mark] * PITCH.min(step * FILLED / self.count as f64)
    }
}

/// Gives each series of a shared point a lane, so that no line hides another.
fn shared_points(panel: &Panel) -> Vec<SharedPoint> {
    let mut points: Vec<LinePoint> = Vec::new();
    for mark in &panel.marks {
        if let Shape::Line(positions) = &mark.shape {
            let series = mark.series;
            points.extend(
                positions
                    .iter()
                    .map(|&position| LinePoint { series, position }),
            );
        }
    }
    let mut shared = Vec::new();
    for point in &points {
        let all_series: BTreeSet<Option<usize>> = points
            .iter()
            .filter(|other| other.position == point.position)
            .map(|other| other.series)
            .collect();
        let index = all_series.iter().position(|series| *series == point.series);
        // A NaN equals no position, not even its own.
        if let Some(index) = index.filter(|_| all_series.len() > 1) {
            shared.push(SharedPoint {
                point: *point,
                lane: index as f64 - (all_series.len() as f64 - 1.0) / 2.0,
            });
        }
    }
    shared
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
