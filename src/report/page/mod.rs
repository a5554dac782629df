//! The report: one HTML file without requests. `sections` shows answers, `lead` the first screen;
//! [`model`], [`images`] and [`live`] hold the data of the scripts; [`render`] writes the file.

pub mod images;
mod lead;
pub mod live;
pub mod model;
pub mod page_run;
pub mod render;
mod sections;

pub use page_run::PageRun;

use crate::base::pixels::{PixelsError, write_atomically};
use crate::study::frame::Frame;
use images::Choice;
use serde_json::{Value as Json, json};
use std::io::Read;
use std::path::{Path, PathBuf};

#[derive(Clone, Debug)]
pub struct PageOptions {
    pub out: PathBuf,
    /// Whether the page leaves the folder of its run: then links lead to `answers/` beside it, and
    /// none to other files.
    pub is_alone: bool,
    pub images: Choice,
    pub budget: usize,
    /// Replaces the experiment's own metric.
    pub metric: Option<String>,
}

pub const PAGE_FILE: &str = "report.html";

impl PageOptions {
    /// The page of one run, in its folder.
    pub fn in_folder(dir: &Path) -> Self {
        let (images, budget) = (Choice::Automatic, images::BUDGET_BYTES);
        Self {
            out: dir.join(PAGE_FILE),
            is_alone: false,
            images,
            budget,
            metric: None,
        }
    }
}

#[derive(Debug)]
pub struct Written {
    pub path: PathBuf,
    pub bytes: usize,
    /// Omissions, one sentence each.
    pub notes: Vec<String>,
    /// The cell of the leading pictures.
    pub cell: Option<String>,
}

/// Template, styles, modules and shaders, about, bytes.
const PROGRAM_BYTES: usize = 400_000;

