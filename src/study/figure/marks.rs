//! How each shape is drawn.
//!
//! Marks stay in their panel: lines are clipped, everything else is drawn at the border with an open arrow where its value lies outside of
//! the domain (0 or less on a logarithm, infinity). NaN has no place and is not drawn.

use super::clip::clip;
use super::dodge::{BARS, part_share};
use super::ink::{dashes, hex, words_on};
use super::labels::FONT;
use super::layout::Frame;
use super::scale::Place;
use super::svg::{open_mark, write_words};
use super::text::{Font, MIDDLE, escape, px};
use super::words::{Anchor, Words, overlap};
use super::{Figure, Mark, Shape};
use std::fmt::Write;

/// Half the size of a marker, pixels.
const RADIUS: f64 = 3.5;
/// Half the caps of a whisker.
const CAP: f64 = 3.0;
/// Half the size of an arrow.
const ARROW: f64 = 4.5;
/// Height of a horizontal bar over that of its row.
const HORIZONTAL: f64 = 0.66;
/// The narrowest bar that has a marker.
const SIGN_LEAST: f64 = 12.0;
const BAR: &str = "class=\"fig-f fig-o\"";
/// Between tiles.
const TILE_GAP: f64 = 1.0;
/// A line with more vertices has markers at some of them only.
const MARKERS_MOST: usize = 12;
/// Between words and the place that they belong to.
const AWAY: f64 = 6.0;

/// The outlines of markers in the order of series, from the middle; areas are about equal.
const MARKERS: [&str; 8] = [
    "m0-3.5a3.5 3.5 0 1 0 .01 0z",
    "m-3.2,-3.2h6.4v6.4h-6.4z",
    "m0,-4.4l4.2,7.4h-8.4z",
    "m0,-4.6l4.6,4.6l-4.6,4.6l-4.6,-4.6z",
    "m0,4.4l4.2,-7.4h-8.4z",
    "m-1.5,-4.5h3v3h3v3h-3v3h-3v-3h-3v-3h3z",
    "m-4.3,-2.2l2.1,-2.1l2.2,2.2l2.2,-2.2l2.1,2.1l-2.2,2.2l2.2,2.2l-2.1,2.1l-2.2,-2.2l-2.2,2.2l-2.1,-2.1l2.2,-2.2z",
    "m-4.5,-2.4h9v4.8h-9z",
];

/// The marker of a series around a place.
pub fn marker(series: Option<usize>, [x, y]: [f64; 2]) -> String {
    format!("M{},{}{}", px(x), px(y), MARKERS[series.unwrap_or(0) % MARKERS.len()])
}

/// An open triangle whose tip is at a place and points along x or y.
fn arrow(at: [f64; 2], [dx, dy]: [f64; 2]) -> String {
    let corner = |along: f64, side: f64| {
        let (x, y) = (at[0] + along * dx - side * dy, at[1] + along * dy + side * dx);
        format!("{},{}", px(x), px(y))
    };
    format!("M{}L{}L{}Z", corner(0.0, 0.0), corner(-2.0 * ARROW, ARROW), corner(-2.0 * ARROW, -ARROW))
}

/// All marks of a panel, from the ground up.
pub fn draw(out: &mut String, figure: &Figure, index: usize, frame: &Frame) {
    let panel = &figure.panels[index];
    let mut order: Vec<usize> = (0..panel.marks.len()).collect();
    order.sort_by_key(|i| layer(&panel.marks[*i].shape));
    let name = if panel.title.is_empty() { String::new() } else { format!(" aria-label=\"{}\"", escape(&panel.title)) };
    let _ = writeln!(out, "<g role=\"group\"{name}>");
    let mut taken: Vec<[f64; 4]> = Vec::new();
    let mut border = Some(border(frame));
    for i in order {
        let mark = &panel.marks[i];
        if layer(&mark.shape) > FILLED
            && let Some(border) = border.take()
        {
            *out += &border;
        }
        let pen = Pen { figure, frame, index: i, panel: index };
        let Some(drawn) = pen.shape(mark, &mut taken) else { continue };
        open_mark(out, mark, index);
        *out += &drawn;
        *out += "</g>\n";
    }
    *out += &border.unwrap_or_default();
    *out += "</g>\n";
}

/// The last layer of filled shapes: axes stand above them and below lines.
const FILLED: u8 = 1;

fn border(frame: &Frame) -> String {
    let [left, top, right, bottom] = [frame.left, frame.top, frame.right, frame.bottom].map(px);
    format!("<path class=\"fig-axis\" d=\"M{left},{top}V{bottom}H{right}\"/>\n")
}

