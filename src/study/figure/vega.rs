//! The Vega-Lite specification of a figure: one view a panel with a layer for each form of mark.
//!
//! Both axes are quantitative, steps included (their labels are looked up), so that every mark stands where its numbers say. Numbers that
//! JSON or a logarithm lacks are drawn at the border; the datum keeps what they were in words.

use super::dodge::{BARS, Dodge, PITCH, dodges, part_share};
use super::head::ramp_kind;
use super::ink::{INKS, SERIES, dashes, hex, words_on};
use super::labels::Labels;
use super::layout::tried;
use super::scale::Axis;
use super::{Figure, Mark, Panel, Ramp, Scale, ScaleKind, Shape};
use serde_json::{Map, Value, json};

/// The schema of the specification; an identifier, never fetched by this program.
const SCHEMA: &str = "https://vega.github.io/schema/vega-lite/v6.json";
/// Panels side by side, and the size of one, pixels.
const COLUMNS: usize = 3;
const SIZE: [f64; 2] = [220.0, 150.0];
const SINGLE: [f64; 2] = [520.0, 300.0];
/// Pixels of a step.
const STEP: [f64; 2] = [36.0, 22.0];
/// Height of a horizontal bar, steps.
const HORIZONTAL: f64 = 0.66;
/// The outlines of dots in the order of series, as far as Vega has them; -1 to 1 else.
const OUTLINES: [&str; 8] = [
    "circle",
    "square",
    "triangle-up",
    "diamond",
    "triangle-down",
    "cross",
    "M-1,-0.5L-0.5,-1L0,-0.5L0.5,-1L1,-0.5L0.5,0L1,0.5L0.5,1L0,0.5L-0.5,1L-1,0.5L-0.5,0Z",
    "M-1,-0.5H1V0.5H-1Z",
];
/// The legend's mark of a series that has lines only.
const LINE: &str = "M-1.6,-0.2H1.6V0.2H-1.6Z";
/// Area of a dot, square pixels.
const DOT: f64 = 50.0;
/// Neutral ink and missing tiles, as in the SVG on a light ground.
const INK: &str = INKS[2].3[0];
const NONE: &str = INKS[INKS.len() - 1].3[0];

/// A self-contained specification (data inline).
pub fn vega(figure: &Figure) -> Value {
    let dodges = dodges(figure);
    let view = |(i, panel)| View { figure, index: i, panel, dodge: &dodges[i] }.value();
    let count = figure.panels.len().max(1);
    json!({
        "$schema": SCHEMA,
        "title": { "text": figure.title, "subtitle": figure.note, "anchor": "start", "offset": 12 },
        "concat": figure.panels.iter().enumerate().map(view).collect::<Vec<Value>>(),
        // Evenly filled rows.
        "columns": count.div_ceil(count.div_ceil(COLUMNS)),
        "config": {
            "view": { "stroke": null },
            "axis": { "gridColor": "#e4e5e8", "titleFontWeight": "normal" },
            "legend": { "orient": "top", "title": null },
        },
    })
}

/// Forms of marks, from the ground up.
const FORMS: [&str; 7] = ["tile", "bar", "rule", "line", "whisker", "dot", "text"];

fn form(shape: &Shape) -> &'static str {
    match shape {
        Shape::Tile { .. } => "tile",
        Shape::Bar { .. } | Shape::HorizontalBar { .. } => "bar",
        Shape::HorizontalRule(_) | Shape::VerticalRule(_) => "rule",
        Shape::Line(_) => "line",
        Shape::Whisker(..) => "whisker",
        Shape::Dot(_) => "dot",
        Shape::Text(..) => "text",
    }
}

/// A panel.
struct View<'f> {
    figure: &'f Figure,
    index: usize,
    panel: &'f Panel,
    dodge: &'f Dodge,
}

