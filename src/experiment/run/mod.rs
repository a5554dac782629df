//! Runs a plan: renders each reference and each radiance once, scores every cell, keeps records, writes tables.

mod cells;
mod timed;

use crate::experiment::images;
use crate::experiment::live::{self, LIVE_FILE};
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::provenance;
use crate::experiment::renderer::{RenderFault, Renderer};
use crate::experiment::sheets;
use crate::experiment::store::{CellRecord, FailureRecord, Store, StoreError};
use crate::experiment::summary;
use crate::experiment::tables::{self, CellResult, Results};
use crate::experiment::timing::{self, TimingJob, TimingRecord};
use crate::experiment::trace;
use crate::pipeline::DeviceInfo;
use crate::slips;
use crate::table::csv::Table;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How a run is to be done.
#[derive(Debug)]
pub struct RunOptions<'a> {
    /// The folder of the run.
    pub dir: PathBuf,
    /// Set from outside to stop after the current cell.
    pub stop: &'a AtomicBool,
    /// What the user typed, for the provenance.
    pub command_line: Vec<String>,
    /// Ends the run at the first cell that fails, instead of going on with the others.
    pub fail_fast: bool,
    /// Writes the timed passes as a Chrome trace, `trace.json`.
    pub trace: bool,
}

/// Follows a run.
pub trait Progress {
    /// The run has `total` steps (cells and timed configurations), `done` of them from earlier.
    fn start(&mut self, total: usize, done: usize);
    /// A step ended; `failure` says why it failed.
    fn step(&mut self, label: &str, failure: Option<&str>);
    /// A line for the user.
    fn note(&mut self, text: &str);
}

/// What a run left.
#[derive(Debug)]
pub struct Outcome {
    pub dir: PathBuf,
    /// The text of `summary.md`.
    pub summary: String,
    /// Cells without a record, each with its reason.
    pub failures: Vec<FailureRecord>,
    /// Whether it was stopped before all steps were tried.
    pub is_stopped: bool,
}

/// Why a run ended early.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error("the device was lost: {0}; what is done is kept, run the same command again to go on")]
    DeviceLost(String),
    /// The renderer could not be made.
    #[error("{0}")]
    NoRenderer(String),
}

/// Makes the renderer when the first step needs it, so that a finished run needs no device.
pub type MakeRenderer<'a> = dyn FnMut() -> Result<Box<dyn Renderer>, RenderFault> + 'a;

/// The tables are rewritten at most this often while cells finish.
const TABLE_INTERVAL: Duration = Duration::from_secs(2);

/// Runs what is not done yet of `plan` in the folder of `options`, then writes the tables and the summary.
pub fn run(
    plan: &Plan,
    make_renderer: &mut MakeRenderer,
    options: &RunOptions,
    progress: &mut dyn Progress,
) -> Result<Outcome, RunError> {
    // A new run leaves nothing behind when there is no device.
    let folder = Store::at(&options.dir);
    folder.check_identity(plan)?;
    let mut renderer = match folder.provenance_path().exists() {
        true => None,
        false => Some(opened(plan, make_renderer)?),
    };
    let store = Store::open(&options.dir, plan)?;
    let mut run = Run::load(plan, store, options)?;
    let steps_left = run.steps_left();
    progress.start(plan.cells.len() + run.jobs.len(), plan.cells.len() + run.jobs.len() - steps_left);
    if steps_left > 0 {
        let renderer = match renderer.take() {
            Some(renderer) => renderer,
            None => opened(plan, make_renderer)?,
        };
        run.begin_session(&renderer.device())?;
        let result = run.work(renderer, progress);
        // What is done is kept also when the device was lost.
        run.write_tables()?;
        result?;
    }
    run.finish(steps_left > 0)
}

/// The renderer, if it can serve every cell: a run that cannot be finished is not begun.
fn opened(plan: &Plan, make_renderer: &mut MakeRenderer) -> Result<Box<dyn Renderer>, RunError> {
    let renderer = make_renderer().map_err(fault_error)?;
    for point in plan.points_by_size() {
        renderer.check(&plan.request(&point)).map_err(fault_error)?;
    }
    Ok(renderer)
}

