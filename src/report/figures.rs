//! The figures beside the report: for each a CSV of what is drawn and a Vega-Lite specification that draws it, for people who
//! want to restyle it or put it into a paper.

use super::analysis::Analysis;
use super::study::{HEADLINE, Study};
use crate::experiment::break_even::BreakEven;
use crate::table::csv::{Cell, TableError, TableWriter};
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

/// Writes `NAME.csv` and `NAME.vl.json` for every figure that the runs have data for. Returns the names.
pub fn write(folder: &Path, study: &Study, analysis: &Analysis) -> Result<Vec<String>, FigureError> {
    let io = |error| FigureError::Io { path: folder.to_owned(), error };
    std::fs::create_dir_all(folder).map_err(io)?;
    let figures = [convergence(analysis), break_even(analysis), by_n_dot_v(analysis), time_error(study)];
    let mut names = Vec::new();
    for figure in figures.into_iter().filter(|figure| !figure.rows.is_empty()) {
        let columns: Vec<&str> = figure.columns.iter().map(String::as_str).collect();
        let mut table = TableWriter::create(&folder.join(format!("{}.csv", figure.name)), &columns)?;
        figure.rows.iter().try_for_each(|row| table.append(row))?;
        let mut spec = json!({ "$schema": VEGA_LITE, "data": { "url": format!("{}.csv", figure.name) } });
        if let (Some(spec), Value::Object(own)) = (spec.as_object_mut(), figure.spec) {
            spec.extend(own);
        }
        let path = folder.join(format!("{}.vl.json", figure.name));
        std::fs::write(&path, format!("{spec:#}\n")).map_err(|error| FigureError::Io { path, error })?;
        names.push(figure.name.to_owned());
    }
    Ok(names)
}

struct Figure {
    name: &'static str,
    columns: Vec<String>,
    rows: Vec<Vec<Cell>>,
    spec: Value,
}

fn columns(analysis: &Analysis, own: &[&str]) -> Vec<String> {
    analysis.case_axes.iter().cloned().chain(own.iter().map(|name| name.to_string())).collect()
}

fn texts(key: &[String]) -> Vec<Cell> {
    key.iter().map(|value| Cell::from(value.as_str())).collect()
}

/// One small chart for each value of the first case axis that is not alpha.
fn facet(analysis: &Analysis) -> Value {
    match analysis.case_axes.iter().find(|name| *name != "alpha") {
        Some(name) => json!({ "field": name, "type": "nominal" }),
        None => Value::Null,
    }
}

fn log(field: &str) -> Value {
    json!({ "field": field, "type": "quantitative", "scale": { "type": "log" } })
}

/// The sample count, and whether it lies above the tried ones.
fn break_even_cells(result: BreakEven) -> [Cell; 2] {
    match result {
        BreakEven::From(n) => [Cell::Integer(u64::from(n)), Cell::from("no")],
        BreakEven::Above(n) => [Cell::Integer(u64::from(n)), Cell::from("yes")],
    }
}

fn convergence(analysis: &Analysis) -> Figure {
    let rows = analysis.curves.iter().flat_map(|curve| {
        curve.points.iter().map(|point| {
            let mut row = texts(&curve.key);
            row.extend([
                Cell::from(curve.method.as_str()),
                Cell::Integer(u64::from(point.samples)),
                point.error.into(),
            ]);
            row.push(curve.noise_floor.into());
            row
        })
    });
    Figure {
        name: "convergence",
        columns: columns(analysis, &["method", "samples", HEADLINE, "noise_floor"]),
        rows: rows.collect(),
        spec: json!({
            "mark": { "type": "line", "point": true },
            "encoding": { "x": log("samples"), "y": log(HEADLINE), "color": { "field": "alpha", "type": "ordinal" },
                "strokeDash": { "field": "method" }, "detail": analysis.case_axes.iter().map(|n| json!({ "field": n })).collect::<Vec<_>>(),
                "facet": facet(analysis) }
        }),
    }
}

fn break_even(analysis: &Analysis) -> Figure {
    let rows = analysis.pairs.iter().flat_map(|pair| {
        pair.cases.iter().map(|case| {
            let mut row = texts(&case.key);
            row.extend([Cell::from(pair.sampled.as_str()), Cell::from(pair.fixed.as_str()), case.fixed_error.into()]);
            row.extend(break_even_cells(case.break_even));
            row.push(case.crossing.into());
            row
        })
    });
    Figure {
        name: "break-even",
        columns: columns(analysis, &["sampled", "fixed", "fixed_error", "break_even", "is_above_tried", "crossing"]),
        rows: rows.collect(),
        spec: json!({
            "mark": "rect",
            "encoding": { "y": { "field": "alpha", "type": "ordinal" }, "x": facet(analysis),
                "color": { "field": "break_even", "type": "ordinal", "scale": { "scheme": "viridis" } } }
        }),
    }
}

fn by_n_dot_v(analysis: &Analysis) -> Figure {
    let rows = analysis.pairs.iter().flat_map(|pair| {
        pair.cases.iter().flat_map(|case| {
            case.bins.iter().map(|bin| {
                let mut row = texts(&case.key);
                row.extend([Cell::from(pair.sampled.as_str()), Cell::from(pair.fixed.as_str())]);
                row.extend([bin.lo.into(), bin.hi.into(), bin.fixed_error.into()]);
                row.extend(break_even_cells(bin.break_even));
                row
            })
        })
    });
    let own = ["sampled", "fixed", "n_dot_v_from", "n_dot_v_to", "fixed_error", "break_even", "is_above_tried"];
    Figure {
        name: "break-even-n-dot-v",
        columns: columns(analysis, &own),
        rows: rows.collect(),
        spec: json!({
            "mark": "rect",
            "encoding": { "x": { "field": "n_dot_v_from", "type": "ordinal" }, "y": { "field": "alpha", "type": "ordinal" },
                "color": { "field": "break_even", "type": "ordinal", "scale": { "scheme": "viridis" } }, "facet": facet(analysis) }
        }),
    }
}

fn time_error(study: &Study) -> Figure {
    let axes: Vec<usize> = study.case_axes();
    let names = axes.iter().map(|&axis| study.axes[axis].name.clone());
    let own = ["method", "samples", HEADLINE, "frame_ms_median", "frame_ms_p05", "frame_ms_p95"];
    let rows = study.rows.iter().filter_map(|row| {
        let (error, time) = (row.error?, row.frame_ms?);
        let mut cells: Vec<Cell> = axes.iter().map(|&axis| Cell::from(row.axes[axis].as_str())).collect();
        cells.extend(["method", "samples"].map(|name| Cell::from(study.value(row, name))));
        cells.extend([error, time.median, time.p05, time.p95].map(Cell::Number));
        Some(cells)
    });
    Figure {
        name: "time-error",
        columns: names.chain(own.map(str::to_owned)).collect(),
        rows: rows.collect(),
        spec: json!({
            "mark": "point",
            "encoding": { "x": log("frame_ms_median"), "y": log(HEADLINE), "color": { "field": "method" },
                "size": { "field": "samples", "type": "ordinal" } }
        }),
    }
}
