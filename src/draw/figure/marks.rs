//! Draws marks. A value outside of the domain becomes an open arrow at the border; NaN is not
//! drawn.

use super::crowd::left_out;
use super::element::{dash, line, path, rectangle};
use super::frame::Frame;
use super::ink::class;
use super::scale::Axis;
use super::text::escape;
use super::{Figure, Mark, Shape};

/// Half the caps of a whisker, pixels.
const CAP: f64 = 3.0;
const ARROW: f64 = 4.5;
/// Height of a bar over its row.
const BAR: f64 = 0.66;

/// Outlines of markers by ink, from the middle, of similar area.
const MARKERS: [&str; 8] = [
    "m-3.2,-3.2h6.4v6.4h-6.4z",
    "m0,-4.6l4.6,4.6l-4.6,4.6l-4.6,-4.6z",
    "m0,-4.4l4.2,7.4h-8.4z",
    "m0-3.5a3.5 3.5 0 1 0 .01 0z",
    "m0,4.4l4.2,-7.4h-8.4z",
    "m-1.5,-4.5h3v3h3v3h-3v3h-3v-3h-3v-3h3z",
    "m-4.3,-2.2l2.1,-2.1l2.2,2.2l2.2,-2.2l2.1,2.1l-2.2,2.2l2.2,2.2l-2.1,2.1l-2.2,-2.2l-2.2,2.2l-2.1,-2.1l2.2,-2.2z",
    "m-4.5,-2.4h9v4.8h-9z",
];

/// Path data of the marker of an ink.
pub fn marker(ink: Option<usize>, position: [f64; 2]) -> String {
    line(&[position]) + MARKERS[ink.unwrap_or(0) % MARKERS.len()]
}

/// Draws a panel from the ground up: bars, axes, rules, lines, intervals, dots.
pub fn draw(figure: &Figure, index: usize, frame: &Frame) -> String {
    let panel = &figure.panels[index];
    let mut order: Vec<usize> = (0..panel.marks.len()).collect();
    order.sort_by_key(|mark| layer(&panel.marks[*mark].shape));
    let pen = |index: usize| Pen {
        figure,
        frame,
        mark: &panel.marks[index],
        index,
    };
    let left_out = left_out(panel, |index, position| {
        Some(pen(index).spot(position)?.position)
    });
    order.retain(|index| !left_out.contains(index));
    let mut below_axes = String::new();
    let mut above_axes = String::new();
    for index_of_mark in order {
        let mark = &panel.marks[index_of_mark];
        let Some(shape) = pen(index_of_mark).shape() else {
            continue;
        };
        let part = if layer(&mark.shape) == 0 {
            &mut below_axes
        } else {
            &mut above_axes
        };
        *part += &format!("<g {}{shape}</g>\n", head(figure, mark, index));
    }
    let corners = [
        [frame.left, frame.top],
        [frame.left, frame.bottom],
        [frame.right, frame.bottom],
    ];
    let axes = path("fig-axis", "", &line(&corners));
    let name = if panel.title.is_empty() {
        String::new()
    } else {
        format!(" aria-label=\"{}\"", escape(&panel.title))
    };
    format!("<g role=\"group\"{name}>\n{below_axes}{axes}\n{above_axes}</g>\n")
}

/// Bars are below the axes, dots on top.
fn layer(shape: &Shape) -> u8 {
    match shape {
        Shape::HorizontalBar { .. } => 0,
        Shape::HorizontalRule(_) | Shape::VerticalRule(_) => 1,
        Shape::Line(_) => 2,
        Shape::Whisker(..) => 3,
        Shape::Dot(_) => 4,
    }
}

/// Attributes and title of a mark's group.
fn head(figure: &Figure, mark: &Mark, panel: usize) -> String {
    let class = class(figure.ink(mark.series));
    if mark.tip.is_empty() {
        return format!("class=\"{class}\">");
    }
    let tip = escape(&mark.tip);
    let cell = mark.cell.as_ref().map_or_else(String::new, |cell| {
        format!(" data-cell=\"{}\"", escape(cell))
    });
    let series = mark
        .series
        .map_or_else(String::new, |series| format!(" data-series=\"{series}\""));
    format!(
        "class=\"mark {class}\" tabindex=\"-1\" role=\"img\" aria-label=\"{tip}\" \
         data-tip=\"{tip}\"{cell} data-panel=\"{panel}\"{series}>\
         <title>{tip}</title>"
    )
}

struct Pen<'f> {
    figure: &'f Figure,
    frame: &'f Frame,
    mark: &'f Mark,
    /// Of the mark in its panel.
    index: usize,
}

/// A point in pixels.
struct Spot {
    position: [f64; 2],
    /// An arrow if the point is outside of the domain, else empty.
    arrow: String,
}

