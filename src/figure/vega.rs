//! The Vega-Lite specification of a figure: one view a panel with a layer for each form of mark, data inline.
//!
//! A datum has the numbers of its mark, the index of a step, and the mark's words, series and cell. Vega-Lite chooses ticks itself. Numbers
//! outside of a domain are drawn at its border.

use super::head::ramp_scale;
use super::ink::{INKS, SERIES, dashes, hex, words_on};
use super::scale::Axis;
use super::{Figure, Mark, Panel, Ramp, Scale, ScaleKind, Series, Shape};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The schema of the specification; an identifier, never fetched by this program.
const SCHEMA: &str = "https://vega.github.io/schema/vega-lite/v6.json";
/// Panels side by side, and the size of one, pixels.
const COLUMNS: usize = 3;
const SIZE: [f64; 2] = [220.0, 150.0];
const SINGLE: [f64; 2] = [520.0, 300.0];
/// Pixels of a step.
const STEP: [f64; 2] = [36.0, 22.0];
/// Colours between which those of tiles are interpolated.
const STOPS: usize = 32;
/// Neutral ink, as in the SVG on a light ground.
const INK: &str = INKS[2].3[0];

/// A self-contained specification (data inline).
pub fn vega(figure: &Figure) -> Value {
    let count = figure.panels.len().max(1);
    json!({
        "$schema": SCHEMA,
        "title": { "text": figure.title, "subtitle": figure.note, "anchor": "start", "offset": 12 },
        "concat": figure.panels.iter().map(|panel| view(figure, panel)).collect::<Vec<Value>>(),
        // Evenly filled rows.
        "columns": count.div_ceil(count.div_ceil(COLUMNS)),
        "config": {
            "view": { "stroke": null },
            "axis": { "gridColor": "#e4e5e8", "titleFontWeight": "normal" },
            "legend": { "orient": "top" },
            "bar": { "stroke": "#fff", "strokeWidth": 0.5 },
            "point": { "filled": true, "opacity": 1, "size": 50 },
            "rect": { "stroke": "#fff" },
            "rule": { "strokeWidth": 1.25 },
            "text": { "fontSize": 9 },
        },
    })
}

fn view(figure: &Figure, panel: &Panel) -> Value {
    let size = if figure.panels.len() > 1 { SIZE } else { SINGLE };
    let length = |way: usize| match [&panel.x, &panel.y][way].kind {
        ScaleKind::Steps(_) => json!({ "step": STEP[way] }),
        _ => json!(size[way]),
    };
    // Marks of one form with the same fields, those in neutral ink apart.
    let mut layers: BTreeMap<_, Vec<Value>> = BTreeMap::new();
    for (number, mark) in panel.marks.iter().enumerate() {
        for row in rows(figure, number, mark) {
            let fields: Vec<&str> = ["x", "y", "x2", "y2"].into_iter().filter(|field| !row[field].is_null()).collect();
            layers.entry((form(&mark.shape), series(figure, mark).is_some(), fields)).or_default().push(row);
        }
    }
    let layers = layers.into_iter().map(|(((_, form), has_series, fields), rows)| {
        let mut encoding = look(figure, form, has_series);
        for field in fields {
            let scale = if field.starts_with('x') { &panel.x } else { &panel.y };
            encoding[field] = if field.len() == 1 { channel(scale, field) } else { json!({ "field": field }) };
        }
        let words = (form == "rect").then(|| {
            let ink = json!({ "field": "ink", "type": "nominal", "scale": null });
            json!({
                "mark": "text",
                "encoding": { "x": encoding["x"], "y": encoding["y"], "text": { "field": "text" }, "color": ink },
            })
        });
        let layer: Vec<Value> = [json!({ "mark": form, "encoding": encoding })].into_iter().chain(words).collect();
        json!({ "data": { "values": rows }, "layer": layer })
    });
    json!({
        "title": { "text": panel.title, "anchor": "start" },
        "width": length(0),
        "height": length(1),
        "layer": layers.collect::<Vec<Value>>(),
    })
}

/// The name of a form of marks, with its place from the ground up.
fn form(shape: &Shape) -> (u8, &'static str) {
    match shape {
        Shape::Tile { .. } => (0, "rect"),
        Shape::HorizontalBar { .. } => (1, "bar"),
        Shape::HorizontalRule(_) | Shape::VerticalRule(_) => (2, "rule"),
        Shape::Line(_) => (3, "line"),
        Shape::Whisker(..) => (4, "rule"),
        Shape::Dot(_) => (5, "point"),
    }
}

