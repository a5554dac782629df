//! Runs a plan: renders each reference and each radiance once, scores every cell, keeps records, writes tables.

mod cells;
mod outcome;
mod session;
mod timed;

pub use outcome::{Outcome, RunError, Share, ShareOutcome, Work};

use crate::experiment::plan::{Cell, Plan};
use crate::files::holds;
use crate::run::environments;
use crate::run::images;
use crate::run::live::{self, LIVE_FILE};
use crate::run::renderer::{RenderFault, Renderer};
use crate::run::scoring::CellFault;
use crate::run::sheets;
use crate::run::store::{CellRecord, FailureRecord, KeptCell, Store};
use crate::run::tables::{self, CellResult, Results};
use crate::run::timing::{self, TimingJob, TimingRecord};
use crate::run::trace;
use crate::table::csv;
use blake3::Hash;
use std::collections::HashMap;
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
    /// The command line, for the provenance.
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

/// Makes the renderer when the first step needs it, so that a finished run needs no device.
pub type MakeRenderer<'a> = dyn FnMut() -> Result<Box<dyn Renderer>, RenderFault> + 'a;

/// The tables are rewritten at most this often while cells finish,
const TABLE_INTERVAL: Duration = Duration::from_secs(2);
/// and so rarely that it takes at most this part of the time: they grow with the cells.
const TABLE_SHARE: u32 = 20;

/// Runs what is not done yet of `plan` in the folder of `options`, then writes the tables and contact sheets.
pub fn run(
    plan: &Plan,
    make_renderer: &mut MakeRenderer,
    options: &RunOptions,
    progress: &mut dyn Progress,
) -> Result<Outcome, RunError> {
    let started = Instant::now();
    let is_begun = Store::at(&options.dir).check_identity(plan)?;
    // A new run leaves nothing behind when there is no device, and one that cannot be finished is not begun.
    let mut renderer = if is_begun { None } else { Some(opened(plan, make_renderer)?) };
    let store = Store::open(&options.dir, plan)?;
    let mut run = Run::load(plan, store, options)?;
    let is_adopted = run.adopt(progress)?;
    run.forget_changed(progress)?;
    let steps_left = run.steps_left();
    progress.start(plan.cells.len() + run.jobs.len(), plan.cells.len() + run.jobs.len() - steps_left);
    if steps_left > 0 {
        let mut renderer = match renderer.take() {
            Some(renderer) => renderer,
            None => opened(plan, make_renderer)?,
        };
        run.begin_session(&renderer.device())?;
        let result = run.work(renderer.as_mut(), progress);
        // What is done is kept also when the device was lost.
        run.write_tables()?;
        run.end_session(renderer.as_ref(), started)?;
        result?;
    }
    let has_worked = run.work.is_some();
    run.finish(has_worked || is_adopted)
}

/// The renderer, if it can serve every cell: a run that cannot be finished is not begun.
fn opened(plan: &Plan, make_renderer: &mut MakeRenderer) -> Result<Box<dyn Renderer>, RunError> {
    let renderer = make_renderer()?;
    for point in plan.points_by_size() {
        renderer.check(&plan.request(&point))?;
    }
    Ok(renderer)
}

/// Does a share of `plan` in the folder `store`, which must be this process's own. Writes records and images, no tables: those are made
/// of all shares together.
pub(super) fn run_share(
    plan: &Plan,
    share: &Share,
    store: Store,
    make_renderer: &mut MakeRenderer,
    options: &RunOptions,
    progress: &mut dyn Progress,
) -> Result<ShareOutcome, RunError> {
    let mut run = Run::load(plan, store, options)?;
    run.jobs.retain(|job| share.timings.contains(&job.id));
    run.share = Some(share);
    let steps_left = run.steps_left();
    progress.start(steps_left, 0);
    let started = Instant::now();
    let mut renderer = opened(plan, make_renderer)?;
    run.begin_session(&renderer.device())?;
    let result = run.work(renderer.as_mut(), progress);
    run.end_session(renderer.as_ref(), started)?;
    result?;
    Ok(ShareOutcome { failures: run.failures(), is_stopped: run.is_stopped() && run.steps_left() > 0 })
}

/// Writes tables and contact sheets from the records that stand in the run's folder.
pub(super) fn tabulate(plan: &Plan, store: Store, options: &RunOptions) -> Result<Outcome, RunError> {
    Run::load(plan, store, options)?.finish(true)
}