fn fault_error(fault: RenderFault) -> RunError {
    if fault.device_lost { RunError::DeviceLost(fault.message) } else { RunError::NoRenderer(fault.message) }
}

/// A run in progress.
struct Run<'p> {
    plan: &'p Plan,
    store: Store,
    options: &'p RunOptions<'p>,
    results: Results,
    jobs: Vec<TimingJob<'p>>,
    timings: Vec<TimingRecord>,
    tables_written: Instant,
    /// Whether a failure ended the run.
    is_halted: bool,
    /// Host time in which the device worked or was waited for, ms.
    device_ms: f64,
    /// References that an earlier invocation had rendered.
    references_read: usize,
}

impl<'p> Run<'p> {
    fn load(plan: &'p Plan, store: Store, options: &'p RunOptions<'p>) -> Result<Self, RunError> {
        let mut results = Results::new();
        for cell in &plan.cells {
            if let Some(record) = store.cell(&cell.id)? {
                results.insert(cell.id.clone(), CellResult::Done(record.without_bins()));
            }
        }
        let jobs = timing::jobs(plan);
        Ok(Self {
            plan,
            store,
            options,
            results,
            jobs,
            timings: Vec::new(),
            tables_written: Instant::now(),
            is_halted: false,
            device_ms: 0.0,
            references_read: 0,
        })
    }

    fn is_done(&self, cell: &Cell) -> bool {
        matches!(self.results.get(&cell.id), Some(CellResult::Done(_)))
    }

    fn is_stopped(&self) -> bool {
        self.is_halted || self.options.stop.load(Ordering::Relaxed)
    }

    fn steps_left(&self) -> usize {
        let cells = self.plan.cells.iter().filter(|cell| !self.is_done(cell)).count();
        cells + self.jobs.iter().filter(|job| !self.store.has_timing(&job.id)).count()
    }

    /// Writes the frozen experiment and adds this invocation to the provenance.
    fn begin_session(&self, device: &DeviceInfo) -> Result<(), RunError> {
        let path = self.store.provenance_path();
        let mut value = self.store.read(&path)?.unwrap_or_else(|| provenance::provenance(self.plan));
        if let Some(sessions) = value["sessions"].as_array_mut() {
            sessions.push(provenance::session(device, &self.options.command_line));
        }
        self.store.write_json(&path, &value)?;
        self.store.write_text(&self.store.dir().join("experiment.toml"), &self.plan.config.text)?;
        Ok(())
    }

    fn work(&mut self, mut renderer: Box<dyn Renderer>, progress: &mut dyn Progress) -> Result<(), RunError> {
        let started = Instant::now();
        self.cells(renderer.as_mut(), progress)?;
        self.live(renderer.as_mut(), progress)?;
        self.time(renderer.as_mut(), progress)?;
        let wall_ms = milliseconds(started);
        let reused = match self.references_read {
            0 => String::new(),
            count => format!("; {count} references were read back"),
        };
        progress.note(&format!(
            "{:.1} s, {:.0} % of it without the device{reused}",
            wall_ms / 1e3,
            100.0 * (1.0 - self.device_ms / wall_ms).max(0.0)
        ));
        Ok(())
    }

    /// Leaves what the live view of the report needs, before timing forgets the tables. Without it the report has no such view.
    fn live(&self, renderer: &mut dyn Renderer, progress: &mut dyn Progress) -> Result<(), RunError> {
        let path = self.store.dir().join(LIVE_FILE);
        if self.is_stopped() || path.exists() {
            return Ok(());
        }
        match cell_result(live::record(self.plan, renderer))? {
            Ok(record) => self.store.write_json(&path, &record)?,
            Err(reason) => progress.note(&format!("the report will have no live view: {reason}")),
        }
        Ok(())
    }

    fn remember(&mut self, record: CellRecord) {
        self.results.insert(record.cell.clone(), CellResult::Done(record.without_bins()));
    }

