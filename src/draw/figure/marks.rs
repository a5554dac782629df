//! Draws marks. A value outside of the domain becomes an open arrow at the border; NaN is not
//! drawn.

use super::element::{dash, line, path, rectangle};
use super::ink::class;
use super::layout::Frame;
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

pub fn marker(ink: Option<usize>, at: [f64; 2]) -> String {
    line(&[at]) + MARKERS[ink.unwrap_or(0) % MARKERS.len()]
}

/// Draws a panel from the ground up: bars, axes, rules, lines, intervals, dots.
pub fn draw(figure: &Figure, index: usize, frame: &Frame) -> String {
    let panel = &figure.panels[index];
    let mut order: Vec<usize> = (0..panel.marks.len()).collect();
    order.sort_by_key(|i| layer(&panel.marks[*i].shape));
    let drawn = |i: &usize| {
        let mark = &panel.marks[*i];
        let shape = Pen {
            figure,
            frame,
            mark,
            index: *i,
        }
        .shape()?;
        Some(format!("<g {}{shape}</g>\n", head(figure, mark, index)))
    };
    let (filled, others) =
        order.split_at(order.partition_point(|i| layer(&panel.marks[*i].shape) == 0));
    let [filled, others] =
        [filled, others].map(|own| own.iter().filter_map(drawn).collect::<String>());
    let Frame {
        left,
        top,
        right,
        bottom,
        ..
    } = *frame;
    let border = path(
        "fig-axis",
        "",
        &line(&[[left, top], [left, bottom], [right, bottom]]),
    );
    let name = if panel.title.is_empty() {
        String::new()
    } else {
        format!(" aria-label=\"{}\"", escape(&panel.title))
    };
    format!("<g role=\"group\"{name}>\n{filled}{border}\n{others}</g>\n")
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
    index: usize,
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
            Shape::Dot(at) => {
                let (at, arrow) = self.place(*at)?;
                let hit = self.hit(&format!("M{:.0},{:.0}h0", at[0], at[1]));
                let ink = self.figure.ink(self.mark.series);
                let dot = if arrow.is_empty() {
                    path("fig-d", "", &marker(ink, at))
                } else {
                    arrow
                };
                Some(dot + &hit)
            }
            Shape::HorizontalBar { y, base, to } => {
                let ((from, _), (end, arrow)) = (self.place([*base, *y])?, self.place([*to, *y])?);
                let height = self.frame.y.step() * BAR;
                let area = [
                    from[0].min(end[0]),
                    end[1] - height / 2.0,
                    (from[0] - end[0]).abs(),
                    height,
                ];
                Some(
                    path("fig-f fig-o", "", &rectangle(area))
                        + &arrow
                        + &self.hit(&line(&[from, end])),
                )
            }
            Shape::Whisker(a, b) => self.whisker(*a, *b),
            Shape::HorizontalRule(y) => self.rule(&self.frame.y, *y, |y| [[left, y], [right, y]]),
            Shape::VerticalRule(x) => self.rule(&self.frame.x, *x, |x| [[x, top], [x, bottom]]),
        }
    }

    /// The place of a point, dodged on steps, and an arrow if it is outside of the domain.
    fn place(&self, [x, y]: [f64; 2]) -> Option<([f64; 2], String)> {
        let Frame {
            x: across,
            y: up,
            dodge,
            ..
        } = self.frame;
        let mut at = [across.at(x), up.at(y)];
        let steps = if dodge.is_y { up } else { across };
        if steps.has_steps() {
            at[usize::from(dodge.is_y)] += dodge.offset(self.index, steps.step());
        }
        at[1] += dodge.shift(self.mark.series, [x, y]);
        let [dx, dy] = match (across.beyond(x), up.beyond(y)) {
            _ if at[0].is_nan() || at[1].is_nan() => return None,
            (0.0, 0.0) => return Some((at, String::new())),
            (0.0, beyond) => [0.0, -beyond],
            (beyond, _) => [beyond, 0.0],
        };
        let back = |side: f64| {
            [
                at[0] - ARROW * (2.0 * dx + side * dy),
                at[1] - ARROW * (2.0 * dy - side * dx),
            ]
        };
        Some((
            at,
            path("fig-b", "", &(line(&[at, back(1.0), back(-1.0)]) + "Z")),
        ))
    }

    /// A wide target for the pointer.
    fn hit(&self, data: &str) -> String {
        if self.mark.tip.is_empty() {
            String::new()
        } else {
            path("fig-h", "", data)
        }
    }

    fn line(&self, points: &[[f64; 2]]) -> String {
        let places: Vec<Option<([f64; 2], String)>> =
            points.iter().map(|at| self.place(*at)).collect();
        let run = |run: &[Option<([f64; 2], String)>]| {
            line(
                &run.iter()
                    .flatten()
                    .map(|place| place.0)
                    .collect::<Vec<_>>(),
            )
        };
        let data: String = places.split(Option::is_none).map(run).collect();
        let arrows: String = places
            .iter()
            .flatten()
            .map(|place| place.1.as_str())
            .collect();
        path("fig-l", &dash(self.figure, self.mark.series), &data) + &self.hit(&data) + &arrows
    }

    fn rule(&self, axis: &Axis, value: f64, ends: impl Fn(f64) -> [[f64; 2]; 2]) -> Option<String> {
        let data = line(&ends(axis.at(value)));
        let dash = dash(self.figure, self.mark.series);
        (axis.beyond(value) == 0.0 && !value.is_nan())
            .then(|| path("fig-l fig-thin", &dash, &data) + &self.hit(&data))
    }

    fn whisker(&self, a: [f64; 2], b: [f64; 2]) -> Option<String> {
        let ((from, start), (to, end)) = (self.place(a)?, self.place(b)?);
        let cap = if a[1] == b[1] { [0.0, CAP] } else { [CAP, 0.0] };
        let across = |[x, y]: [f64; 2]| line(&[[x - cap[0], y - cap[1]], [x + cap[0], y + cap[1]]]);
        let mut data = line(&[from, to]);
        for (at, arrow) in [(from, &start), (to, &end)] {
            if arrow.is_empty() {
                data += &across(at);
            }
        }
        Some(path("fig-l fig-thin", "", &data) + &start + &end + &self.hit(&line(&[from, to])))
    }
}