/// A run in progress.
struct Run<'p> {
    plan: &'p Plan,
    store: Store,
    options: &'p RunOptions<'p>,
    /// The part of the plan that is this process's; `None` for all of it.
    share: Option<&'p Share>,
    results: Results,
    jobs: Vec<TimingJob<'p>>,
    timings: Vec<TimingRecord>,
    tables_written: Instant,
    tables_took: Duration,
    /// Whether a failure ended the run.
    is_halted: bool,
    /// References that an earlier invocation had rendered.
    references_read: usize,
    /// [`images::hashes`] of each cell that an earlier invocation finished, by its id. Gone when they are checked.
    recorded_hashes: HashMap<&'p str, Box<[Option<Hash>]>>,
    /// Records of cells that are there but cannot be used.
    unusable: Vec<PathBuf>,
    /// There when this invocation did something.
    work: Option<Work>,
}

impl<'p> Run<'p> {
    fn load(plan: &'p Plan, store: Store, options: &'p RunOptions<'p>) -> Result<Self, RunError> {
        let mut results = Results::new();
        let mut recorded_hashes = HashMap::new();
        let mut unusable = Vec::new();
        for cell in &plan.cells {
            match store.whole_cell(&cell.id) {
                Ok(Some(record)) if !record.has_all_scores() => unusable.push(store.cell_path(&cell.id)),
                Ok(Some(record)) => {
                    recorded_hashes.insert(cell.id.as_str(), images::hashes(plan, cell, &record.files));
                    results.insert(cell.id.clone(), CellResult::Done(Box::new(KeptCell::of(&record))));
                }
                Ok(None) => {}
                Err(error) if error.is_unusable_record() => unusable.push(store.cell_path(&cell.id)),
                Err(error) => return Err(error.into()),
            }
        }
        let jobs = timing::jobs(plan);
        Ok(Self {
            plan,
            store,
            options,
            share: None,
            results,
            jobs,
            timings: Vec::new(),
            tables_written: Instant::now(),
            tables_took: Duration::ZERO,
            is_halted: false,
            references_read: 0,
            recorded_hashes,
            unusable,
            work: None,
        })
    }

    /// Cells whose images are gone or not those that their records name are made again: their scores come out the same, on the same
    /// device.
    fn forget_changed(&mut self, progress: &mut dyn Progress) -> Result<(), RunError> {
        let plan = self.plan;
        if let Some(first) = self.unusable.first() {
            progress.note(&format!(
                "records of cells that are damaged, another cell's or without some metric: {}, the first {}; their cells are done again",
                self.unusable.len(),
                first.display()
            ));
        }
        let hashes = std::mem::take(&mut self.recorded_hashes);
        let done = plan.cells.iter().filter_map(|cell| Some((cell, &**hashes.get(cell.id.as_str())?)));
        let damaged = images::damaged(plan, &self.store, done);
        let Some(name) = damaged.first() else { return Ok(()) };
        progress.note(&format!(
            "images of finished cells that are missing or were changed since: {}, the first images/{name}; their cells are made again",
            damaged.len()
        ));
        // What is no file stays: its cells fail, each for itself.
        let is_file = |name: &&String| !self.store.image_path(name).is_dir();
        damaged.iter().filter(is_file).try_for_each(|name| self.store.remove_image(name))?;
        let is_hit = |cell: &&Cell| images::files(plan, cell).iter().any(|name| damaged.contains(name));
        for cell in plan.cells.iter().filter(is_hit) {
            self.results.remove(&cell.id);
        }
        Ok(())
    }

    /// Whether there is nothing to do for a cell: it has its record, or another process does it.
    fn is_done(&self, cell: &Cell) -> bool {
        let is_ours = self.share.is_none_or(|share| share.cells.contains(&cell.id));
        !is_ours || matches!(self.results.get(&cell.id), Some(CellResult::Done(_)))
    }

    fn is_stopped(&self) -> bool {
        self.is_halted || self.options.stop.load(Ordering::Relaxed)
    }

    fn steps_left(&self) -> usize {
        let cells = self.plan.cells.iter().filter(|cell| !self.is_done(cell)).count();
        // A block that lacks a record is timed anew as a whole.
        let blocks = self.jobs.chunk_by(|a, b| a.block == b.block);
        let is_open = |block: &&[TimingJob]| block.iter().any(|job| !self.store.has_timing(&job.id));
        cells + blocks.filter(is_open).map(<[TimingJob]>::len).sum::<usize>()
    }