impl View<'_> {
    /// Pixels of a step of x or y, with room for its lanes.
    fn step(&self, way: usize) -> f64 {
        let is_own = self.dodge.is_y == (way == 1);
        STEP[way].max(if is_own { (self.dodge.count + 1) as f64 * PITCH } else { 0.0 })
    }

    fn length(&self, way: usize) -> f64 {
        let size = if self.figure.panels.len() > 1 { SIZE } else { SINGLE };
        match &[&self.panel.x, &self.panel.y][way].kind {
            ScaleKind::Steps(names) => names.len().max(1) as f64 * self.step(way),
            _ => size[way],
        }
    }

    fn value(&self) -> Value {
        let layers: Vec<Value> = FORMS.iter().flat_map(|form| self.layers(form)).collect();
        let title = json!({ "text": self.panel.title, "anchor": "start" });
        json!({ "title": title, "width": self.length(0), "height": self.length(1), "layer": layers })
    }

    /// The layers of a form: one with the colours of series, one in neutral ink.
    fn layers(&self, name: &str) -> Vec<Value> {
        let own: Vec<_> = self.panel.marks.iter().enumerate().filter(|(_, mark)| form(&mark.shape) == name).collect();
        let of = |is_neutral: bool| -> Vec<Value> {
            let own = own.iter().filter(|(_, mark)| self.series(mark).is_none() == is_neutral);
            own.flat_map(|(i, mark)| self.rows(*i, mark)).collect()
        };
        let both = [(of(true), true), (of(false), false)];
        both.into_iter()
            .filter(|(rows, _)| !rows.is_empty())
            .flat_map(|(rows, is)| self.layer(name, rows, is))
            .collect()
    }

    fn layer(&self, name: &str, rows: Vec<Value>, is_neutral: bool) -> Vec<Value> {
        let position = json!({ "x": self.channel(0, "x_at"), "y": self.channel(1, "y_at") });
        let ends = json!({ "x2": { "field": "x2_at" }, "y2": { "field": "y2_at" } });
        let tip = json!({ "tooltip": { "field": "tip", "type": "nominal" } });
        let of = |channel: &str, range: fn(&Figure, usize) -> Value| match is_neutral {
            true if channel == "color" => json!({ "color": { "value": INK } }),
            true => json!({}),
            false => json!({ channel: by_series(self.figure, range) }),
        };
        let (color, outline) = (of("color", colors), of("shape", outlines));
        // A scale would merge its legend with that of the colours.
        let dash = json!({ "strokeDash": { "field": "dash", "type": "nominal", "scale": null, "legend": null } });
        let layer = |mark: Value, parts: &[&Value]| {
            let encoding: Map<String, Value> =
                parts.iter().filter_map(|part| part.as_object()).cloned().flatten().collect();
            json!({ "data": { "values": rows }, "mark": mark, "encoding": encoding })
        };
        match name {
            "tile" => {
                let fill = json!({ "color": { "field": "color", "type": "nominal", "scale": null } });
                let middle = json!({ "x": self.channel(0, "x"), "y": self.channel(1, "y") });
                let ink = json!({ "color": { "field": "ink", "type": "nominal", "scale": null }, "text": { "field": "text" } });
                let tiles = layer(json!({ "type": "rect", "stroke": "#fff" }), &[&position, &ends, &fill, &tip]);
                let words = layer(json!({ "type": "text", "fontSize": 9 }), &[&middle, &ink]);
                [tiles, words].into_iter().chain(self.figure.ramp.as_ref().map(ramp_legend)).collect()
            }
            "bar" => {
                let mark = json!({ "type": "rect", "clip": true, "stroke": "#fff", "strokeWidth": 0.5 });
                vec![layer(mark, &[&position, &ends, &color, &tip])]
            }
            "rule" | "whisker" => {
                let mark = json!({ "type": "rule", "clip": true, "strokeWidth": 1.25 });
                vec![layer(mark, &[&position, &ends, &color, &dash, &tip])]
            }
            "line" => {
                let path =
                    json!({ "detail": { "field": "mark" }, "order": { "field": "order", "type": "quantitative" } });
                vec![layer(json!({ "type": "line", "clip": true }), &[&position, &color, &dash, &path, &tip])]
            }
            "text" => {
                let text = json!({ "text": { "field": "text" } });
                let mark = json!({ "type": "text", "align": "left", "dx": 6, "fontSize": 9 });
                vec![layer(mark, &[&position, &text, &tip])]
            }
            _ => {
                let mark = json!({ "type": "point", "filled": true, "opacity": 1, "size": DOT });
                vec![layer(mark, &[&position, &color, &outline, &tip])]
            }
        }
    }

    /// A position channel with the ticks of the SVG. Steps run down.
    fn channel(&self, way: usize, field: &str) -> Value {
        let (scale, tried) = ([&self.panel.x, &self.panel.y][way], &tried(self.panel)[way]);
        let length = self.length(way);
        let found = match way {
            0 => Labels::below(scale, length, [STEP[0]; 2], tried),
            _ => Labels::beside(scale, length, length, tried),
        };
        let (values, labels): (Vec<f64>, Vec<&str>) = found.ticks().unzip();
        let title = if scale.label.is_empty() { Value::Null } else { json!(scale.label) };
        let (is_log, is_steps) =
            (matches!(scale.kind, ScaleKind::Log { .. }), matches!(scale.kind, ScaleKind::Steps(_)));
        let angle = if is_steps && way == 0 { -45 } else { 0 };
        json!({
            "field": field, "type": "quantitative",
            "scale": {
                "type": if is_log { "log" } else { "linear" }, "domain": Axis::new(&scale.kind, 0.0, 1.0).domain(), "nice": false,
                "zero": false, "reverse": is_steps && way == 1,
            },
            "axis": {
                "title": title, "values": values, "labelExpr": format!("{}[indexof({}, datum.value)]", json!(labels), json!(values)),
                "grid": !is_steps, "labelLimit": LABEL_LONGEST, "labelAngle": angle, "labelOverlap": false,
            },
        })
    }

    fn series(&self, mark: &Mark) -> Option<&str> {
        mark.series.and_then(|index| self.figure.series.get(index)).map(|series| series.name.as_str())
    }
    /// The data of a mark: one row, or one a vertex of a line. `x`, `y`, `x2` and `y2` are its numbers; the fields in `_at` say where they are
    /// drawn.
    fn rows(&self, number: usize, mark: &Mark) -> Vec<Value> {
        let (figure, panel, index) = (self.figure, self.panel, self.index);
        let series = self.series(mark);
        // Steps from the middle of the own one.
        let way = usize::from(self.dodge.is_y);
        let aside = self.dodge.offset(number, self.step(way)) / self.step(way);
        let aside = if matches!(mark.shape, Shape::Dot(_) | Shape::Whisker(..) | Shape::HorizontalBar { .. }) {
            aside
        } else {
            0.0
        };
        let row = |from: [f64; 2], to: Option<[f64; 2]>, more: Value| {
            let mut row = json!({
                "panel": index, "mark": number, "series": series, "tip": mark.tip, "cell": mark.cell,
                "dash": dash_lengths(figure, mark),
            });
            let axes = [&panel.x, &panel.y].map(|scale| Axis::new(&scale.kind, 0.0, 1.0));
            for (end, suffix) in [(Some(from), ""), (to, "2")] {
                for (i, ((axis, value), name)) in axes.iter().zip(end.into_iter().flatten()).zip(["x", "y"]).enumerate()
                {
                    row[format!("{name}{suffix}")] = number_or_words(value);
                    let aside = if i == way && axis.has_steps() { aside } else { 0.0 };
                    let at = axis.place(value).map(|place| axis.value(place.at) + aside);
                    row[format!("{name}{suffix}_at")] = at.map_or(Value::Null, number_or_words);
                }
            }
            if let (Some(row), Value::Object(more)) = (row.as_object_mut(), more) {
                row.extend(more);
            }
            row
        };
        let domain = |scale: &Scale| Axis::new(&scale.kind, 0.0, 1.0).domain();
        match &mark.shape {
            Shape::Line(points) => {
                let vertex = |(order, point): (usize, &[f64; 2])| row(*point, None, json!({ "order": order }));
                points.iter().enumerate().map(vertex).collect()
            }
            Shape::Dot(at) => vec![row(*at, None, Value::Null)],
            Shape::Text(at, text) => vec![row(*at, None, json!({ "text": text }))],
            Shape::Whisker(a, b) => vec![row(*a, Some(*b), Value::Null)],
            Shape::HorizontalRule(y) => {
                let [lo, hi] = domain(&panel.x);
                vec![row([lo, *y], Some([hi, *y]), Value::Null)]
            }
            Shape::VerticalRule(x) => {
                let [lo, hi] = domain(&panel.y);
                vec![row([*x, lo], Some([*x, hi]), Value::Null)]
            }
            Shape::Bar { x, base, to, part, parts } => {
                let middle = x + part_share(*part, *parts);
                let half = BARS / (*parts).max(1) as f64 / 2.0;
                vec![row([*x, *base], Some([*x, *to]), json!({ "x_at": middle - half, "x2_at": middle + half }))]
            }
            Shape::HorizontalBar { y, base, to } => {
                let half = HORIZONTAL / 2.0 / self.dodge.count.max(1) as f64;
                let ends = json!({ "y_at": y + aside - half, "y2_at": y + aside + half });
                vec![row([*base, *y], Some([*to, *y]), ends)]
            }
            Shape::Tile { x, y, value, text } => {
                let [x, y] = [*x as f64, *y as f64];
                let color = value.zip(figure.ramp.as_ref()).map(|(value, ramp)| ramp.color(value));
                let ink = color.map_or(INK, |color| if words_on(color) == "fig-pale" { "#fff" } else { "#000" });
                let fill = color.map_or_else(|| NONE.to_owned(), hex);
                let more = json!({
                    "x_at": x - 0.5, "x2_at": x + 0.5, "y_at": y - 0.5, "y2_at": y + 0.5,
                    "value": value.map(number_or_words), "text": text, "color": fill, "ink": ink,
                });
                vec![row([x, y], None, more)]
            }
        }
    }
}

