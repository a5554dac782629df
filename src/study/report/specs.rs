//! Vega-Lite specifications: how the tables beside the report are drawn by people who restyle them.
//!
//! Every specification says which columns are numbers: Vega takes the columns of a CSV file for text, and text has another order (1, 16, 4).

use crate::runner::tables::{DISPLAY_HEADLINE, HEADLINE};
use crate::study::answers::study::{Role, Study};
use crate::study::answers::tables::AnswerTable;
use crate::study::answers::{Answers, exposure};
use crate::table::csv::Cell;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// The schema of the specifications; an identifier, never fetched by this program.
const VEGA_LITE: &str = "https://vega.github.io/schema/vega-lite/v6.json";

/// What the headline metric is called on an axis.
const ERROR: &str = "relMSE";
/// Small charts in a row.
const ACROSS: usize = 3;
/// An environment with fewer ranges has points, no curve.
const RANGES_MIN: usize = 3;

/// How a table is drawn; `None` for one that has no figure of its own.
pub fn spec(table: &AnswerTable, study: &Study, answers: &Answers) -> Option<Value> {
    let figure = Figure::new(table, study, answers);
    let own = match table.name {
        "convergence" => figure.convergence(),
        "break_even" => figure.break_even(),
        "break_even_by_n_dot_v" => figure.break_even_by_n_dot_v(),
        "error_by_n_dot_v_and_alpha" => figure.error_map(),
        "n_dot_v_profile" => figure.profile(),
        "energy_by_n_dot_v" => figure.energy(),
        "time_and_error" => figure.time_and_error(),
        "exposure_and_contrast" => visibility(),
        "dynamic_range" => figure.dynamic_range(),
        "effects" => effects(),
        "pass_times" => pass_times(),
        _ => return None,
    };
    let numbers: Map<String, Value> = figure.numbers().map(|column| (column.to_owned(), json!("number"))).collect();
    let mut spec = json!({
        "$schema": VEGA_LITE,
        "data": { "url": format!("{}.csv", table.name), "format": { "type": "csv", "parse": numbers } },
        "config": { "mark": { "tooltip": { "content": "data" } } },
    });
    if let (Some(spec), Value::Object(own)) = (spec.as_object_mut(), own) {
        spec.extend(own);
    }
    Some(without_nulls(spec))
}

/// A table with the axes that tell its cases apart.
struct Figure<'t> {
    table: &'t AnswerTable,
    /// All of them, and those that are not alpha.
    axes: Vec<&'t str>,
    others: Vec<&'t str>,
    /// Of the others those that are ways to make an image of one scene.
    ways: Vec<&'t str>,
}

impl<'t> Figure<'t> {
    fn new(table: &'t AnswerTable, study: &Study, answers: &'t Answers) -> Self {
        let axes: Vec<&str> = answers.case_axes.iter().map(String::as_str).collect();
        let others: Vec<&str> = axes.iter().copied().filter(|name| *name != "alpha").collect();
        let is_way = |name: &str| study.axis(name).is_some_and(|axis| study.axes[axis].role == Role::Variant);
        let ways = others.iter().copied().filter(|name| is_way(name)).collect();
        Self { table, axes, others, ways }
    }

    fn column(&self, name: &str) -> Option<usize> {
        self.table.columns.iter().position(|column| column == name)
    }

    /// The fields of a row under these columns, to be compared.
    fn texts(&self, row: &[Cell], columns: &[&str]) -> Vec<String> {
        columns.iter().filter_map(|name| self.column(name)).map(|column| format!("{:?}", row[column])).collect()
    }

    fn distinct(&self, column: &str) -> usize {
        self.table.rows.iter().map(|row| self.texts(row, &[column])).collect::<BTreeSet<_>>().len()
    }

