//! The report of finished runs: one HTML file that opens from disk and asks for nothing else.
//!
//! What the rows say is computed by `experiment::answers`, as for the tables of a run. [`images`] chooses what of the linear images fits,
//! [`live`] what the live view needs, [`page`] writes the file and [`figures`] the data and specifications beside it. The page draws; it
//! decides nothing that is not shown.

pub mod exclusions;
mod figures;
pub mod images;
pub mod live;
pub mod page;

use crate::experiment::answers::run_folder::{RunFolder, RunFolderError};
use crate::experiment::answers::study::{Row, Study};
use crate::experiment::answers::{Answers, words};
use crate::experiment::tables::HEADLINE;
use crate::pixels::{PixelsError, write_atomically};
use crate::table::colormap::{NAN_COLOR, OFF_MASK_COLOR, Palette, RELATIVE_ERROR, Range, SIGNED_ERROR};
use images::{Choice, ImageSet};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};

/// How a report is to be made.
#[derive(Clone, Debug)]
pub struct ReportOptions {
    /// Folders of finished runs; several are joined.
    pub dirs: Vec<PathBuf>,
    /// The file; `report.html` in the first folder when left out.
    pub out: Option<PathBuf>,
    pub images: Choice,
    /// Bytes that the page may take.
    pub budget: usize,
}

impl ReportOptions {
    /// The report of one run, in its folder.
    pub fn of_run(dir: &Path) -> Self {
        Self { dirs: vec![dir.to_owned()], out: None, images: Choice::Automatic, budget: images::BUDGET_BYTES }
    }
}

/// A written report.
#[derive(Debug)]
pub struct Written {
    pub path: PathBuf,
    pub bytes: usize,
    /// What was left out, one sentence each.
    pub notes: Vec<String>,
}