impl Pen<'_> {
    /// The elements of a mark; `None` for NaN.
    fn shape(&self) -> Option<String> {
        let Frame {
            left,
            top,
            right,
            bottom,
            ..
        } = *self.frame;
        match &self.mark.shape {
            Shape::Line(points) => Some(self.line(points)),
            Shape::Dot(position) => self.dot(*position),
            Shape::HorizontalBar { y, base, to } => self.bar(*y, *base, *to),
            Shape::Whisker(a, b) => self.whisker(*a, *b),
            Shape::HorizontalRule(y) => self.rule(&self.frame.y, *y, |y| [[left, y], [right, y]]),
            Shape::VerticalRule(x) => self.rule(&self.frame.x, *x, |x| [[x, top], [x, bottom]]),
        }
    }

    fn dot(&self, position: [f64; 2]) -> Option<String> {
        let Spot { position, arrow } = self.spot(position)?;
        let dot = if arrow.is_empty() {
            let ink = self.figure.ink(self.mark.series);
            path("fig-d", "", &marker(ink, position))
        } else {
            arrow
        };
        let [x, y] = position;
        Some(dot + &self.hit(&format!("M{x:.0},{y:.0}h0")))
    }

    fn bar(&self, y: f64, base: f64, to: f64) -> Option<String> {
        let start = self.spot([base, y])?.position;
        let end = self.spot([to, y])?;
        let height = self.frame.y.step() * BAR;
        let area = rectangle([
            start[0].min(end.position[0]),
            end.position[1] - height / 2.0,
            (start[0] - end.position[0]).abs(),
            height,
        ]);
        let hit = self.hit(&line(&[start, end.position]));
        Some(path("fig-f fig-o", "", &area) + &end.arrow + &hit)
    }

    /// The pixels of a point, dodged on steps; `None` for NaN.
    fn spot(&self, [x, y]: [f64; 2]) -> Option<Spot> {
        let frame = self.frame;
        let mut position = [frame.x.pixel(x), frame.y.pixel(y)];
        let steps = if frame.dodge.is_y { &frame.y } else { &frame.x };
        if steps.has_steps() {
            let offset = frame.dodge.offset(self.index, steps.step());
            position[usize::from(frame.dodge.is_y)] += offset;
        }
        position[1] += frame.dodge.shift(self.mark.series, [x, y]);
        if position.iter().any(|pixel| pixel.is_nan()) {
            return None;
        }
        let outside_x = frame.x.outside(x);
        let outside_y = frame.y.outside(y);
        let arrow = if outside_x != 0.0 {
            arrow(position, [outside_x, 0.0])
        } else if outside_y != 0.0 {
            // Pixels run down.
            arrow(position, [0.0, -outside_y])
        } else {
            String::new()
        };
        Some(Spot { position, arrow })
    }

    /// A wide target for the pointer.
    fn hit(&self, data: &str) -> String {
        if self.mark.tip.is_empty() {
            String::new()
        } else {
            path("fig-h", "", data)
        }
    }

    /// A line with a gap at each NaN.
    fn line(&self, points: &[[f64; 2]]) -> String {
        let spots: Vec<Option<Spot>> = points.iter().map(|point| self.spot(*point)).collect();
        let mut data = String::new();
        for run in spots.split(Option::is_none) {
            let positions: Vec<[f64; 2]> = run.iter().flatten().map(|spot| spot.position).collect();
            data += &line(&positions);
        }
        let arrows: String = spots
            .iter()
            .flatten()
            .map(|spot| spot.arrow.as_str())
            .collect();
        path("fig-l", &dash(self.figure, self.mark.series), &data) + &self.hit(&data) + &arrows
    }

    fn rule(&self, axis: &Axis, value: f64, ends: impl Fn(f64) -> [[f64; 2]; 2]) -> Option<String> {
        if axis.outside(value) != 0.0 || value.is_nan() {
            return None;
        }
        let data = line(&ends(axis.pixel(value)));
        let dash = dash(self.figure, self.mark.series);
        Some(path("fig-l fig-thin", &dash, &data) + &self.hit(&data))
    }

    /// An interval, with caps at the ends in the domain.
    fn whisker(&self, a: [f64; 2], b: [f64; 2]) -> Option<String> {
        let start = self.spot(a)?;
        let end = self.spot(b)?;
        let is_level = a[1] == b[1];
        let [cap_x, cap_y] = if is_level { [0.0, CAP] } else { [CAP, 0.0] };
        let interval = line(&[start.position, end.position]);
        let mut data = interval.clone();
        for spot in [&start, &end] {
            if spot.arrow.is_empty() {
                let [x, y] = spot.position;
                data += &line(&[[x - cap_x, y - cap_y], [x + cap_x, y + cap_y]]);
            }
        }
        let whisker = path("fig-l fig-thin", "", &data);
        Some(whisker + &start.arrow + &end.arrow + &self.hit(&interval))
    }
}

/// An open arrow whose tip is at `tip`.
fn arrow(tip: [f64; 2], [dx, dy]: [f64; 2]) -> String {
    let back = |side: f64| {
        [
            tip[0] - ARROW * (2.0 * dx + side * dy),
            tip[1] - ARROW * (2.0 * dy - side * dx),
        ]
    };
    path("fig-b", "", &(line(&[tip, back(1.0), back(-1.0)]) + "Z"))
}