    /// Columns whose values are all numbers or left out.
    fn numbers(&self) -> impl Iterator<Item = &'t str> {
        let table = self.table;
        let is_number = |cell: &Cell| match cell {
            Cell::Text(text) => text.parse::<f64>().is_ok(),
            Cell::Number(_) | Cell::Integer(_) | Cell::Missing => true,
        };
        let fits = move |column: usize| {
            table.rows.iter().all(|row| is_number(&row[column]))
                && table.rows.iter().any(|row| !matches!(row[column], Cell::Missing))
        };
        table.columns.iter().enumerate().filter(move |(i, _)| fits(*i)).map(|(_, name)| name.as_str())
    }

    /// Alpha as a channel; null where the cases do not differ in it.
    fn alpha(&self, channel: Value) -> Value {
        match self.axes.contains(&"alpha") {
            true => with(json!({ "field": "alpha", "type": "ordinal", "title": "alpha" }), channel),
            false => Value::Null,
        }
    }

    /// Every case axis and point set, so that no line goes through two cases.
    fn detail(&self) -> Vec<Value> {
        let sets = self.column("point_set").map(|_| nominal("point_set"));
        self.axes.iter().map(|name| nominal(name)).chain(sets).collect()
    }

    fn convergence(&self) -> Value {
        json!({
            "title": "Error over the sample count",
            "transform": case_of(&self.others),
            "mark": { "type": "line", "point": true },
            "encoding": { "x": log("samples", "samples a pixel"), "y": log(HEADLINE, ERROR), "color": self.alpha(ramp()),
                "strokeDash": nominal("method"), "detail": self.detail(), "facet": small_charts(&self.others) }
        })
    }

    /// One map for each combination of the case axes that are neither alpha nor the first one, which goes to the right.
    fn break_even(&self) -> Value {
        let (first, rest) = (self.others.first(), &self.others[self.others.len().min(1)..]);
        // A step needs an axis to go along.
        let step = |is_axis: bool, step: u32| if is_axis { json!({ "step": step }) } else { Value::Null };
        json!({
            "title": "Break-even: samples from which on every larger count errs less, too",
            "transform": joined(count_words(), case_of(rest)),
            "mark": "rect", "width": step(first.is_some(), 36), "height": step(self.axes.contains(&"alpha"), 20),
            "encoding": { "y": self.alpha(json!({})), "x": first.map_or(Value::Null, |name| untitled(nominal(name))),
                "color": counts(), "facet": small_charts(rest) }
        })
    }

    fn break_even_by_n_dot_v(&self) -> Value {
        json!({
            "title": "Break-even by n·v: samples from which on every larger count errs less, too",
            "transform": joined(count_words(), case_of(&self.others)),
            "mark": "rect",
            "encoding": { "x": n_dot_v_bins(), "y": self.alpha(json!({})), "color": counts(), "facet": small_charts(&self.others) }
        })
    }

    fn error_map(&self) -> Value {
        json!({
            "title": "Error by n·v and alpha",
            "transform": [way(&[]), numbered()],
            "mark": "rect",
            "encoding": { "x": n_dot_v_bins(), "y": { "field": "alpha", "type": "ordinal", "title": "alpha" },
                "color": { "field": HEADLINE, "type": "quantitative", "title": ERROR, "legend": { "format": ".1e" },
                    "scale": { "type": "log", "scheme": "magma", "reverse": true } },
                "facet": with(small(WAY), json!({ "columns": ACROSS })) }
        })
    }

    /// A row of charts for each scene; a line for each way to make its image.
    fn profile(&self) -> Value {
        let scenes: Vec<&str> = self.others.iter().copied().filter(|name| !self.ways.contains(name)).collect();
        let ways: BTreeSet<Vec<String>> = self.table.rows.iter().map(|row| self.texts(row, &self.ways)).collect();
        let scheme = if ways.len() > 1 { json!({ "scale": { "scheme": "turbo" } }) } else { json!({}) };
        json!({
            "title": "Error over n·v",
            "transform": joined(case_of(&scenes), json!([way(&self.ways), bin_middle()])),
            "width": 200, "height": 150,
            "mark": { "type": "line", "point": true },
            "encoding": { "x": { "field": N_DOT_V, "type": "quantitative", "title": "n·v" }, "y": log(HEADLINE, ERROR),
                "color": with(in_order(WAY), scheme), "detail": self.detail(),
                "row": if scenes.is_empty() { Value::Null } else { small(CASE) },
                "column": self.alpha(alpha_header()) }
        })
    }

    /// What leaves over what arrives in a white furnace, with a line at all of it.
    fn energy(&self) -> Value {
        let methods = (self.distinct("method") > 1).then_some("method");
        let facets: Vec<&str> = self.others.iter().copied().chain(methods).collect();
        let line = json!({ "mark": { "type": "line", "point": true }, "encoding": {
            "x": { "field": N_DOT_V, "type": "quantitative", "title": "n·v", "scale": { "domain": [0, 1] } },
            "y": { "field": "albedo", "type": "quantitative", "title": "energy that leaves / arrives" },
            "color": self.alpha(ramp()) } });
        let all = json!({ "mark": { "type": "rule", "strokeDash": [4, 3] }, "encoding": { "y": { "datum": 1 } } });
        let layers = json!({ "width": 200, "height": 150, "layer": [all, line] });
        let title = "What is left of the light in a white furnace: above 1 energy is created";
        faceted(title, joined(case_of(&facets), json!([bin_middle()])), small_charts(&facets), layers)
    }

    /// The median over point sets with its quartiles, p05 to p95 of the frame, and a line through what nothing else is both faster and
    /// closer than.
    fn time_and_error(&self) -> Value {
        let steps = |op: &str, field: &str, name: &str| json!({ "op": op, "field": field, "as": name });
        let (time, ends) = ("frame_ms_median", ["frame_ms_p05", "frame_ms_p95"]);
        let groups: Vec<&str> = self.axes.iter().copied().chain(["method", "samples"]).collect();
        let transform = joined(
            json!([{
                "aggregate": [steps("median", HEADLINE, "error"), steps("q1", HEADLINE, "error_lo"), steps("q3", HEADLINE, "error_hi"),
                    steps("median", time, time), steps("median", ends[0], ends[0]), steps("median", ends[1], ends[1])],
                "groupby": groups,
            }]),
            json!([{ "calculate": "isValid(datum.samples) ? '' + datum.samples : ''", "as": "count" }]),
        );
        let transform = joined(transform, case_of(&self.others));
        // Shapes, too: one colour alone does not tell methods apart for everybody.
        let (color, shape) = (nominal("method"), with(nominal("method"), json!({ "legend": null })));
        let (x, y) = (|field: &str| log(field, "frame time, ms"), |field: &str| log(field, ERROR));
        let front = json!([
            { "window": [steps("min", "error", "least")], "sort": [{ "field": time }], "groupby": self.axes },
            { "filter": "datum.error <= datum.least" },
        ]);
        let layers = json!([
            { "mark": "rule", "encoding": { "x": x(ends[0]), "x2": { "field": ends[1] }, "y": y("error"), "color": color } },
            { "mark": "rule", "encoding": { "x": x(time), "y": y("error_lo"), "y2": { "field": "error_hi" }, "color": color } },
            { "transform": front, "mark": { "type": "line", "interpolate": "step-after", "strokeDash": [4, 3], "color": "#555" },
                "encoding": { "x": x(time), "y": y("error") } },
            { "mark": { "type": "point", "filled": true, "size": 60 },
                "encoding": { "x": x(time), "y": y("error"), "color": color, "shape": shape } },
            { "mark": { "type": "text", "dx": 7, "dy": -7, "align": "left" },
                "encoding": { "x": x(time), "y": y("error"), "text": { "field": "count", "type": "nominal" }, "color": color } },
        ]);
        let alpha = self.alpha(alpha_header());
        let facet = match self.others.is_empty() {
            true if alpha.is_null() => Value::Null,
            true => json!({ "column": alpha }),
            false if alpha.is_null() => small_charts(&self.others),
            false => json!({ "row": small(CASE), "column": alpha }),
        };
        faceted(
            "Error over frame time, by samples",
            transform,
            facet,
            json!({ "width": 220, "height": 160, "layer": layers }),
        )
    }

    /// A curve for an environment whose peaks were cut off several times; a point with its middle half for others, which differ in more than
    /// their range.
    fn dynamic_range(&self) -> Value {
        let clipped = self.distinct("environment_clip_log2") >= RANGES_MIN;
        let (lo, hi) = (format!("{HEADLINE}_lower_quartile"), format!("{HEADLINE}_upper_quartile"));
        let x = match clipped {
            true => json!({ "field": "dynamic_range_stops", "type": "quantitative", "title": "dynamic range, stops" }),
            false => json!({ "field": "environment", "type": "nominal", "title": "environment, by dynamic range",
                "sort": { "field": "dynamic_range_stops", "op": "min" } }),
        };
        let offset = if clipped { Value::Null } else { in_order("method") };
        let channels = |more: Value| with(json!({ "x": x, "xOffset": offset, "color": in_order("method") }), more);
        let mark =
            if clipped { json!({ "type": "line", "point": true }) } else { json!({ "type": "point", "filled": true }) };
        let layers = json!([
            { "mark": { "type": "rule", "opacity": 0.5 }, "encoding": channels(json!({ "y": log(&lo, ERROR), "y2": { "field": hi } })) },
            { "mark": mark, "encoding": channels(json!({ "y": log(HEADLINE, ERROR) })) },
        ]);
        let facet = if clipped { with(small("environment"), json!({ "columns": 2 })) } else { Value::Null };
        faceted(
            "Error over the dynamic range of the light: median and middle half",
            json!([numbered()]),
            facet,
            json!({ "layer": layers }),
        )
    }
}