#[derive(Debug, thiserror::Error)]
pub enum PageError {
    #[error("expected at least one run to report")]
    NoRun,
    #[error("--out {}: is a folder; expected the file to write, such as {}", path.display(), path.join(PAGE_FILE).display())]
    OutIsFolder { path: PathBuf },
    #[error("--out {}: exists and is not a report of splitsum; choose a new file, or a report to \
             replace", path.display())]
    NotAReport { path: PathBuf },
    #[error(transparent)]
    Write(#[from] PixelsError),
}

impl PageError {
    pub fn is_misuse(&self) -> bool {
        matches!(
            self,
            Self::NoRun | Self::OutIsFolder { .. } | Self::NotAReport { .. }
        )
    }
}

/// Refuses a folder, or a file that is not a report.
pub fn check_out(path: &Path) -> Result<(), PageError> {
    match () {
        () if path.is_dir() => Err(PageError::OutIsFolder {
            path: path.to_owned(),
        }),
        () if path.exists() && !is_page(path) => Err(PageError::NotAReport {
            path: path.to_owned(),
        }),
        () => Ok(()),
    }
}

/// Writes the page of one or more runs.
pub fn write(options: &PageOptions, runs: &[PageRun]) -> Result<Written, PageError> {
    check_out(&options.out)?;
    let first = runs.first().ok_or(PageError::NoRun)?;
    let here = if options.is_alone {
        &first.finished.dir
    } else {
        options.out.parent().unwrap_or(Path::new(""))
    };
    let frames: Vec<Frame> = runs
        .iter()
        .map(|run| Frame::new(run.finished, options.metric.as_deref()))
        .collect();
    let axes = model::axes(runs);
    let metrics = model::metrics(runs);
    let light = live::Light::collect(runs, live::BUDGET_BYTES);
    let mut section_count = 0;
    let shown = runs
        .iter()
        .zip(&frames)
        .enumerate()
        .map(|(index, (page_run, frame))| {
            let lead = lead::leading(page_run);
            let has_pictures = options.images != Choice::None;
            let sections = sections::sections(page_run, index, section_count, here);
            section_count += sections.len();
            json!({
                "label": page_run.label,
                "name": page_run.finished.text("/name"),
                "link": (!options.is_alone).then(|| page_run::link(here, &page_run.finished.dir)),
                "anchor": format!("run-{}", index + 1),
                "index": index,
                "device": page_run.device(),
                "date": page_run.date(),
                "warnings": page_run.warnings(),
                "cpu_warning": page_run.cpu_warning(),
                "shared": model::shared(&model::axes(std::slice::from_ref(page_run))),
                "lead": lead,
                "pictures": has_pictures.then(|| lead::pictures(page_run, frame, &axes)).flatten(),
                "sections": sections,
                "provenance": page_run::provenance(page_run),
                "failures": page_run.finished.failures,
                "excluded": page_run.finished.provenance["excluded"],
                "input_warnings": page_run.finished.provenance["input_warnings"],
                "sheets": if options.is_alone { Vec::new() } else { page_run.sheets(here) },
                "experiment": page_run.finished.experiment,
                "whole": format!("{:#}", page_run.finished.provenance),
            })
        });
    let fixed = json!({
        "name": first.finished.text("/name"),
        "heading": page_run::heading(runs),
        "metric": frames[0].metric_name(),
        "facts": page_run::facts(runs),
        "metrics": first.finished.provenance["metrics"],
        "program_version": env!("CARGO_PKG_VERSION"),
        "runs": shown.collect::<Vec<Json>>(),
    });
    let answers: Vec<Json> = runs
        .iter()
        .enumerate()
        .flat_map(|(run, own)| sections::model(own, run))
        .collect();
    let others = [
        json_bytes(&light),
        json_bytes(&answers),
        json_bytes(&fixed),
        PROGRAM_BYTES,
    ]
    .iter()
    .sum::<usize>();
    let mut images = images::collect(
        runs,
        options.images,
        options.budget.saturating_sub(others + row_bytes(runs)),
    );
    let payloads = std::mem::take(&mut images.payloads);
    let model = model::Model {
        headline: frames[0].metric,
        runs: fixed["runs"]
            .as_array()
            .into_iter()
            .flatten()
            .map(for_scripts)
            .collect(),
        axes: &axes,
        metrics: &metrics,
        answers,
        images: &images,
        cells_of: runs,
    };
    write_atomically(&options.out, |writer| {
        render::render(writer, &fixed, &model, payloads, &light)
    })?;
    let bytes = std::fs::metadata(&options.out).map_or(0, |written| written.len() as usize);
    let cell = fixed
        .pointer("/runs/0/pictures/cell")
        .and_then(Json::as_str)
        .map(str::to_owned);
    Ok(Written {
        path: options.out.clone(),
        bytes,
        notes: images.notes,
        cell,
    })
}

fn for_scripts(run: &Json) -> Json {
    let keys = ["label", "name", "link", "failures", "sheets", "shared"];
    keys.into_iter()
        .map(|key| (key.to_owned(), run[key].clone()))
        .collect::<serde_json::Map<_, _>>()
        .into()
}

/// Size of the rows in the page, about, bytes.
fn row_bytes(runs: &[PageRun]) -> usize {
    const ROW_BYTES: usize = 500;
    ROW_BYTES
        * runs
            .iter()
            .map(|run| run.finished.cells.len())
            .sum::<usize>()
}

fn json_bytes(value: &impl serde::Serialize) -> usize {
    serde_json::to_vec(value).map_or(0, |text| text.len())
}

/// Identifies reports.
const MARK: &str = " · splitsum</title>";
/// The mark is within this many bytes, after the name of the run.
const HEAD_BYTES: u64 = 1 << 14;

/// Whether a file is a report of this program.
pub fn is_page(path: &Path) -> bool {
    let mut head = Vec::new();
    let file = std::fs::File::open(path).ok().filter(|_| path.is_file());
    let is_read = file.is_some_and(|file| file.take(HEAD_BYTES).read_to_end(&mut head).is_ok());
    let head = String::from_utf8_lossy(&head);
    is_read && head.starts_with("<!doctype html>") && head.contains(MARK)
}
