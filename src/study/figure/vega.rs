//! The Vega-Lite specification of a figure: one view a panel with a layer for each form of mark.
//!
//! Both axes are quantitative, steps included (their labels are looked up), so that every mark stands where its numbers say. Numbers that
//! JSON or a logarithm lacks are drawn at the border; the datum keeps what they were in words.

use super::ink::{SERIES, dashes, hex, words_on};
use super::scale::Axis;
use super::{Figure, Mark, Panel, Ramp, Scale, ScaleKind, Shape};
use crate::study::figure::dodge::{BARS, part_share};
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
/// The shapes of dots in the order of series.
const SHAPES: [&str; 8] = ["circle", "square", "triangle-up", "diamond", "triangle-down", "cross", "stroke", "wedge"];
/// Neutral ink.
const INK: &str = "#595d65";

/// A self-contained specification (data inline).
pub fn vega(figure: &Figure) -> Value {
    let panels: Vec<Value> = figure.panels.iter().enumerate().map(|(i, panel)| view(figure, i, panel)).collect();
    json!({
        "$schema": SCHEMA,
        "title": { "text": figure.title, "subtitle": figure.note, "anchor": "start" },
        "concat": panels,
        "columns": COLUMNS.min(panels.len().max(1)),
        "config": { "view": { "stroke": null }, "axis": { "gridColor": "#e4e5e8" } },
    })
}

/// Forms of marks, from the ground up: Vega-Lite mark, and the name of the form in the data.
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

fn view(figure: &Figure, index: usize, panel: &Panel) -> Value {
    let size = if figure.panels.len() > 1 { SIZE } else { SINGLE };
    let length = |scale: &Scale, way: usize| match &scale.kind {
        ScaleKind::Steps(names) => names.len().max(1) as f64 * STEP[way],
        _ => size[way],
    };
    let present = FORMS.iter().filter(|name| panel.marks.iter().any(|mark| form(&mark.shape) == **name));
    let layers: Vec<Value> = present.flat_map(|name| layers(figure, index, panel, name)).collect();
    json!({
        "title": panel.title,
        "width": length(&panel.x, 0),
        "height": length(&panel.y, 1),
        "layer": layers,
    })
}

/// The layers of a form: tiles have one of their words, too.
fn layers(figure: &Figure, index: usize, panel: &Panel, name: &str) -> Vec<Value> {
    let own = panel.marks.iter().enumerate().filter(|(_, mark)| form(&mark.shape) == name);
    let rows: Vec<Value> = own.flat_map(|(i, mark)| rows(figure, panel, [index, i], mark)).collect();
    let position = json!({ "x": channel(&panel.x, "x_at", false), "y": channel(&panel.y, "y_at", true) });
    let ends = json!({ "x2": { "field": "x2_at" }, "y2": { "field": "y2_at" } });
    let tip = json!({ "tooltip": { "field": "tip", "type": "nominal" } });
    let color = json!({ "color": color(figure) });
    let dash =
        json!({ "strokeDash": { "field": "series", "type": "nominal", "legend": null, "scale": dash_scale(figure) } });
    let layer = |mark: Value, parts: &[&Value]| {
        let encoding: Map<String, Value> =
            parts.iter().filter_map(|part| part.as_object()).cloned().flatten().collect();
        json!({ "data": { "values": rows }, "mark": mark, "encoding": encoding })
    };
    match name {
        "tile" => {
            let fill = json!({ "color": { "field": "color", "type": "nominal", "scale": null } });
            let ink =
                json!({ "color": { "field": "ink", "type": "nominal", "scale": null }, "text": { "field": "text" } });
            let middle = json!({ "x": channel(&panel.x, "x", false), "y": channel(&panel.y, "y", true) });
            vec![layer(json!({ "type": "rect", "stroke": "#fff" }), &[&position, &ends, &fill, &tip])]
                .into_iter()
                .chain([layer(json!({ "type": "text", "fontSize": 9 }), &[&middle, &ink])])
                .chain(figure.ramp.as_ref().map(|ramp| ramp_legend(ramp)))
                .collect()
        }
        "bar" => vec![layer(
            json!({ "type": "rect", "clip": true, "stroke": "#fff", "strokeWidth": 0.5 }),
            &[&position, &ends, &color, &tip],
        )],
        "rule" | "whisker" => {
            vec![layer(json!({ "type": "rule", "clip": true }), &[&position, &ends, &color, &dash, &tip])]
        }
        "line" => {
            let path = json!({ "detail": { "field": "mark" }, "order": { "field": "order", "type": "quantitative" } });
            vec![layer(json!({ "type": "line", "clip": true }), &[&position, &color, &dash, &path, &tip])]
        }
        "text" => {
            let text = json!({ "text": { "field": "text" } });
            vec![layer(json!({ "type": "text", "align": "left", "dx": 6, "fontSize": 9 }), &[&position, &text, &tip])]
        }
        _ => {
            let shape = json!({ "shape": { "field": "series", "type": "nominal", "scale": shape_scale(figure), "title": null } });
            vec![layer(
                json!({ "type": "point", "filled": true, "opacity": 1, "size": 45 }),
                &[&position, &color, &shape, &tip],
            )]
        }
    }
}