/// A chart a method: how far the curve's setting shows its error.
fn visibility() -> Value {
    let lines = json!({ "mark": { "type": "line", "point": true }, "encoding": { "x": log("exposure", "exposure"),
        "y": { "field": DISPLAY_HEADLINE, "type": "quantitative", "title": "visible difference (FLIP)" },
        "color": with(json!({ "field": "contrast", "type": "ordinal" }), ramp()) } });
    let threshold = json!({ "mark": { "type": "rule", "strokeDash": [4, 4] }, "encoding": { "y": { "datum": exposure::VISIBLE_FROM } } });
    let facet = with(small("method"), json!({ "columns": ACROSS }));
    faceted(
        "Visible difference by exposure and contrast",
        json!([numbered()]),
        facet,
        json!({ "width": 220, "height": 160, "layer": [lines, threshold] }),
    )
}

/// A chart an axis: its values side by side, numbers by size, names as they were written.
fn effects() -> Value {
    const NUMBER: &str = "isFinite(toNumber(datum.label)) ? format(toNumber(datum.label), '.4~g') : datum.label";
    let transform = json!([
        { "filter": "!isValid(datum.alpha) || datum.alpha === ''" },
        numbered(),
        { "calculate": format!("isFinite(toNumber(datum.value)) ? toNumber(datum.value) : datum.{ROW}"), "as": "place" },
    ]);
    let x = json!({ "field": "value", "type": "nominal", "title": null, "sort": { "field": "place", "op": "min" },
        "axis": { "labelExpr": NUMBER, "labelAngle": -45 } });
    let channels = |more: Value| {
        with(
            json!({ "x": x, "xOffset": in_order("method"), "color": with(in_order("method"), json!({ "title": "method or samples" })) }),
            more,
        )
    };
    let layers = json!([
        { "mark": { "type": "rule", "strokeDash": [4, 3] }, "encoding": { "y": { "datum": 1 } } },
        { "transform": [{ "filter": "isFinite(datum.ratio_hi) && datum.ratio_hi > 0" }], "mark": { "type": "rule", "opacity": 0.5 },
            "encoding": channels(json!({ "y": log("ratio_lo", EFFECT), "y2": { "field": "ratio_hi" } })) },
        { "mark": { "type": "point", "filled": true }, "encoding": channels(json!({ "y": log("error_ratio", EFFECT) })) },
    ]);
    let facet = with(small("axis"), json!({ "columns": 2 }));
    let spec = faceted(
        "Error over that with the first value: mean over pairs of cells, 95 % interval",
        transform,
        facet,
        json!({ "width": 280, "height": 220, "layer": layers }),
    );
    with(spec, json!({ "resolve": { "scale": { "x": "independent", "y": "independent" } } }))
}

