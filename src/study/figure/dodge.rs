//! Marks that would hide each other on a step are set side by side: by series, then by lanes within a series.

use super::scale::Axis;
use super::{Figure, Panel, ScaleKind, Shape};

/// Marks closer than this share of the other axis hide each other.
const NEAR: f64 = 0.04;
/// More lanes than this make rows too high; marks then share lanes.
const LANES: usize = 6;
/// Between the middles of two lanes, pixels.
pub const PITCH: f64 = 7.0;
/// The share of a step that marks keep to, and the share that bars fill.
const FILLED: f64 = 0.86;
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
        Some(Standing { mark, step: a[across], series: own.series, reach, is_dot })
    });
    own.collect()
}

/// Whether marks of two series hide each other.
fn hides(standing: &[Standing]) -> bool {
    let is_hidden = |a: &Standing, b: &Standing| {
        let margin = if a.is_dot && b.is_dot { NEAR } else { -NEAR / 4.0 };
        a.is_dot == b.is_dot
            && a.step == b.step
            && a.series != b.series
            && a.reach[0] < b.reach[1] + margin
            && b.reach[0] < a.reach[1] + margin
    };
    standing.iter().enumerate().any(|(i, a)| standing[..i].iter().any(|b| is_hidden(a, b)))
}

/// The lane of each mark, from the middle of those of its series at its step, and the most lanes.
fn lanes(standing: &[Standing]) -> (Vec<f64>, usize) {
    let mut lanes = vec![0usize; standing.len()];
    let mut counts = vec![1usize; standing.len()];
    let mut order: Vec<usize> = (0..standing.len()).filter(|i| standing[*i].is_dot).collect();
    let key = |i: usize| (standing[i].step, standing[i].series, standing[i].reach[0]);
    order.sort_by(|a, b| {
        let (a, b) = (key(*a), key(*b));
        a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.total_cmp(&b.2))
    });
    for cluster in order.chunk_by(|a, b| {
        let (a, b) = (key(*a), key(*b));
        a.0 == b.0 && a.1 == b.1 && b.2 - a.2 < NEAR
    }) {
        let mut ends: Vec<f64> = Vec::new();
        for i in cluster {
            let start = standing[*i].reach[0];
            let free = ends.iter().position(|end| start - end >= NEAR);
            let lane = free.unwrap_or(ends.len() % LANES);
            match ends.get_mut(lane) {
                Some(end) => *end = start,
                None => ends.push(start),
            }
            lanes[*i] = lane;
        }
        for i in cluster {
            counts[*i] = ends.len();
        }
    }
    // An interval goes with the nearest dot of its series in the list.
    for (i, own) in standing.iter().enumerate().filter(|(_, own)| !own.is_dot) {
        let is_mate = |other: &Standing| other.is_dot && other.step == own.step && other.series == own.series;
        let mates = standing.iter().enumerate().filter(|(_, other)| is_mate(other));
        if let Some((mate, _)) = mates.min_by_key(|(other, _)| other.abs_diff(i)) {
            (lanes[i], counts[i]) = (lanes[mate], counts[mate]);
        }
    }
    let most = counts.iter().copied().max().unwrap_or(1);
    let middle = |(lane, count): (&usize, &usize)| *lane as f64 - (*count as f64 - 1.0) / 2.0;
    (lanes.iter().zip(&counts).map(middle).collect(), most)
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