/// A position channel. Steps are told by their indices: two may have one name.
fn channel(scale: &Scale, field: &str) -> Value {
    let title = (!scale.label.is_empty()).then_some(&scale.label);
    let quantitative = |kind: &str, lo: f64, hi: f64| {
        let scale =
            json!({ "type": kind, "domain": [number(lo), number(hi)], "nice": false, "zero": false, "clamp": true });
        json!({ "field": field, "type": "quantitative", "title": title, "scale": scale })
    };
    match &scale.kind {
        ScaleKind::Linear { lo, hi } => quantitative("linear", *lo, *hi),
        ScaleKind::Log { lo, hi } => quantitative("log", *lo, *hi),
        ScaleKind::Steps(names) => {
            let steps: Vec<usize> = (0..names.len()).collect();
            let axis = json!({ "labelExpr": format!("{}[datum.value]", json!(names)), "labelLimit": 300 });
            json!({ "field": field, "type": "ordinal", "title": title, "scale": { "domain": steps }, "axis": axis })
        }
    }
}

/// The channels of a form besides its place.
fn look(figure: &Figure, form: &str, has_series: bool) -> Value {
    let names: Vec<&str> = figure.series.iter().map(|series| series.name.as_str()).collect();
    let mut by_series = json!({ "field": "series", "type": "nominal", "title": null, "scale": { "domain": names } });
    let mut look = json!({ "tooltip": { "field": "tip", "type": "nominal" } });
    if form == "point" && has_series {
        look["shape"] = by_series.clone();
    }
    let colors: Vec<&str> = (0..names.len()).map(|index| SERIES[index % SERIES.len()][0]).collect();
    by_series["scale"]["range"] = json!(colors);
    look["color"] = match &figure.ramp {
        Some(ramp) if form == "rect" => ramp_color(ramp),
        _ if has_series => by_series,
        _ => json!({ "value": INK }),
    };
    if form == "line" || form == "rule" {
        // A scale would merge its legend with that of the colours.
        look["strokeDash"] = json!({ "field": "dash", "type": "nominal", "scale": null, "legend": null });
        look["detail"] = json!({ "field": "mark" });
    }
    if form == "line" {
        look["order"] = json!({ "field": "order", "type": "quantitative" });
    }
    look
}

fn ramp_color(ramp: &Ramp) -> Value {
    let scale = ramp_scale(ramp);
    let axis = Axis::new(&scale.kind, 0.0, 1.0);
    let colors: Vec<String> = (0..=STOPS).map(|i| hex(ramp.color(axis.value(i as f64 / STOPS as f64)))).collect();
    let mut color = channel(&scale, "value");
    // Evenly spaced on the scale: a logarithm interpolates in its own domain.
    (color["scale"]["range"], color["scale"]["interpolate"]) = (json!(colors), json!("rgb"));
    color
}

fn series<'f>(figure: &'f Figure, mark: &Mark) -> Option<(usize, &'f Series)> {
    mark.series.and_then(|index| Some((index, figure.series.get(index)?)))
}

/// The data of a mark: one row, or one a vertex of a line.
fn rows(figure: &Figure, index: usize, mark: &Mark) -> Vec<Value> {
    let series = series(figure, mark);
    let dash = series.and_then(|(index, series)| dashes(index, series.is_dashed)).unwrap_or("1 0");
    let dash: Vec<u32> = dash.split(' ').filter_map(|part| part.parse().ok()).collect();
    let row = |own: &[(&str, f64)]| {
        let name = series.map(|(_, series)| &series.name);
        let mut row = json!({ "mark": index, "series": name, "tip": mark.tip, "cell": mark.cell, "dash": dash });
        own.iter().for_each(|(field, value)| row[field] = number(*value));
        row
    };
    match &mark.shape {
        Shape::Line(points) => {
            let vertex = |(order, [x, y]): (usize, &[f64; 2])| row(&[("x", *x), ("y", *y), ("order", order as f64)]);
            points.iter().enumerate().map(vertex).collect()
        }
        Shape::Dot([x, y]) => vec![row(&[("x", *x), ("y", *y)])],
        Shape::Whisker(a, b) if a[1] == b[1] => vec![row(&[("x", a[0]), ("x2", b[0]), ("y", a[1])])],
        Shape::Whisker(a, b) => vec![row(&[("x", a[0]), ("y", a[1]), ("y2", b[1])])],
        Shape::HorizontalBar { y, base, to } => vec![row(&[("x", *base), ("x2", *to), ("y", *y)])],
        Shape::HorizontalRule(y) => vec![row(&[("y", *y)])],
        Shape::VerticalRule(x) => vec![row(&[("x", *x)])],
        Shape::Tile { x, y, value, text } => {
            let mut row = row(&[("x", *x as f64), ("y", *y as f64), ("value", value.unwrap_or(f64::NAN))]);
            let color = value.zip(figure.ramp.as_ref()).map(|(value, ramp)| ramp.color(value));
            let is_pale = color.is_some_and(|color| words_on(color) == "fig-pale");
            (row["text"], row["ink"]) = (json!(text), json!(if is_pale { "#fff" } else { "#000" }));
            vec![row]
        }
    }
}

/// JSON has no infinity and no NaN: the largest number, which a scale clamps, and nothing.
fn number(value: f64) -> Value {
    json!(value.clamp(f64::MIN, f64::MAX))
}