/// About what the page's model says of a row and its image, bytes.
const ROW_BYTES: usize = 400;
/// About what the page's template, styles, modules and shaders take, bytes.
const PROGRAM_BYTES: usize = 500_000;

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    #[error(transparent)]
    Run(#[from] RunFolderError),
    #[error(transparent)]
    Figures(#[from] figures::FigureError),
    #[error(transparent)]
    Crop(#[from] images::CropError),
    #[error("the page's template: {0}")]
    Template(#[from] minijinja::Error),
    #[error(transparent)]
    Write(#[from] PixelsError),
}

/// Writes the report, and `NAME-figures/` beside it.
pub fn write(options: &ReportOptions) -> Result<Written, ReportError> {
    let runs: Vec<RunFolder> = options.dirs.iter().map(|dir| RunFolder::read(dir)).collect::<Result<_, _>>()?;
    let path = options.out.clone().unwrap_or_else(|| options.dirs[0].join("report.html"));
    let labels = labels(&runs);
    let study = Study::new(&runs, &labels);
    let distinct = study.distinct();
    let answers = Answers::new(&distinct, &runs);
    let answer = words::answer(&distinct, &answers);
    let light = live::Light::collect(&runs, live::BUDGET_BYTES);
    let tables: usize = runs.iter().flat_map(|run| &run.csv).map(|(_, text)| text.len()).sum();
    let others = tables + json_bytes(&light) + json_bytes(&answers) + study.rows.len() * ROW_BYTES + PROGRAM_BYTES;
    let images = images::collect(&runs, options.images, options.budget.saturating_sub(others))?;
    let figures = figures::write(&figures_folder(&path), &distinct, &answers, &runs)?;
    let fixed = page::Static {
        name: runs[0].text("/name"),
        question: runs[0].text("/question"),
        number: answer.number.clone(),
        unit: answer.unit.clone(),
        sentence: answer.sentence.clone(),
        facts: answer.facts.clone(),
        warnings: warnings(&runs),
        devices: runs.iter().map(device_line).collect(),
    };
    let here = path.parent().unwrap_or(Path::new(""));
    let model = json!({
        "headline": HEADLINE,
        "runs": runs.iter().zip(&labels).map(|(run, label)| run_model(run, label, here)).collect::<Vec<_>>(),
        "differences": differences(&runs),
        "axes": study.axes,
        "metrics": runs[0].provenance["metrics"],
        "cells": cells(&study, &runs, &images),
        "analysis": answers,
        "exclusions": exclusions::collect(&runs, &labels, &study),
        "images": images.images,
        "image_notes": images.notes,
        "figures": figures.iter().map(|name| format!("{}/{name}", figures_name(&path))).collect::<Vec<_>>(),
        "colors": colors(),
    });
    let tables: Vec<(String, &str)> = runs
        .iter()
        .enumerate()
        .flat_map(|(i, run)| run.csv.iter().map(move |(name, text)| (format!("csv-{i}-{name}"), text.as_str())))
        .collect();
    let html = page::render(&fixed, &model, &tables, &images, &light)?;
    write_atomically(&path, |writer| writer.write_all(html.as_bytes()))?;
    let notes = runs.iter().filter_map(RunFolder::under_way_note).chain(images.notes).collect();
    Ok(Written { path, bytes: html.len(), notes })
}

/// Bytes of a value in the page.
fn json_bytes(value: &impl serde::Serialize) -> usize {
    serde_json::to_vec(value).map_or(0, |text| text.len())
}

fn figures_name(path: &Path) -> String {
    let stem = path.file_stem().map_or_else(|| "report".into(), |stem| stem.to_string_lossy());
    format!("{stem}-figures")
}

fn figures_folder(path: &Path) -> PathBuf {
    path.with_file_name(figures_name(path))
}

/// Short names of joined runs: the folders' names, numbered where two are equal.
fn labels(runs: &[RunFolder]) -> Vec<String> {
    let name = |run: &RunFolder| {
        let path = std::fs::canonicalize(&run.dir).unwrap_or_else(|_| run.dir.clone());
        path.file_name().map_or_else(|| run.text("/name"), |name| name.to_string_lossy().into_owned())
    };
    let names: Vec<String> = runs.iter().map(name).collect();
    let is_double = |name: &String| names.iter().filter(|other| *other == name).count() > 1;
    names
        .iter()
        .enumerate()
        .map(|(i, name)| if is_double(name) { format!("{name} #{}", i + 1) } else { name.clone() })
        .collect()
}

fn device_line(run: &RunFolder) -> String {
    let session = run.last_session();
    let text = |name: &str| run.text(&format!("{session}{name}"));
    format!("{} · {} · {}", text("/device/name"), text("/device/driver"), text("/date_utc"))
}

/// What a reader must know before believing a number.
fn warnings(runs: &[RunFolder]) -> Vec<String> {
    let mut warnings = Vec::new();
    if runs.iter().any(RunFolder::is_cpu_timed) {
        warnings.push(
            "The times come from a CPU driver: they say nothing about a GPU. The errors do not depend on the device's speed."
                .to_owned(),
        );
    }
    let failed: usize = runs.iter().map(|run| run.failures.len()).sum();
    if failed > 0 {
        warnings.push(format!("{failed} cells failed and are missing from every figure; the Run page lists them."));
    }
    for run in runs {
        let (done, planned) = (run.errors.rows.len(), run.provenance["cell_count"].as_u64().unwrap_or(0));
        if (done as u64) < planned {
            let state = if run.is_under_way { "is under way" } else { "was stopped" };
            warnings.push(format!("{done} of {planned} cells of {} are done: the run {state}.", run.text("/name")));
        }
    }
    warnings
}

/// What tells joined runs apart, by provenance: [what, value of each run].
fn differences(runs: &[RunFolder]) -> Vec<Value> {
    let session = |name: &str| runs.iter().map(|run| run.text(&format!("{}{name}", run.last_session()))).collect();
    let whole = |pointer: &str| runs.iter().map(|run| run.text(pointer)).collect();
    let facts: [(&str, Vec<String>); 9] = [
        ("device", session("/device/name")),
        ("driver", session("/device/driver")),
        ("commit", session("/commit/hash")),
        ("date", session("/date_utc")),
        ("host", session("/host/cpu")),
        ("experiment", whole("/experiment_hash")),
        ("overrides", whole("/overrides")),
        ("shaders", whole("/shader_hash")),
        ("inputs", whole("/inputs")),
    ];
    let differs = |values: &Vec<String>| values.iter().collect::<BTreeSet<_>>().len() > 1;
    facts.iter().filter(|(_, values)| differs(values)).map(|(name, values)| json!([name, values])).collect()
}

fn run_model(run: &RunFolder, label: &str, here: &Path) -> Value {
    let excluded = match &run.provenance["excluded"] {
        Value::Array(excluded) => Value::Array(excluded.clone()),
        _ => json!([]),
    };
    json!({
        "label": label,
        "device": device_line(run),
        "link": relative(here, &run.dir),
        "provenance": run.provenance,
        "experiment": run.experiment,
        "failures": run.failures,
        "excluded": excluded,
        "timings": run.timings.iter().map(|record| json!({
            "phase": record.phase,
            "axes": record.axes,
            "size": record.size,
            "environment_size": record.environment_size,
            "device_type": record.device_type,
            "wall_check": record.wall_check(),
            "passes": record.passes.iter()
                .map(|pass| json!([pass.pass, crate::experiment::timing::summarize(&pass.ms).median])).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
    })
}

/// Images and times by run and cell.
fn cells(study: &Study, runs: &[RunFolder], images: &ImageSet) -> Value {
    let entry = |row: &Row| {
        let files = runs[row.run].images.get(&row.cell);
        let index = |file: &str| images.index.get(&(row.run, file.to_owned())).copied();
        json!({
            "run": row.run,
            "cell": row.cell,
            "image": files.and_then(|files| index(&files.radiance)),
            "reference": files.and_then(|files| index(&files.reference)),
            "frame_ms": row.frame_ms,
        })
    };
    study.rows.iter().map(entry).collect()
}

/// The palettes and ranges of the project's error maps, so that the page has no colours of its own.
fn colors() -> Value {
    let table = |palette: Palette| (0..256).map(|i| palette.color(f64::from(i) / 255.0)).collect::<Vec<_>>();
    let range = |range: Range| match range {
        Range::Linear { lo, hi } | Range::Log { lo, hi } => [lo, hi],
    };
    json!({
        "magma": table(Palette::Magma),
        "blue_red": table(Palette::BlueRed),
        "relative": range(RELATIVE_ERROR.range),
        "signed": range(SIGNED_ERROR.range),
        "relative_ticks": RELATIVE_ERROR.ticks(),
        "signed_ticks": SIGNED_ERROR.ticks(),
        "nan": NAN_COLOR,
        "off_mask": OFF_MASK_COLOR,
    })
}

/// `to` as a link from `from`: relative where they share a root, with `/` and percent-escapes.
fn relative(from: &Path, to: &Path) -> String {
    let whole = |path: &Path| {
        std::fs::canonicalize(if path.as_os_str().is_empty() { Path::new(".") } else { path })
            .unwrap_or_else(|_| path.to_owned())
    };
    let (from, to) = (whole(from), whole(to));
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().count() - shared;
    let down = to.components().skip(shared).map(|part| escape(&part.as_os_str().to_string_lossy()));
    let parts: Vec<String> = std::iter::repeat_n("..".to_owned(), up).chain(down).collect();
    if parts.is_empty() { ".".to_owned() } else { parts.join("/") }
}

/// Percent-escapes what has a meaning in an address.
fn escape(text: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte);
    text.bytes().map(|byte| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") }).collect()
}