/// The longest label, pixels.
const LABEL_LONGEST: u32 = 300;

/// A channel by series with the range that `of` has for each.
fn by_series(figure: &Figure, of: fn(&Figure, usize) -> Value) -> Value {
    let names: Vec<&str> = figure.series.iter().map(|series| series.name.as_str()).collect();
    let range: Vec<Value> = (0..figure.series.len()).map(|index| of(figure, index)).collect();
    json!({ "field": "series", "type": "nominal", "scale": { "domain": names, "range": range } })
}

fn colors(_: &Figure, index: usize) -> Value {
    json!(SERIES[index % SERIES.len()][0])
}

fn outlines(figure: &Figure, index: usize) -> Value {
    let mut marks = figure.panels.iter().flat_map(|panel| &panel.marks);
    let has_dots = marks.any(|mark| mark.series == Some(index) && matches!(mark.shape, Shape::Dot(_)));
    json!(if has_dots { OUTLINES[index % OUTLINES.len()] } else { LINE })
}

/// Lengths of dashes and gaps of a mark.
fn dash_lengths(figure: &Figure, mark: &Mark) -> Vec<u32> {
    let series = mark.series.and_then(|index| Some((index, figure.series.get(index)?)));
    let dash = series.and_then(|(index, series)| dashes(index, series.is_dashed)).unwrap_or("1 0");
    dash.split(' ').filter_map(|part| part.parse().ok()).collect()
}

/// A layer without marks whose legend is the bar of tile colours.
fn ramp_legend(ramp: &Ramp) -> Value {
    /// Enough for a smooth bar.
    const STOPS: usize = 32;
    let axis = Axis::new(&ramp_kind(ramp), 0.0, 1.0);
    let [lo, hi] = axis.domain();
    let colors: Vec<String> = (0..=STOPS).map(|i| hex(ramp.color(axis.value(i as f64 / STOPS as f64)))).collect();
    let kind = if ramp.is_log { "log" } else { "linear" };
    // Evenly spaced on the scale: a logarithm interpolates in its own domain.
    json!({
        "data": { "values": [{ "value": lo }, { "value": hi }] },
        "mark": { "type": "point", "size": 0, "opacity": 0 },
        "encoding": { "fill": {
            "field": "value", "type": "quantitative", "title": ramp.label, "legend": { "orient": "top", "title": ramp.label },
            "scale": { "type": kind, "domain": [lo, hi], "range": colors, "interpolate": "rgb" },
        } },
    })
}

/// JSON has no infinity and no NaN.
fn number_or_words(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { json!(value.to_string()) }
}