const EFFECT: &str = "relMSE ratio";

fn pass_times() -> Value {
    json!({
        "title": "Time by pass, ms in the median: each frame, and what is made once",
        "transform": [numbered()],
        "mark": "bar",
        "encoding": { "y": { "field": "configuration", "type": "nominal", "title": null, "sort": { "field": "median_ms", "op": "sum" } },
            "x": { "field": "median_ms", "type": "quantitative", "stack": "zero", "title": "ms" }, "color": in_order("pass"),
            "row": small("phase") },
        "resolve": { "scale": { "x": "independent", "y": "independent" } }
    })
}

/// A logarithmic axis that ends where its values do.
fn log(field: &str, title: &str) -> Value {
    json!({ "field": field, "type": "quantitative", "title": title, "scale": { "type": "log", "nice": false, "padding": 8 } })
}

fn nominal(field: &str) -> Value {
    json!({ "field": field, "type": "nominal" })
}

/// Values in the order of the table, as an experiment lists them.
fn in_order(field: &str) -> Value {
    with(nominal(field), json!({ "sort": null }))
}

/// Colours for ordered values.
fn ramp() -> Value {
    json!({ "scale": { "scheme": "viridis", "reverse": true } })
}

fn untitled(channel: Value) -> Value {
    with(channel, json!({ "title": null }))
}