    fn fail(&mut self, cells: &[&Cell], reason: &str, progress: &mut dyn Progress) -> Result<(), RunError> {
        for cell in cells.iter().filter(|cell| !self.is_done(cell)).copied().collect::<Vec<_>>() {
            let label = self.plan.label(cell);
            let record = FailureRecord { cell: cell.id.clone(), label: label.clone(), reason: reason.to_owned() };
            self.store.write_failure(&record)?;
            self.results.insert(cell.id.clone(), CellResult::Failed(record));
            progress.step(&label, Some(reason));
            self.is_halted |= self.options.fail_fast;
        }
        Ok(())
    }

    fn write_tables_sometimes(&mut self) -> Result<(), RunError> {
        if self.tables_written.elapsed() >= TABLE_INTERVAL { self.write_errors() } else { Ok(()) }
    }

    fn write_errors(&mut self) -> Result<(), RunError> {
        let (columns, rows) = tables::errors(self.plan, &self.results);
        self.store.write_table("errors.csv", &columns, rows)?;
        self.tables_written = Instant::now();
        Ok(())
    }

    fn write_tables(&mut self) -> Result<(), RunError> {
        self.write_errors()?;
        let (columns, rows) = tables::errors_by_n_dot_v(self.plan, &self.results, &self.store);
        Ok(self.store.write_table("errors_by_n_dot_v.csv", &columns, rows)?)
    }

    /// Tables, contact sheets and the summary of all that is done. The summary comes last: where it stands and nothing was
    /// added, the sheets are whole.
    fn finish(mut self, has_worked: bool) -> Result<Outcome, RunError> {
        for job in &self.jobs {
            self.timings.extend(self.store.timing::<TimingRecord>(&job.id)?);
        }
        for cell in &self.plan.cells {
            if let (None, Some(failure)) = (self.results.get(&cell.id), self.store.failure(&cell.id)?) {
                self.results.insert(cell.id.clone(), CellResult::Failed(failure));
            }
        }
        self.write_tables()?;
        let (columns, rows) = images::index(self.plan, &self.results);
        self.store.write_table("images.csv", &columns, rows.into_iter().map(Ok))?;
        if self.plan.config.timing.is_some() {
            let (columns, rows) = tables::timings(&self.timings);
            self.store.write_table("timings.csv", &columns, rows.into_iter().map(Ok))?;
            let (columns, rows) = tables::timing_ratios(&self.timings);
            self.store.write_table("timing_ratios.csv", &columns, rows.into_iter().map(Ok))?;
            if self.options.trace {
                self.store.write_json(&self.store.dir().join("trace.json"), &trace::chrome_trace(&self.timings))?;
            }
        }
        let mut summary = summary::markdown(self.plan, &self.results, &self.timings, &self.store);
        if self.plan.config.has_printed_slips {
            let (columns, rows) = slips::table();
            self.store.write_table(slips::FILE_NAME, &columns, rows.into_iter().map(Ok))?;
            let table = Table::read(&self.store.dir().join(slips::FILE_NAME)).map_err(StoreError::from)?;
            let table = slips::markdown(&table).map_err(StoreError::from)?;
            summary += &format!("## What each slip costs\n\n{}\n{table}", slips::HEADING);
        }
        let summary_path = self.store.dir().join("summary.md");
        if has_worked || std::fs::read_to_string(&summary_path).ok().as_deref() != Some(&summary) {
            sheets::write_sheets(&self.store, self.plan, &self.results)?;
            self.store.write_text(&summary_path, &summary)?;
        }
        let is_failure = |cell: &Cell| match self.results.get(&cell.id) {
            Some(CellResult::Failed(record)) => Some(record.clone()),
            _ => None,
        };
        Ok(Outcome {
            dir: self.store.dir().to_owned(),
            summary,
            failures: self.plan.cells.iter().filter_map(is_failure).collect(),
            is_stopped: self.is_stopped() && self.steps_left() > 0,
        })
    }
}

/// A lost device ends the run; any other fault is the cell's own.
fn cell_result<T>(result: Result<T, RenderFault>) -> Result<Result<T, String>, RunError> {
    match result {
        Ok(value) => Ok(Ok(value)),
        Err(fault) if fault.device_lost => Err(RunError::DeviceLost(fault.message)),
        Err(fault) => Ok(Err(fault.message)),
    }
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}
