//! The report: one HTML file without requests. `sections` shows answers, `pictures` the first
//! screen; [`model`], [`images`], [`intermediates`] and [`live`] hold the data of the scripts;
//! [`render`] writes the file.

pub mod images;
pub mod intermediates;
pub mod live;
pub mod model;
pub mod page_run;
mod pictures;
pub mod render;
mod sections;

pub use page_run::PageRun;

use crate::base::pixels::{PixelsError, write_atomically};
use crate::run::provenance::{ExclusionRecord, MetricRecord};
use crate::run::store::FailureRecord;
use crate::study::frame::Frame;
use images::Choice;
use intermediates::PageIntermediates;
use model::{PageAxis, ScriptRun, ScriptTable};
use page_run::Fact;
use pictures::Pictures;
use sections::Section;
use serde::Serialize;
use std::io::{Read, Write};
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
        Self {
            out: dir.join(PAGE_FILE),
            is_alone: false,
            images: Choice::Automatic,
            budget: images::BUDGET_BYTES,
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
    /// The cell of the pictures of the first run.
    pub cell: Option<String>,
}

/// Template, styles, modules and shaders, about, bytes.
const PROGRAM_BYTES: usize = 400_000;

#[derive(Debug, thiserror::Error)]
pub enum PageError {
    #[error("expected at least one run to report")]
    NoRun,
    #[error(
        "--out {}: is a folder; expected the file to write, such as {}",
        path.display(),
        path.join(PAGE_FILE).display()
    )]
    OutIsFolder { path: PathBuf },
    #[error(
        "--out {}: exists and is not a report of splitsum; choose a new file, or a report to \
         replace",
        path.display()
    )]
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
    let path = path.to_owned();
    if path.is_dir() {
        Err(PageError::OutIsFolder { path })
    } else if path.exists() && !is_page(&path) {
        Err(PageError::NotAReport { path })
    } else {
        Ok(())
    }
}

/// The data of the template.
#[derive(Serialize)]
struct Content<'a> {
    name: &'a str,
    heading: String,
    /// Name of the metric of the answers.
    metric: &'static str,
    facts: Vec<Fact>,
    /// As the first run defined them.
    metrics: &'a [MetricRecord],
    program_version: &'static str,
    runs: Vec<RunContent<'a>>,
}

/// The data of a run for the template.
#[derive(Serialize)]
struct RunContent<'a> {
    label: &'a str,
    name: &'a str,
    /// To the folder of the run; `None` if the page leaves it.
    link: Option<String>,
    anchor: String,
    index: usize,
    device: String,
    date: String,
    warnings: Vec<String>,
    cpu_warning: Option<String>,
    shared: String,
    /// Index of the answer on the first screen.
    main_section: Option<usize>,
    pictures: Option<Pictures>,
    sections: Vec<Section>,
    provenance: Vec<(&'static str, Vec<(String, String)>)>,
    failures: &'a [FailureRecord],
    excluded: &'a [ExclusionRecord],
    input_warnings: &'a [String],
    sheets: Vec<[String; 2]>,
    /// The text of the experiment.
    experiment: &'a str,
    /// The text of the provenance.
    whole: String,
}

impl RunContent<'_> {
    fn for_scripts(&self) -> ScriptRun<'_> {
        ScriptRun {
            failures: self.failures,
            label: self.label,
            link: self.link.as_deref(),
            name: self.name,
            shared: &self.shared,
            sheets: &self.sheets,
        }
    }
}

