//! Marks that would hide each other on a step are set side by side: by series, then by lanes within a series.

use super::scale::Axis;
use super::{Figure, Panel, ScaleKind, Shape};

/// Marks closer than this share of the other axis hide each other.
const NEAR: f64 = 0.04;
/// More lanes than this make rows too high; marks then share lanes.
const LANES: usize = 6;
/// Between the middles of two lanes, pixels.
pub const PITCH: f64 = 8.0;
/// The share of a step that marks keep to, and the share that bars fill.
const FILLED: f64 = 0.9;
pub const BARS: f64 = 0.76;

/// Where the marks of a panel stand beside the middle of their step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dodge {
    /// Steps run along y.
    pub is_y: bool,
    /// Lanes from the middle, by mark.
    lanes: Vec<f64>,
    /// Bars shift what belongs to them by a share of the step, by mark.
    shares: Vec<f64>,
    /// Lanes of a step.
    pub count: usize,
}

/// A mark that stands on a step.
struct Standing {
    mark: usize,
    step: f64,
    series: Option<usize>,
    /// Its ends on the other axis, shares of the domain.
    reach: [f64; 2],
    is_dot: bool,
    /// Bars of one series on a step follow each other and share a lane.
    is_bar: bool,
}

impl Dodge {
    /// Pixels from the middle of the step.
    pub fn offset(&self, mark: usize, step: f64) -> f64 {
        let pitch = PITCH.min(step * FILLED / self.count.max(1) as f64);
        let lane = self.lanes.get(mark).copied().unwrap_or(0.0);
        lane * pitch + self.shares.get(mark).copied().unwrap_or(0.0) * step
    }
}

/// The dodge of each panel. All panels dodge by series if one has to.
pub fn dodges(figure: &Figure) -> Vec<Dodge> {
    let standing: Vec<Vec<Standing>> = figure.panels.iter().map(standing).collect();
    let is_dodged = standing.iter().any(|own| hides(own));
    figure.panels.iter().zip(&standing).map(|(panel, own)| dodge(panel, own, is_dodged)).collect()
}

fn dodge(panel: &Panel, standing: &[Standing], is_by_series: bool) -> Dodge {
    let is_y = matches!(panel.y.kind, ScaleKind::Steps(_));
    let mut series: Vec<Option<usize>> = standing.iter().map(|own| own.series).collect();
    series.sort_unstable();
    series.dedup();
    let groups = if is_by_series { series.len().max(1) } else { 1 };
    let (lanes, most) = lanes(standing);
    let mut found = Dodge { is_y, lanes: vec![0.0; panel.marks.len()], count: groups * most, ..Dodge::default() };
    found.shares = (0..panel.marks.len()).map(|mark| beside_bar(panel, mark)).collect();
    for (own, lane) in standing.iter().zip(lanes) {
        let group = series.iter().position(|known| *known == own.series).unwrap_or(0);
        let group = if is_by_series { group as f64 - (groups as f64 - 1.0) / 2.0 } else { 0.0 };
        if found.shares[own.mark] == 0.0 {
            found.lanes[own.mark] = group * most as f64 + lane;
        }
    }
    found
}

/// What stands on steps and may be moved: dots, whiskers and horizontal bars without lines through them.
fn standing(panel: &Panel) -> Vec<Standing> {
    let is_y = matches!(panel.y.kind, ScaleKind::Steps(_));
    let has_line = panel.marks.iter().any(|mark| matches!(mark.shape, Shape::Line(_)));
    if has_line || !(is_y || matches!(panel.x.kind, ScaleKind::Steps(_))) {
        return Vec::new();
    }
    let (across, along) = if is_y { (1, 0) } else { (0, 1) };
    let axis = Axis::new(if is_y { &panel.x.kind } else { &panel.y.kind }, 0.0, 1.0);
    let own = panel.marks.iter().enumerate().filter_map(|(mark, own)| {
        let (a, b, is_dot) = match &own.shape {
            Shape::Dot(at) => (*at, *at, true),
            Shape::Whisker(a, b) if a[across] == b[across] => (*a, *b, false),
            Shape::HorizontalBar { y, base, to } if is_y => ([*base, *y], [*to, *y], false),
            _ => return None,
        };
        let [from, to] = [a, b].map(|end| axis.place(end[along]).map(|place| place.at));
        let (from, to) = (from?, to?);
        let reach = [from.min(to), from.max(to)];
        let is_bar = matches!(own.shape, Shape::HorizontalBar { .. });
        Some(Standing { mark, step: a[across], series: own.series, reach, is_dot, is_bar })
    });
    own.collect()
}

