//! The figures beside the report: for each a CSV of what is drawn and a Vega-Lite specification that draws it, for people who
//! want to restyle it or put it into a paper. The tables are those of `experiment::answers`.

use crate::experiment::answers::run_folder::RunFolder;
use crate::experiment::answers::tables::{AnswerTable, of_figures};
use crate::experiment::answers::{Answers, exposure};
use crate::experiment::tables::{DISPLAY_HEADLINE, HEADLINE};
use crate::experiment::timing::TimingRecord;
use crate::report::joined::Alone;
use crate::table::csv::{TableError, TableWriter};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Why figures could not be written.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    #[error(transparent)]
    Table(#[from] TableError),
    #[error("{}: {error}", path.display())]
    Io { path: PathBuf, error: std::io::Error },
}

/// The schema of the specifications; an identifier, never fetched by this program.
const VEGA_LITE: &str = "https://vega.github.io/schema/vega-lite/v6.json";

/// Writes `NAME.csv` and `NAME.vl.json` for every figure that the runs have data for. Returns the names, which hold the folder of the run where
/// there are several: no figure joins runs.
pub fn write(folder: &Path, each: &[Alone], runs: &[RunFolder]) -> Result<Vec<String>, FigureError> {
    let mut names = Vec::new();
    for (i, (alone, run)) in each.iter().zip(runs).enumerate() {
        let own = if runs.len() > 1 { format!("run-{}", i + 1) } else { String::new() };
        let written = write_run(&folder.join(&own), alone, &run.timings)?;
        names.extend(written.into_iter().map(|name| if own.is_empty() { name } else { format!("{own}/{name}") }));
    }
    Ok(names)
}

fn write_run(folder: &Path, alone: &Alone, timings: &[TimingRecord]) -> Result<Vec<String>, FigureError> {
    let io = |error| FigureError::Io { path: folder.to_owned(), error };
    std::fs::create_dir_all(folder).map_err(io)?;
    let mut names = Vec::new();
    for table in &of_figures(&alone.study, &alone.answers, timings) {
        let Some(own) = spec(table, &alone.answers) else { continue };
        let columns: Vec<&str> = table.columns.iter().map(String::as_str).collect();
        let mut writer = TableWriter::create(&folder.join(format!("{}.csv", table.name)), &columns)?;
        table.rows.iter().try_for_each(|row| writer.append(row))?;
        let mut spec = json!({ "$schema": VEGA_LITE, "data": { "url": format!("{}.csv", table.name) } });
        if let (Some(spec), Value::Object(own)) = (spec.as_object_mut(), own) {
            spec.extend(own);
        }
        let path = folder.join(format!("{}.vl.json", table.name));
        std::fs::write(&path, format!("{spec:#}\n")).map_err(|error| FigureError::Io { path, error })?;
        names.push(table.name.to_owned());
    }
    Ok(names)
}

fn log(field: &str) -> Value {
    json!({ "field": field, "type": "quantitative", "scale": { "type": "log" } })
}

fn nominal(field: &str) -> Value {
    json!({ "field": field, "type": "nominal" })
}

/// How a table is drawn; `None` for one that has no figure of its own.
fn spec(table: &AnswerTable, answers: &Answers) -> Option<Value> {
    let has = |name: &str| table.columns.iter().any(|column| column == name);
    // One small chart for each combination of the case axes that are not alpha: no two cases may lie on each other.
    let axes: Vec<&str> = answers.case_axes.iter().map(String::as_str).filter(|name| *name != "alpha").collect();
    let facet = small_charts(&axes);
    let alpha = if has("alpha") { json!({ "field": "alpha", "type": "ordinal" }) } else { Value::Null };
    let detail: Vec<Value> = answers.case_axes.iter().map(|name| nominal(name)).collect();
    let with_sets: Vec<Value> = detail.iter().cloned().chain(has("point_set").then(|| nominal("point_set"))).collect();
    let counts = json!({ "field": "break_even", "type": "ordinal", "scale": { "scheme": "viridis" } });
    let n_dot_v = json!({ "field": "n_dot_v_from", "type": "ordinal" });
    Some(without_nulls(match table.name {
        "convergence" => json!({
            "mark": { "type": "line", "point": true },
            "transform": case_of(&axes),
            "encoding": { "x": log("samples"), "y": log(HEADLINE), "color": alpha, "strokeDash": nominal("method"),
                "detail": detail, "facet": facet }
        }),
        "break_even" => json!({
            "mark": "rect",
            "transform": case_of(&axes[axes.len().min(1)..]),
            "encoding": { "y": alpha, "x": axes.first().map_or(Value::Null, |name| nominal(name)), "color": counts,
                "facet": small_charts(&axes[axes.len().min(1)..]) }
        }),
        "break_even_by_n_dot_v" => json!({
            "mark": "rect",
            "transform": case_of(&axes),
            "encoding": { "x": n_dot_v, "y": alpha, "color": counts, "facet": facet }
        }),
        "error_by_n_dot_v_and_alpha" => json!({
            "mark": "rect",
            "transform": [{ "calculate": "datum.method + ' ' + (datum.samples || '')", "as": "method_and_samples" }],
            "encoding": { "x": n_dot_v, "y": alpha,
                "color": { "field": HEADLINE, "type": "quantitative", "scale": { "type": "log", "scheme": "magma", "reverse": true } },
                "facet": { "field": "method_and_samples", "type": "nominal", "columns": 3 } }
        }),
        "n_dot_v_profile" => json!({
            "mark": { "type": "line", "point": true },
            "transform": joined(case_of(&axes), json!([{ "calculate": "(+datum.n_dot_v_from + +datum.n_dot_v_to) / 2", "as": "n_dot_v" }])),
            "encoding": { "x": { "field": "n_dot_v", "type": "quantitative" }, "y": log(HEADLINE), "color": nominal("method"),
                "strokeDash": { "field": "samples", "type": "ordinal" }, "detail": with_sets,
                "row": if axes.is_empty() { Value::Null } else { nominal(CASE) }, "column": alpha }
        }),
        "time_and_error" => time_and_error(&answers.case_axes),
        "exposure_and_contrast" => json!({
            "layer": [
                { "mark": { "type": "line", "point": true },
                    "encoding": { "x": log("exposure"), "y": { "field": DISPLAY_HEADLINE, "type": "quantitative" },
                        "color": nominal("method"), "strokeDash": { "field": "contrast", "type": "ordinal" } } },
                { "mark": { "type": "rule", "strokeDash": [4, 4] }, "encoding": { "y": { "datum": exposure::VISIBLE_FROM } } }
            ]
        }),
        "dynamic_range" => json!({
            "mark": { "type": "line", "point": true },
            "encoding": { "x": { "field": "dynamic_range_stops", "type": "quantitative" }, "y": log(HEADLINE),
                "color": nominal("method"), "facet": { "field": "environment", "type": "nominal", "columns": 2 } }
        }),
        "effects" => json!({
            "mark": { "type": "point", "filled": true },
            "transform": [{ "filter": "datum.alpha == null || datum.alpha === ''" }],
            "encoding": { "x": nominal("value"), "y": log("error_ratio"), "color": nominal("method"), "facet": nominal("axis") }
        }),
        "pass_times" => json!({
            "mark": "bar",
            "encoding": { "y": { "field": "configuration", "type": "nominal", "sort": null },
                "x": { "field": "median_ms", "type": "quantitative", "stack": "zero" }, "color": nominal("pass"),
                "row": nominal("phase") },
            "resolve": { "scale": { "x": "independent", "y": "independent" } }
        }),
        _ => return None,
    }))
}