/// A position channel. Steps run down and are labelled by their names.
fn channel(scale: &Scale, field: &str, is_y: bool) -> Value {
    let axis = Axis::new(&scale.kind, 0.0, 1.0);
    let mut drawn = json!({ "domain": axis.domain(), "nice": false, "zero": false });
    let title = if scale.label.is_empty() { Value::Null } else { json!(scale.label) };
    let mut labels = json!({ "title": title });
    match &scale.kind {
        ScaleKind::Log { .. } => drawn["type"] = json!("log"),
        ScaleKind::Linear { .. } => (),
        ScaleKind::Steps(names) => {
            drawn["reverse"] = json!(is_y);
            labels["values"] = json!((0..names.len()).collect::<Vec<_>>());
            labels["labelExpr"] = json!(format!("{}[datum.value]", json!(names)));
            labels["grid"] = json!(false);
            labels["labelLimit"] = json!(STEPS_LONGEST);
            labels["labelAngle"] = json!(if is_y { 0 } else { -45 });
        }
    }
    json!({ "field": field, "type": "quantitative", "scale": drawn, "axis": labels })
}

/// The longest name of a step, pixels.
const STEPS_LONGEST: u32 = 300;

fn names(figure: &Figure) -> Vec<&str> {
    figure.series.iter().map(|series| series.name.as_str()).collect()
}

/// Colours by series; what has none is neutral.
fn color(figure: &Figure) -> Value {
    let colors: Vec<&str> = (0..figure.series.len()).map(|i| SERIES[i % SERIES.len()][0]).collect();
    json!({
        "condition": {
            "test": "datum.series != null", "field": "series", "type": "nominal", "title": null,
            "scale": { "domain": names(figure), "range": colors },
        },
        "value": INK,
    })
}

fn shape_scale(figure: &Figure) -> Value {
    let shapes: Vec<&str> = (0..figure.series.len()).map(|i| SHAPES[i % SHAPES.len()]).collect();
    json!({ "domain": names(figure), "range": shapes })
}

fn dash_scale(figure: &Figure) -> Value {
    let dashes = figure.series.iter().enumerate().map(|(i, series)| dashes(i, series.is_dashed).unwrap_or("1 0"));
    let lengths = |dash: &str| -> Vec<u32> { dash.split(' ').filter_map(|part| part.parse().ok()).collect() };
    json!({ "domain": names(figure), "range": dashes.map(lengths).collect::<Vec<_>>() })
}

/// A layer without marks whose legend is the bar of tile colours.
fn ramp_legend(ramp: &Ramp) -> Value {
    /// Enough for a smooth bar.
    const STOPS: usize = 32;
    let axis = Axis::new(&super::head::ramp_kind(ramp), 0.0, 1.0);
    let [lo, hi] = axis.domain();
    let colors: Vec<String> = (0..=STOPS).map(|i| hex(ramp.color(axis.value(i as f64 / STOPS as f64)))).collect();
    let kind = if ramp.is_log { "log" } else { "linear" };
    json!({
        "data": { "values": [{ "value": lo }, { "value": hi }] },
        "mark": { "type": "point", "size": 0, "opacity": 0 },
        "encoding": { "fill": {
            "field": "value", "type": "quantitative", "title": ramp.label, "legend": { "orient": "top" },
            "scale": { "type": kind, "domain": [lo, hi], "range": colors, "interpolate": "rgb" },
        } },
    })
}

/// The data of a mark: one row, or one a vertex of a line. `x`, `y`, `x2` and `y2` are its numbers; the fields in `_at` say where they are
/// drawn.
fn rows(figure: &Figure, panel: &Panel, [index, number]: [usize; 2], mark: &Mark) -> Vec<Value> {
    let series = mark.series.and_then(|i| figure.series.get(i)).map(|series| series.name.as_str());
    let row = |from: [f64; 2], to: Option<[f64; 2]>, more: Value| {
        let mut row = json!({ "panel": index, "mark": number, "series": series, "tip": mark.tip, "cell": mark.cell });
        let axes = [&panel.x, &panel.y].map(|scale| Axis::new(&scale.kind, 0.0, 1.0));
        for (end, suffix) in [(Some(from), ""), (to, "2")] {
            for ((axis, value), name) in axes.iter().zip(end.into_iter().flatten()).zip(["x", "y"]) {
                row[format!("{name}{suffix}")] = number_or_words(value);
                let at = axis.place(value).map(|place| axis.value(place.at));
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
            let ends = json!({ "y_at": y - HORIZONTAL / 2.0, "y2_at": y + HORIZONTAL / 2.0 });
            vec![row([*base, *y], Some([*to, *y]), ends)]
        }
        Shape::Tile { x, y, value, text } => {
            let [x, y] = [*x as f64, *y as f64];
            let color = value.zip(figure.ramp.as_ref()).map(|(value, ramp)| ramp.color(value));
            let ink = color.map_or(INK, |color| if words_on(color) == "fig-pale" { "#fff" } else { "#111" });
            let fill = color.map_or_else(|| "#eceded".to_owned(), hex);
            let more = json!({
                "x_at": x - 0.5, "x2_at": x + 0.5, "y_at": y - 0.5, "y2_at": y + 0.5,
                "value": value.map(number_or_words), "text": text, "color": fill, "ink": ink,
            });
            vec![row([x, y], None, more)]
        }
    }
}

/// JSON has no infinity and no NaN.
fn number_or_words(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { json!(value.to_string()) }
}