fn layer(shape: &Shape) -> u8 {
    match shape {
        Shape::Tile { .. } => 0,
        Shape::Bar { .. } | Shape::HorizontalBar { .. } => 1,
        Shape::HorizontalRule(_) | Shape::VerticalRule(_) => 2,
        Shape::Line(_) => 3,
        Shape::Whisker(..) => 4,
        Shape::Dot(_) => 5,
        Shape::Text(..) => 6,
    }
}

/// Draws one mark.
struct Pen<'f> {
    figure: &'f Figure,
    frame: &'f Frame,
    panel: usize,
    index: usize,
}

impl Pen<'_> {
    /// The elements of a mark; nothing where it has no place.
    fn shape(&self, mark: &Mark, taken: &mut Vec<[f64; 4]>) -> Option<String> {
        match &mark.shape {
            Shape::Line(points) => Some(self.line(mark, points)),
            Shape::Dot(at) => self.dot(mark, *at, taken),
            Shape::Bar { x, base, to, part, parts } => self.bar(*x, [*base, *to], *part, *parts),
            Shape::HorizontalBar { y, base, to } => self.horizontal_bar(*y, [*base, *to]),
            Shape::Whisker(a, b) => self.whisker(*a, *b),
            Shape::HorizontalRule(y) => self.rule(mark, self.frame.y.place(*y)?, false),
            Shape::VerticalRule(x) => self.rule(mark, self.frame.x.place(*x)?, true),
            Shape::Tile { x, y, value, text } => self.tile([*x, *y], *value, text),
            Shape::Text(at, text) => self.words(*at, text, taken),
        }
    }

    /// Where a point lies, with what moves marks of a step apart.
    fn places(&self, [x, y]: [f64; 2]) -> Option<[Place; 2]> {
        let (mut x, mut y) = (self.frame.x.place(x)?, self.frame.y.place(y)?);
        let dodge = &self.frame.dodge;
        match dodge.is_y {
            true => y.at += dodge.offset(self.index, self.frame.y.step()),
            false if self.frame.x.has_steps() => x.at += dodge.offset(self.index, self.frame.x.step()),
            false => (),
        }
        Some([x, y])
    }

    fn is_dashed(&self, mark: &Mark) -> bool {
        mark.series.and_then(|index| self.figure.series.get(index)).is_some_and(|series| series.is_dashed)
    }

    fn dash(&self, mark: &Mark) -> String {
        let dash = mark.series.and_then(|index| dashes(index, self.is_dashed(mark)));
        dash.map_or_else(String::new, |dash| format!(" stroke-dasharray=\"{dash}\""))
    }

    fn hit(&self, d: &str) -> String {
        let mark = &self.figure.panels[self.panel].marks[self.index];
        if mark.tip.is_empty() { String::new() } else { format!("<path class=\"fig-h\" d=\"{d}\"/>") }
    }

    fn dot(&self, mark: &Mark, at: [f64; 2], taken: &mut Vec<[f64; 4]>) -> Option<String> {
        let [x, y] = self.places(at)?;
        let at = [x.at, y.at];
        taken.push([at[0] - RADIUS, at[1] - RADIUS, at[0] + RADIUS, at[1] + RADIUS]);
        let hit = self.hit(&format!("M{:.0},{:.0}h0", at[0], at[1]));
        Some(match self.direction([x, y]) {
            Some(direction) => format!("<path class=\"fig-b\" d=\"{}\"/>{hit}", arrow(at, direction)),
            None => format!("<path class=\"fig-d\" d=\"{}\"/>{hit}", marker(mark.series, at)),
        })
    }

    /// Where a place beyond the domain points.
    fn direction(&self, [x, y]: [Place; 2]) -> Option<[f64; 2]> {
        let up = if self.frame.y.has_steps() { 1.0 } else { -1.0 };
        match (x.beyond, y.beyond) {
            (0, 0) => None,
            (0, beyond) => Some([0.0, f64::from(beyond) * up]),
            (beyond, _) => Some([f64::from(beyond), 0.0]),
        }
    }

    fn line(&self, mark: &Mark, points: &[[f64; 2]]) -> String {
        let Frame { left, top, right, bottom, .. } = *self.frame;
        let open = |[x, y]: &[f64; 2]| Some([self.frame.x.open(*x)?, self.frame.y.open(*y)?]);
        let places: Vec<Option<[f64; 2]>> = points.iter().map(open).collect();
        let mut path = String::new();
        for run in places.split(Option::is_none) {
            let run: Vec<[f64; 2]> = run.iter().flatten().copied().collect();
            for piece in clip(&run, [left, top, right, bottom]) {
                for (i, [x, y]) in piece.iter().enumerate() {
                    let _ = write!(path, "{}{},{}", if i == 0 { 'M' } else { 'L' }, px(*x), px(*y));
                }
            }
        }
        let mut drawn = String::new();
        if !path.is_empty() {
            let _ = write!(drawn, "<path class=\"fig-l\"{} d=\"{path}\"/>{}", self.dash(mark), self.hit(&path));
        }
        let every = points.len().div_ceil(MARKERS_MOST).max(1);
        for (i, point) in points.iter().enumerate() {
            let Some(at) = self.places(*point) else { continue };
            let place = [at[0].at, at[1].at];
            if let Some(direction) = self.direction(at) {
                let _ = write!(drawn, "<path class=\"fig-b\" d=\"{}\"/>", arrow(place, direction));
            } else if !self.is_dashed(mark) && mark.series.is_some() && i % every == 0 && !self.has_dots(mark) {
                let _ = write!(drawn, "<path class=\"fig-d\" d=\"{}\"/>", marker(mark.series, place));
            }
        }
        drawn
    }

    /// Whether the series has dots of its own in this panel.
    fn has_dots(&self, mark: &Mark) -> bool {
        let mut marks = self.figure.panels[self.panel].marks.iter();
        marks.any(|other| other.series == mark.series && matches!(other.shape, Shape::Dot(_)))
    }

    fn rule(&self, mark: &Mark, place: Place, is_upright: bool) -> Option<String> {
        let Frame { left, top, right, bottom, .. } = *self.frame;
        if place.beyond != 0 {
            return None;
        }
        let d = match is_upright {
            true => format!("M{},{}V{}", px(place.at), px(top), px(bottom)),
            false => format!("M{},{}H{}", px(left), px(place.at), px(right)),
        };
        Some(format!("<path class=\"fig-l fig-thin\"{} d=\"{d}\"/>{}", self.dash(mark), self.hit(&d)))
    }

    fn whisker(&self, a: [f64; 2], b: [f64; 2]) -> Option<String> {
        let (from, to) = (self.places(a)?, self.places(b)?);
        let is_level = a[1] == b[1];
        let line = format!("M{},{}L{},{}", px(from[0].at), px(from[1].at), px(to[0].at), px(to[1].at));
        let mut path = line.clone();
        for place in [from, to] {
            let at = [place[0].at, place[1].at];
            match self.direction(place) {
                Some([dx, dy]) => {
                    let back = |side: f64| [at[0] - CAP * (2.0 * dx + side * dy), at[1] - CAP * (2.0 * dy - side * dx)];
                    let [one, other] = [back(1.0), back(-1.0)];
                    let _ = write!(path, "M{},{}L{},{}", px(one[0]), px(one[1]), px(at[0]), px(at[1]));
                    let _ = write!(path, "L{},{}", px(other[0]), px(other[1]));
                }
                None if is_level => {
                    let _ = write!(path, "M{},{}v{}", px(at[0]), px(at[1] - CAP), px(2.0 * CAP));
                }
                None => {
                    let _ = write!(path, "M{},{}h{}", px(at[0] - CAP), px(at[1]), px(2.0 * CAP));
                }
            }
        }
        Some(format!("<path class=\"fig-l fig-thin\" d=\"{path}\"/>{}", self.hit(&line)))
    }

    fn bar(&self, x: f64, [base, to]: [f64; 2], part: usize, parts: usize) -> Option<String> {
        let (axis, y) = (&self.frame.x, &self.frame.y);
        let step = if axis.has_steps() { axis.step() } else { self.least_distance() };
        let middle = axis.place(x)?.at + part_share(part, parts) * step;
        let width = (BARS * step / parts.max(1) as f64).max(1.0);
        let (from, end) = (y.place(base)?, y.place(to)?);
        let (top, height) = (from.at.min(end.at), (from.at - end.at).abs());
        let Frame { left, right, .. } = *self.frame;
        let (start, stop) = ((middle - width / 2.0).max(left), (middle + width / 2.0).min(right));
        let mut drawn = rectangle(BAR, [start, top, stop - start, height]);
        if let Some(direction) = self.direction([Place { at: middle, beyond: 0 }, end]) {
            let _ = write!(drawn, "<path class=\"fig-b\" d=\"{}\"/>", arrow([middle, end.at], direction));
        }
        drawn += &self.sign([start, top, stop - start, height]);
        Some(drawn + &self.hit(&format!("M{},{}v{}", px(middle), px(top), px(height))))
    }

    /// Between the bars of an axis of numbers, pixels.
    fn least_distance(&self) -> f64 {
        let marks = self.figure.panels[self.panel].marks.iter();
        let places = marks.filter_map(|mark| match mark.shape {
            Shape::Bar { x, .. } => self.frame.x.place(x).map(|place| place.at),
            _ => None,
        });
        let mut places: Vec<f64> = places.collect();
        places.sort_by(f64::total_cmp);
        let distances = places.windows(2).map(|pair| pair[1] - pair[0]).filter(|distance| *distance > 0.01);
        distances.fold((self.frame.right - self.frame.left) / 4.0, f64::min)
    }

    fn horizontal_bar(&self, y: f64, [base, to]: [f64; 2]) -> Option<String> {
        let [from, middle] = self.places([base, y])?;
        let end = self.frame.x.place(to)?;
        let lanes = self.frame.dodge.count.max(1) as f64;
        let height = self.frame.y.step() * HORIZONTAL / lanes;
        let (left, width) = (from.at.min(end.at), (from.at - end.at).abs());
        let mut drawn = rectangle(BAR, [left, middle.at - height / 2.0, width, height]);
        if let Some(direction) = self.direction([end, Place { at: middle.at, beyond: 0 }]) {
            let _ = write!(drawn, "<path class=\"fig-b\" d=\"{}\"/>", arrow([end.at, middle.at], direction));
        }
        drawn += &self.sign([left, middle.at - height / 2.0, width, height]);
        Some(drawn + &self.hit(&format!("M{},{}h{}", px(left), px(middle.at), px(width))))
    }

    /// The marker of a series in the middle of its bar, for whom colours do not tell it; nothing where it has no room.
    fn sign(&self, [left, top, width, height]: [f64; 4]) -> String {
        let mark = &self.figure.panels[self.panel].marks[self.index];
        if self.figure.series.len() < 2 || mark.series.is_none() || width.min(height) < SIGN_LEAST {
            return String::new();
        }
        format!("<path class=\"fig-hole\" d=\"{}\"/>", marker(mark.series, [left + width / 2.0, top + height / 2.0]))
    }

    fn tile(&self, [x, y]: [usize; 2], value: Option<f64>, text: &str) -> Option<String> {
        let (across, down) = (&self.frame.x, &self.frame.y);
        let (middle, level) = (across.place(x as f64)?.at, down.place(y as f64)?.at);
        let (width, height) = (across.step() - TILE_GAP, down.step() - TILE_GAP);
        let area = [middle - width / 2.0, level - height / 2.0, width, height];
        let ramp = self.figure.ramp.as_ref();
        let color = value.filter(|value| !value.is_nan()).zip(ramp).map(|(value, ramp)| ramp.color(value));
        let fill = color.map_or_else(
            || "class=\"fig-none fig-o\"".to_owned(),
            |color| format!("class=\"fig-o\" fill=\"{}\"", hex(color)),
        );
        let mut drawn = rectangle(&fill, area);
        if let Some(size) = self.frame.tile_font.filter(|_| !text.is_empty()) {
            let at = [middle, level + size * MIDDLE].map(px);
            let class = color.map_or("fig-muted fig-gap", words_on);
            let own = if size == FONT.size { String::new() } else { format!(" font-size=\"{}\"", px(size)) };
            let (x, y, text) = (&at[0], &at[1], escape(text));
            let _ = write!(drawn, "<text class=\"{class}\"{own} x=\"{x}\" y=\"{y}\">{text}</text>");
        }
        Some(drawn)
    }

    /// Words beside their place, on the first side that is free; nothing where all are taken.
    fn words(&self, at: [f64; 2], text: &str, taken: &mut Vec<[f64; 4]>) -> Option<String> {
        let [x, y] = self.places(at)?;
        let (x, y) = (x.at, y.at);
        let Frame { left, top, right, bottom, .. } = *self.frame;
        let font = Font::new(FONT.size);
        let level = y + font.size * MIDDLE;
        let sides = [
            ([x + AWAY, level], Anchor::Start),
            ([x - AWAY, level], Anchor::End),
            ([x, y - AWAY], Anchor::Middle),
            ([x, y + AWAY + font.size * MIDDLE * 2.0], Anchor::Middle),
            ([x + AWAY, y - AWAY], Anchor::Start),
            ([x - AWAY, y - AWAY], Anchor::End),
        ];
        let found = sides.into_iter().find_map(|(at, anchor)| {
            let words = Words::new(text, at, font, "fig-ink fig-halo").anchor(anchor);
            let area = words.area();
            let is_inside = area[0] >= left && area[2] <= right && area[1] >= top && area[3] <= bottom;
            (is_inside && !taken.iter().any(|other| overlap(*other, area))).then_some((words, area))
        });
        let (words, area) = found?;
        taken.push(area);
        let mut drawn = String::new();
        write_words(&mut drawn, &words);
        Some(drawn)
    }
}

/// A rectangle of an area: left, top, width and height.
fn rectangle(paint: &str, [x, y, width, height]: [f64; 4]) -> String {
    let [x, y, width, height] = [x, y, width, height].map(px);
    format!("<path {paint} d=\"M{x},{y}h{width}v{height}h-{width}z\"/>")
}