/// The field that names a combination of case axes.
const CASE: &str = "case";

/// Makes [`CASE`] of the axes; nothing where there are none.
fn case_of(axes: &[&str]) -> Value {
    if axes.is_empty() {
        return json!([]);
    }
    let words: Vec<String> = axes.iter().map(|name| format!("datum['{name}']")).collect();
    json!([{ "calculate": words.join(" + ' · ' + "), "as": CASE }])
}

fn small_charts(axes: &[&str]) -> Value {
    if axes.is_empty() { Value::Null } else { json!({ "field": CASE, "type": "nominal", "columns": 3 }) }
}

/// The steps of both lists.
fn joined(mut first: Value, second: Value) -> Value {
    if let (Some(first), Value::Array(second)) = (first.as_array_mut(), second) {
        first.extend(second);
    }
    first
}

/// The median over point sets with its quartiles, p05 to p95 of the frame, and a line through what nothing else is both faster and closer than.
fn time_and_error(case_axes: &[String]) -> Value {
    let axes: Vec<&str> = case_axes.iter().map(String::as_str).collect();
    let steps = |op: &str, field: &str, name: &str| json!({ "op": op, "field": field, "as": name });
    let (time, ends) = ("frame_ms_median", ["frame_ms_p05", "frame_ms_p95"]);
    let groups: Vec<&str> = axes.iter().copied().chain(["method", "samples"]).collect();
    let transform = joined(
        json!([{
            "aggregate": [steps("median", HEADLINE, "error"), steps("q1", HEADLINE, "error_lo"), steps("q3", HEADLINE, "error_hi"),
                steps("median", time, time), steps("median", ends[0], ends[0]), steps("median", ends[1], ends[1])],
            "groupby": groups,
        }]),
        case_of(&axes),
    );
    let color = nominal("method");
    let front = json!([
        { "window": [steps("min", "error", "least")], "sort": [{ "field": time }],
            "groupby": if axes.is_empty() { json!([]) } else { json!([CASE]) } },
        { "filter": "datum.error <= datum.least" },
    ]);
    let layers = json!([
        { "mark": "rule", "encoding": { "x": log(ends[0]), "x2": { "field": ends[1] }, "y": log("error"), "color": color } },
        { "mark": "rule", "encoding": { "x": log(time), "y": log("error_lo"), "y2": { "field": "error_hi" }, "color": color } },
        { "mark": { "type": "point", "filled": true },
            "encoding": { "x": log(time), "y": log("error"), "color": color, "size": { "field": "samples", "type": "ordinal" } } },
        { "transform": front, "mark": { "type": "line", "interpolate": "step-after", "strokeDash": [4, 3], "color": "#555" },
            "encoding": { "x": log(time), "y": log("error") } },
    ]);
    match small_charts(&axes) {
        Value::Null => json!({ "transform": transform, "layer": layers }),
        _ => json!({ "transform": transform, "facet": nominal(CASE), "columns": 3, "spec": { "layer": layers } }),
    }
}

/// Channels that have nothing to show are left out: `null` would remove what Vega-Lite adds by itself.
fn without_nulls(mut spec: Value) -> Value {
    if let Some(encoding) = spec.get_mut("encoding").and_then(Value::as_object_mut) {
        encoding.retain(|_, channel| !channel.is_null());
    }
    spec
}