/// Small charts that are named by their values alone, in the order of the table, for which its rows must be numbered: a facet sorts its values
/// whatever else it is told.
fn small(field: &str) -> Value {
    with(nominal(field), json!({ "header": { "title": null }, "sort": { "field": ROW, "op": "min" } }))
}

/// Columns by alpha, which a bare number does not say.
fn alpha_header() -> Value {
    json!({ "header": { "title": "alpha" } })
}

fn n_dot_v_bins() -> Value {
    json!({ "field": "n_dot_v_from", "type": "ordinal", "title": "n·v from" })
}

const COUNT: &str = "samples_needed";

/// A count that was never reached says so, and stands behind the same count that was.
fn count_words() -> Value {
    json!([
        { "calculate": "(datum.answer === 'never' ? 'more than ' : '') + datum.break_even", "as": COUNT },
        { "calculate": "datum.break_even + (datum.answer === 'never' ? 0.5 : 0)", "as": "place" },
    ])
}

fn counts() -> Value {
    json!({ "field": COUNT, "type": "ordinal", "title": "samples", "sort": { "field": "place", "op": "min" }, "scale": { "scheme": "viridis" } })
}

/// The field that names a combination of case axes.
const CASE: &str = "case";

/// Makes [`CASE`] of the axes; nothing where there are none.
fn case_of(axes: &[&str]) -> Value {
    if axes.is_empty() {
        return json!([]);
    }
    let words: Vec<String> = axes.iter().map(|name| format!("datum['{name}']")).collect();
    json!([{ "calculate": words.join(" + ' · ' + "), "as": CASE }, numbered()])
}

/// The field that counts rows.
const ROW: &str = "row";

fn numbered() -> Value {
    json!({ "window": [{ "op": "row_number", "as": ROW }] })
}

/// The field that names a method and its sample count.
const WAY: &str = "method_and_samples";

/// With the values of further axes, those that are set.
fn way(axes: &[&str]) -> Value {
    let samples = "datum.method + (isValid(datum.samples) ? ' ' + datum.samples : '')".to_owned();
    let more = axes.iter().map(|name| {
        format!("(isValid(datum['{name}']) && datum['{name}'] !== '' ? ' · {name} ' + datum['{name}'] : '')")
    });
    json!({ "calculate": std::iter::once(samples).chain(more).collect::<Vec<_>>().join(" + "), "as": WAY })
}

const N_DOT_V: &str = "n_dot_v";

/// The middle of a bin.
fn bin_middle() -> Value {
    json!({ "calculate": "(datum.n_dot_v_from + datum.n_dot_v_to) / 2", "as": N_DOT_V })
}

fn small_charts(axes: &[&str]) -> Value {
    if axes.is_empty() { Value::Null } else { with(small(CASE), json!({ "columns": ACROSS })) }
}

/// Layers in small charts, or alone where there is nothing to part them by. `columns` stands beside the facet here, not in it.
fn faceted(title: &str, transform: Value, mut facet: Value, layers: Value) -> Value {
    let columns = facet.as_object_mut().and_then(|facet| facet.remove("columns")).unwrap_or_default();
    let head = json!({ "title": title, "transform": transform });
    match facet {
        Value::Null => with(head, layers),
        facet => with(head, json!({ "facet": facet, "columns": columns, "spec": layers })),
    }
}

/// The members of both.
fn with(mut first: Value, second: Value) -> Value {
    if let (Some(first), Value::Object(second)) = (first.as_object_mut(), second) {
        first.extend(second);
    }
    first
}

/// The steps of both lists.
fn joined(mut first: Value, second: Value) -> Value {
    if let (Some(first), Value::Array(second)) = (first.as_array_mut(), second) {
        first.extend(second);
    }
    first
}

/// Channels that have nothing to show are left out, at any depth: `null` would remove what Vega-Lite adds by itself. Within a channel it is meant.
fn without_nulls(mut spec: Value) -> Value {
    if let Some(members) = spec.as_object_mut() {
        members.retain(|_, member| !member.is_null());
        if let Some(encoding) = members.get_mut("encoding").and_then(Value::as_object_mut) {
            encoding.retain(|_, channel| !channel.is_null());
        }
        if let Some(inner) = members.get_mut("spec") {
            *inner = without_nulls(inner.take());
        }
        for layer in members.get_mut("layer").and_then(Value::as_array_mut).into_iter().flatten() {
            *layer = without_nulls(layer.take());
        }
    }
    spec
}
