//! The report of finished runs: one HTML file that opens from disk and asks for nothing else.
//!
//! What the rows say is computed by `study::answers`, as for the tables of a run. [`images`] chooses what of the linear images fits,
//! [`live`] what the live view needs, [`page`] writes the file, [`figures`] the data beside it and `specs` how to draw them. The page draws; it
//! decides nothing that is not shown.

pub mod exclusions;
mod figures;
pub mod images;
pub mod joined;
pub mod lead;
pub mod live;
pub mod page;
mod specs;
mod times;

use crate::pixels::{PixelsError, write_atomically};
use crate::runner::tables::HEADLINE;
use crate::study::answers::exposure::VISIBLE_FROM;
use crate::study::answers::run_folder::{RunFolder, RunFolderError};
use crate::study::answers::study::{Row, Study, StudyAxis, preset};
use crate::study::summary::SHEETS_FOLDER;
use crate::table::colormap::{NAN_COLOR, OFF_MASK_COLOR, Palette, RELATIVE_ERROR, Range, SIGNED_ERROR};
use images::{Choice, ImageSet};
use joined::Alone;
use serde_json::{Value, json};
use std::io::{Read, Write};
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
    #[error("--out {}: is a folder; expected the file to write, such as {}", path.display(), path.join("report.html").display())]
    OutIsFolder { path: PathBuf },
    #[error(
        "--out {}: exists and is no report of splitsum; expected a new file, or a report to write anew",
        path.display()
    )]
    NotAReport { path: PathBuf },
    #[error("the page's template: {0}")]
    Template(#[from] minijinja::Error),
    #[error(transparent)]
    Write(#[from] PixelsError),
}

/// Writes the report, and `NAME-figures/` beside it.
pub fn write(options: &ReportOptions) -> Result<Written, ReportError> {
    if let Some(path) = options.out.as_ref().filter(|path| path.is_dir()) {
        return Err(ReportError::OutIsFolder { path: path.clone() });
    }
    if let Some(path) = options.out.as_ref().filter(|path| path.exists() && !is_report(path)) {
        return Err(ReportError::NotAReport { path: path.clone() });
    }
    let runs: Vec<RunFolder> = options.dirs.iter().map(|dir| RunFolder::read(dir)).collect::<Result<_, _>>()?;
    let path = options.out.clone().unwrap_or_else(|| options.dirs[0].join("report.html"));
    let labels = labels(&runs);
    let study = Study::new(&runs, &labels);
    let each = joined::each(&runs, &labels);
    let analysis = joined::analysis(&study, &each, &runs, &labels);
    let light = live::Light::collect(&runs, live::BUDGET_BYTES);
    let tables: usize = runs.iter().flat_map(|run| &run.csv).map(|(_, text)| text.len()).sum();
    let others = tables + json_bytes(&light) + json_bytes(&analysis) + study.rows.len() * ROW_BYTES + PROGRAM_BYTES;
    let images = images::collect(&runs, options.images, options.budget.saturating_sub(others))?;
    let figures = figures::write(&figures_folder(&path), &each, &runs)?;
    let fixed = page::Static {
        name: runs[0].text("/name"),
        question: runs[0].text("/question"),
        heading: joined::heading(&runs),
        runs: runs.iter().zip(&labels).zip(&each).map(|((run, label), alone)| told(run, label, alone)).collect(),
        facts: joined::facts(&runs),
        repeats: joined::repeats(&runs, &labels),
    };
    let here = path.parent().unwrap_or(Path::new(""));
    let described = runs.iter().zip(&labels).zip(&each);
    let model = json!({
        "headline": HEADLINE,
        "runs": described.map(|((run, label), alone)| run_model(run, label, alone, here)).collect::<Vec<_>>(),
        "facts": fixed.facts,
        "axes": study.axes,
        "presets": presets(&study),
        "metrics": runs[0].provenance["metrics"],
        "cells": cells(&study, &runs, &images),
        "analysis": analysis,
        "exclusions": exclusions::collect(&runs, &labels, &study),
        "images": images.images,
        "image_notes": images.notes,
        "figures": figures.iter().map(|name| format!("{}/{name}", figures_name(&path))).collect::<Vec<_>>(),
        "program_version": env!("CARGO_PKG_VERSION"),
        "visible_from": VISIBLE_FROM,
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

/// What the head of every report holds.
const MARK: &str = " · splitsum</title>";
/// The mark stands within this many bytes: the name of the run is all that comes before it and has no fixed length.
const HEAD_BYTES: u64 = 1 << 14;

/// Whether a file is a page that this program wrote, so that it may be written anew.
fn is_report(path: &Path) -> bool {
    let mut head = Vec::new();
    let file = std::fs::File::open(path).ok().filter(|_| path.is_file());
    let is_read = file.is_some_and(|file| file.take(HEAD_BYTES).read_to_end(&mut head).is_ok());
    let head = String::from_utf8_lossy(&head);
    is_read && head.starts_with("<!doctype html>") && head.contains(MARK)
}

fn told(run: &RunFolder, label: &str, alone: &Alone) -> page::Told {
    page::Told {
        label: label.to_owned(),
        question: run.text("/question"),
        answer: alone.answer.clone(),
        warnings: joined::outdated(run, &alone.answer).into_iter().chain(joined::warnings(run)).collect(),
        is_cpu: joined::cpu_warning(run).is_some(),
        device: device_line(run),
        date: date_line(&run.text(&format!("{}/date_utc", run.last_session()))),
    }
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
    format!("{} · {}", text("/device/name"), text("/device/driver"))
}

/// `2026-11-21 18:07 UTC` of `2026-11-21T18:07:34Z`; another text as it is.
fn date_line(date: &str) -> String {
    let parts = date.split_once('T').and_then(|(day, time)| Some((day, time.strip_suffix('Z')?.get(..5)?)));
    parts.map_or_else(|| date.to_owned(), |(day, time)| format!("{day} {time} UTC"))
}

fn run_model(run: &RunFolder, label: &str, alone: &Alone, here: &Path) -> Value {
    let excluded = match &run.provenance["excluded"] {
        Value::Array(excluded) => Value::Array(excluded.clone()),
        _ => json!([]),
    };
    let link = relative(here, &run.dir);
    json!({
        "label": label,
        "outdated": joined::outdated(run, &alone.answer),
        "device": device_line(run),
        "sheets": sheets(&run.dir).iter().map(|name| json!([name, format!("{link}/{SHEETS_FOLDER}/{}", escape(name))])).collect::<Vec<_>>(),
        "link": link,
        "provenance": run.provenance,
        "experiment": run.experiment,
        "failures": run.failures,
        "excluded": excluded,
        "lead": lead::lead(&alone.study, &alone.answers),
        "effects": alone.answers.effects,
        "dynamic_range": alone.answers.dynamic_range,
        "timings": times::records(run),
        "paybacks": times::paybacks(run),
    })
}

/// The names of numbers, by axis and value as it is written: `{"lod_bias": {"1": "filament"}}`.
fn presets(study: &Study) -> Value {
    let named = |axis: &StudyAxis| -> serde_json::Map<String, Value> {
        let name = |value: &String| Some((value.clone(), json!(preset(&axis.name, value)?)));
        axis.values.iter().filter_map(name).collect()
    };
    let all = study.axes.iter().map(|axis| (axis.name.clone(), named(axis))).filter(|(_, names)| !names.is_empty());
    all.map(|(axis, names)| (axis, Value::Object(names))).collect::<serde_json::Map<_, _>>().into()
}

/// The contact sheets of a run, by name.
fn sheets(dir: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(dir.join(SHEETS_FOLDER)).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.retain(|name| name.ends_with(".png"));
    names.sort();
    names
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