    fn work(&mut self, renderer: &mut dyn Renderer, progress: &mut dyn Progress) -> Result<(), RunError> {
        let result = self.live(renderer, progress);
        let result = result.and_then(|()| self.cells(renderer, progress)).and_then(|()| self.time(renderer, progress));
        renderer.take_warnings().iter().for_each(|warning| progress.note(&format!("warning: {warning}")));
        result
    }

    /// Leaves what the live view of the report needs, unless it is there. It is made first, since a run whose cells are all done has
    /// nothing left to make. Without it the report has no such view.
    fn live(&self, renderer: &mut dyn Renderer, progress: &mut dyn Progress) -> Result<(), RunError> {
        let path = self.store.dir().join(LIVE_FILE);
        let is_ours = self.share.is_none_or(|share| share.has_live);
        if !is_ours || self.is_stopped() || path.exists() {
            return Ok(());
        }
        match of_cell(live::record(self.plan, renderer).map_err(CellFault::from))? {
            Ok(record) => self.store.write_json(&path, &record)?,
            Err(reason) => progress.note(&format!("the report will have no live view: {reason}")),
        }
        Ok(())
    }

    fn remember(&mut self, record: &CellRecord) {
        self.results.insert(record.cell.clone(), CellResult::Done(Box::new(KeptCell::of(record))));
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

    /// The cells that failed, in plan order.
    fn failures(&self) -> Vec<FailureRecord> {
        let failure = |cell: &Cell| match self.results.get(&cell.id) {
            Some(CellResult::Failed(record)) => Some(record.clone()),
            _ => None,
        };
        self.plan.cells.iter().filter_map(failure).collect()
    }

    fn write_tables_sometimes(&mut self) -> Result<(), RunError> {
        let interval = TABLE_INTERVAL.max(self.tables_took * TABLE_SHARE);
        let is_time = self.share.is_none() && self.tables_written.elapsed() >= interval;
        if is_time { self.write_errors() } else { Ok(()) }
    }

    fn write_errors(&mut self) -> Result<(), RunError> {
        let started = Instant::now();
        let (columns, rows) = tables::errors(self.plan, &self.results);
        self.store.write_table("errors.csv", &columns, rows)?;
        (self.tables_written, self.tables_took) = (Instant::now(), started.elapsed());
        Ok(())
    }

    fn write_tables(&mut self) -> Result<(), RunError> {
        self.write_errors()?;
        let (columns, rows) = tables::errors_by_n_dot_v(self.plan, &self.results, &self.store);
        self.store.write_table("errors_by_n_dot_v.csv", &columns, rows)?;
        if self.plan.config.ladder.is_some() {
            let (columns, rows) = tables::steps(self.plan, &self.results, &self.store);
            self.store.write_table("steps.csv", &columns, rows)?;
        }
        Ok(())
    }

    /// Tables and contact sheets of all that is done.
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
        if self.plan.config.timing.is_some() {
            let (columns, rows) = tables::timings(&self.timings);
            self.store.write_table("timings.csv", &columns, rows.into_iter().map(Ok))?;
            let (columns, rows) = tables::timing_ratios(&self.timings);
            self.store.write_table("timing_ratios.csv", &columns, rows.into_iter().map(Ok))?;
            if self.options.trace {
                self.store.write_json(&self.store.dir().join("trace.json"), &trace::chrome_trace(&self.timings))?;
            }
        }
        let (columns, rows) = environments::environments(self.plan);
        self.store.write_table("environments.csv", &columns, rows.into_iter().map(Ok))?;
        let (columns, rows) = images::index(self.plan, &self.results);
        let index = csv::to_text(&columns, rows.iter().map(Vec::as_slice));
        let path = self.store.dir().join("images.csv");
        // Written last: where it stands and nothing was added, the sheets are whole.
        if has_worked || !holds(&path, &index) {
            sheets::write_sheets(&self.store, self.plan, &self.results)?;
            self.store.write_text(&path, &String::from_utf8_lossy(&index))?;
        }
        Ok(Outcome {
            dir: self.store.dir().to_owned(),
            failures: self.failures(),
            is_stopped: self.is_stopped() && self.steps_left() > 0,
            work: self.work,
            timings: self.timings,
        })
    }
}

/// The outer error ends the run, the inner one is the cell's own.
fn of_cell<T>(result: Result<T, CellFault>) -> Result<Result<T, String>, RunError> {
    match result {
        Ok(value) => Ok(Ok(value)),
        Err(CellFault::Cell(reason)) => Ok(Err(reason)),
        Err(CellFault::Store(error)) => Err(error.into()),
        Err(CellFault::Lost(reason)) => Err(RunError::DeviceLost(reason)),
    }
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}