/// Writes the page of one or more runs.
pub fn write(options: &PageOptions, runs: &[PageRun]) -> Result<Written, PageError> {
    check_out(&options.out)?;
    let first = runs.first().ok_or(PageError::NoRun)?;
    let frames: Vec<Frame> = runs
        .iter()
        .map(|run| Frame::new(run.finished, options.metric.as_deref()))
        .collect();
    let axes = model::axes(runs);
    let metrics = model::metrics(runs);
    let light = live::Light::collect(runs, live::BUDGET_BYTES);
    let content = Content {
        name: &first.finished.provenance.name,
        heading: page_run::heading(runs),
        metric: frames[0].metric_name(),
        facts: page_run::facts(runs),
        metrics: &first.finished.provenance.metrics,
        program_version: env!("CARGO_PKG_VERSION"),
        runs: run_contents(options, runs, &frames, &axes),
    };
    let tables: Vec<ScriptTable> = runs
        .iter()
        .enumerate()
        .flat_map(|(index, run)| sections::tables(run, index))
        .collect();
    let bytes_without_images = json_bytes(&light)
        + json_bytes(&tables)
        + json_bytes(&content)
        + PROGRAM_BYTES
        + row_bytes(runs);
    let image_budget = options.budget.saturating_sub(bytes_without_images);
    let mut images = images::collect(runs, options.images, image_budget);
    let intermediates = if images.payloads.is_empty() {
        PageIntermediates::default()
    } else {
        let payload_bytes: usize = images.payloads.iter().map(String::len).sum();
        PageIntermediates::collect(runs, &mut images, bytes_without_images + payload_bytes)
    };
    let payloads = std::mem::take(&mut images.payloads);
    let model = model::Model {
        headline: frames[0].metric,
        runs: content.runs.iter().map(RunContent::for_scripts).collect(),
        axes: &axes,
        metrics: &metrics,
        answers: tables,
        images: &images,
        intermediates: &intermediates,
        page_runs: runs,
    };
    write_atomically(&options.out, |writer| {
        render::render(writer, &content, &model, payloads, &light)
    })?;
    let bytes = std::fs::metadata(&options.out).map_or(0, |written| written.len() as usize);
    let pictures = content.runs[0].pictures.as_ref();
    Ok(Written {
        path: options.out.clone(),
        bytes,
        notes: images.notes,
        cell: pictures.map(|pictures| pictures.cell.clone()),
    })
}

/// The data of all runs for the template; `axes` are the axes of all runs.
fn run_contents<'a>(
    options: &PageOptions,
    runs: &'a [PageRun],
    frames: &[Frame],
    axes: &[PageAxis],
) -> Vec<RunContent<'a>> {
    let link_base = if options.is_alone {
        runs[0].finished.dir.as_path()
    } else {
        options.out.parent().unwrap_or(Path::new(""))
    };
    let mut contents = Vec::with_capacity(runs.len());
    let mut section_count = 0;
    for (index, (run, frame)) in runs.iter().zip(frames).enumerate() {
        let finished = run.finished;
        let sections = sections::sections(run, index, section_count, link_base);
        section_count += sections.len();
        let pictures = if options.images == Choice::None {
            None
        } else {
            pictures::pictures(run, frame, axes)
        };
        contents.push(RunContent {
            label: &run.label,
            name: &finished.provenance.name,
            link: (!options.is_alone).then(|| page_run::link(link_base, &finished.dir)),
            anchor: format!("run-{}", index + 1),
            index,
            device: run.device(),
            date: run.date(),
            warnings: run.warnings(),
            cpu_warning: run.cpu_warning(),
            shared: model::shared(&model::axes(std::slice::from_ref(run))),
            main_section: pictures::first_answer(run),
            pictures,
            sections,
            provenance: page_run::provenance(run),
            failures: &finished.failures,
            excluded: &finished.provenance.excluded,
            input_warnings: &finished.provenance.input_warnings,
            sheets: if options.is_alone {
                Vec::new()
            } else {
                run.sheets(link_base)
            },
            experiment: &finished.experiment,
            whole: format!("{:#}", finished.provenance.to_json()),
        });
    }
    contents
}

/// Size of the rows in the page, about, bytes.
fn row_bytes(runs: &[PageRun]) -> usize {
    const ROW_BYTES: usize = 500;
    let row_count: usize = runs.iter().map(|run| run.finished.cells.len()).sum();
    ROW_BYTES * row_count
}

fn json_bytes(value: &impl Serialize) -> usize {
    let mut count = ByteCount(0);
    serde_json::to_writer(&mut count, value).map_or(0, |()| count.0)
}

/// Counts what is written to it.
struct ByteCount(usize);

impl Write for ByteCount {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0 += bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
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
