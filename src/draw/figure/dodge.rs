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
    /// Points that lines of several series share: series, point, lane.
    shared: Vec<(Option<usize>, [f64; 2], f64)>,
}

/// A dot on a step, with its interval.
struct Standing {
    marks: Vec<usize>,
    step: f64,
    series: Option<usize>,
    /// Ends on the other axis, as shares of the domain.
    reach: [f64; 2],
}

impl Dodge {
    /// On each step a dot takes the first free lane.
    pub fn new(panel: &Panel) -> Self {
        let is_y = matches!(panel.y.kind, ScaleKind::Steps(_));
        let mut found = Self {
            is_y,
            lanes: vec![0.0; panel.marks.len()],
            count: 1,
            shared: shared(panel),
        };
        let mut standing = standing(panel, is_y);
        standing.sort_by(|a, b| a.step.total_cmp(&b.step).then(a.series.cmp(&b.series)));
        for row in standing.chunk_by(|a, b| a.step == b.step) {
            let mut taken: Vec<Vec<[f64; 2]>> = Vec::new();
            for own in row {
                let [start, end] = own.reach;
                let is_free = |lane: &Vec<[f64; 2]>| {
                    lane.iter()
                        .all(|[from, to]| start > to + NEAR || end + NEAR < *from)
                };
                let lane = taken
                    .iter()
                    .position(is_free)
                    .unwrap_or(taken.len())
                    .min(LANES - 1);
                if lane == taken.len() {
                    taken.push(Vec::new());
                }
                taken[lane].push(own.reach);
                own.marks
                    .iter()
                    .for_each(|mark| found.lanes[*mark] = lane as f64);
            }
            let middle = (taken.len() as f64 - 1.0) / 2.0;
            row.iter()
                .flat_map(|own| &own.marks)
                .for_each(|mark| found.lanes[*mark] -= middle);
            found.count = found.count.max(taken.len());
        }
        found
    }

    /// Pixels from a point to the lane of a series, downwards.
    pub fn shift(&self, series: Option<usize>, point: [f64; 2]) -> f64 {
        let own = self
            .shared
            .iter()
            .find(|(other, at, _)| *other == series && *at == point);
        own.map_or(0.0, |(.., lane)| lane * LINE_PITCH)
    }

    /// Pixels from the middle of the step.
    pub fn offset(&self, mark: usize, step: f64) -> f64 {
        self.lanes[mark] * PITCH.min(step * FILLED / self.count as f64)
    }
}

/// Gives each series of a shared point a lane, so that no line hides another.
fn shared(panel: &Panel) -> Vec<(Option<usize>, [f64; 2], f64)> {
    let points = panel.marks.iter().filter_map(|mark| match &mark.shape {
        Shape::Line(points) => Some(points.iter().map(|point| (mark.series, *point))),
        _ => None,
    });
    let all: Vec<(Option<usize>, [f64; 2])> = points.flatten().collect();
    let lane = |(series, point): &(Option<usize>, [f64; 2])| {
        let own: BTreeSet<Option<usize>> = all
            .iter()
            .filter(|other| other.1 == *point)
            .map(|other| other.0)
            .collect();
        let place = own.iter().position(|other| other == series)? as f64;
        (own.len() > 1).then(|| (*series, *point, place - (own.len() as f64 - 1.0) / 2.0))
    };
    all.iter().filter_map(lane).collect()
}

/// The dots on steps, each with the interval of its series; none if lines join dots.
fn standing(panel: &Panel, is_y: bool) -> Vec<Standing> {
    let has_line = panel
        .marks
        .iter()
        .any(|mark| matches!(mark.shape, Shape::Line(_)));
    if has_line || !(is_y || matches!(panel.x.kind, ScaleKind::Steps(_))) {
        return Vec::new();
    }
    let (across, along, scale) = if is_y {
        (1, 0, &panel.x)
    } else {
        (0, 1, &panel.y)
    };
    let axis = Axis::new(&scale.kind, 0.0, 1.0);
    let dots = panel.marks.iter().enumerate().filter_map(|(i, mark)| {
        let Shape::Dot(at) = mark.shape else {
            return None;
        };
        let place = axis.at(at[along]);
        let interval = panel.marks.iter().enumerate().filter_map(|(k, other)| {
            let Shape::Whisker(a, b) = other.shape else {
                return None;
            };
            let [from, to] = [a, b].map(|end| axis.at(end[along]));
            let is_own = other.series == mark.series
                && a[across] == at[across]
                && from <= place
                && place <= to;
            is_own.then_some((k, [from, to]))
        });
        // If there are several, the nearest in the list.
        let interval = interval.min_by_key(|(k, _)| k.abs_diff(i));
        let marks = [i].into_iter().chain(interval.map(|(k, _)| k)).collect();
        let reach = interval.map_or([place; 2], |(_, reach)| reach);
        Some(Standing {
            marks,
            step: at[across],
            series: mark.series,
            reach,
        })
    });
    dots.collect()
}