/// Whether marks of two series hide each other.
fn hides(standing: &[Standing]) -> bool {
    let is_hidden = |a: &Standing, b: &Standing| {
        let margin = if a.is_dot && b.is_dot { NEAR } else { -NEAR / 4.0 };
        a.is_dot == b.is_dot
            && a.is_bar == b.is_bar
            && a.step == b.step
            && a.series != b.series
            && a.reach[0] < b.reach[1] + margin
            && b.reach[0] < a.reach[1] + margin
    };
    standing.iter().enumerate().any(|(i, a)| standing[..i].iter().any(|b| is_hidden(a, b)))
}

/// The lane of each mark, from the middle of those of its series at its step, and the most lanes.
fn lanes(standing: &[Standing]) -> (Vec<f64>, usize) {
    let mut found = vec![0.0; standing.len()];
    let mut most = 1;
    let mut units = units(standing);
    units.sort_by(|a, b| {
        let (a_mark, b_mark) = (&standing[a.marks[0]], &standing[b.marks[0]]);
        let step = a_mark.step.total_cmp(&b_mark.step).then(a_mark.series.cmp(&b_mark.series));
        step.then(a.reach[0].total_cmp(&b.reach[0]))
    });
    let is_one_row = |a: &Unit, b: &Unit| {
        let (a, b) = (&standing[a.marks[0]], &standing[b.marks[0]]);
        a.step == b.step && a.series == b.series
    };
    for row in units.chunk_by(is_one_row) {
        let (lanes, count) = in_lanes(row);
        most = most.max(count);
        for (unit, lane) in row.iter().zip(lanes) {
            unit.marks.iter().for_each(|mark| found[*mark] = lane as f64 - (count as f64 - 1.0) / 2.0);
        }
    }
    (found, most)
}

/// A dot with its interval, or either alone: moves as one.
struct Unit {
    marks: Vec<usize>,
    reach: [f64; 2],
}

fn units(standing: &[Standing]) -> Vec<Unit> {
    let alone = |i: usize| Unit { marks: vec![i], reach: standing[i].reach };
    let mut units: Vec<Unit> = (0..standing.len()).filter(|i| standing[*i].is_dot).map(alone).collect();
    for (i, own) in standing.iter().enumerate().filter(|(_, own)| !own.is_dot && !own.is_bar) {
        // The nearest dot in the list that lies within and has no interval yet.
        let is_mate = |unit: &Unit| {
            let dot = &standing[unit.marks[0]];
            let is_within = own.reach[0] <= dot.reach[0] && dot.reach[0] <= own.reach[1];
            is_within && dot.is_dot && unit.marks.len() == 1 && dot.step == own.step && dot.series == own.series
        };
        let mates = units.iter_mut().filter(|unit| is_mate(unit));
        match mates.min_by_key(|unit| unit.marks[0].abs_diff(i)) {
            Some(unit) => {
                unit.marks.push(i);
                unit.reach = own.reach;
            }
            None => units.push(alone(i)),
        }
    }
    units
}

/// The first free lane for each of the units of a row, which come by their start, and how many there are.
fn in_lanes(row: &[Unit]) -> (Vec<usize>, usize) {
    let mut ends: Vec<f64> = Vec::new();
    let mut lanes = Vec::new();
    for unit in row {
        let free = ends.iter().position(|end| unit.reach[0] - end >= NEAR);
        let lane = free.unwrap_or(ends.len()).min(LANES - 1);
        match ends.get_mut(lane) {
            Some(end) => *end = unit.reach[1],
            None => ends.push(unit.reach[1]),
        }
        lanes.push(lane);
    }
    (lanes, ends.len().max(1))
}

/// The place of a dot or whisker on the bar that it belongs to, a share of the step from its middle.
fn beside_bar(panel: &Panel, mark: usize) -> f64 {
    let own = &panel.marks[mark];
    let place = match &own.shape {
        Shape::Dot(at) | Shape::Whisker(at, _) => at[0],
        _ => return 0.0,
    };
    let shares = panel.marks.iter().filter(|other| other.series == own.series).filter_map(|other| match other.shape {
        Shape::Bar { x, part, parts, .. } if x == place => Some(part_share(part, parts)),
        _ => None,
    });
    shares.last().unwrap_or(0.0)
}

/// The middle of a part of the bars at a step, a share of the step from its middle.
pub fn part_share(part: usize, parts: usize) -> f64 {
    BARS * ((part as f64 + 0.5) / parts.max(1) as f64 - 0.5)
}
