//! Runs a plan: renders each reference and each image once, scores every cell, writes records and
//! tables.

mod cells;
mod found;
mod merge;
mod outcome;
mod references;
mod session;
mod timed;

pub use merge::{Merged, Missing, merge};
pub use outcome::{Outcome, Progress, RunError, RunOptions};

use self::found::Found;
use crate::base::csv;
use crate::base::files::holds;
use crate::experiment::id::Id;
use crate::experiment::plan::{Cell, Plan, ReferenceGroup};
use crate::run::cell_fault::CellFault;
use crate::run::environments;
use crate::run::estimate::{Ahead, Forecast};
use crate::run::images;
use crate::run::recovery::{self, RECOVERY_FILE};
use crate::run::renderer::{RenderFault, Renderer};
use crate::run::results::Results;
use crate::run::split::Share;
use crate::run::store::{FailureRecord, Store};
use crate::run::tables;
use crate::run::timing::{self, TimingJob, TimingRecord};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::Ordering;
use std::time::Instant;

/// Makes the renderer when it is needed: a finished run needs no device.
pub type MakeRenderer<'a> = dyn FnMut() -> Result<Box<dyn Renderer>, RenderFault> + 'a;

/// Runs the open part of `plan` in the folder of `options`, then writes tables and the
/// companions' files. A shard leaves these to [`merge`].
pub fn run(
    plan: &Plan,
    make_renderer: &mut MakeRenderer,
    options: &RunOptions,
    progress: &mut dyn Progress,
) -> Result<Outcome, RunError> {
    let started = Instant::now();
    let is_begun = Store::read_only(&options.dir).check_identity(plan)?;
    // A new run without a device, or with a cell that cannot be rendered, leaves no folder.
    let mut renderer = if is_begun {
        None
    } else {
        Some(opened(plan, make_renderer)?)
    };
    let store = match options.shard {
        Some(shard) => Store::open_shard(&options.dir, plan, shard)?,
        None => Store::open(&options.dir, plan)?,
    };
    let mut run = Run::load(plan, store, options)?;
    let is_adopted = run.adopt(progress)?;
    run.forget_changed(progress)?;
    let steps = run.share_cells().count() + run.jobs.len();
    let left = run.steps_left();
    if left > 0 {
        let mut renderer = match renderer.take() {
            Some(renderer) => renderer,
            None => opened(plan, make_renderer)?,
        };
        run.forecast = Some(run.forecast(renderer.as_ref()));
        run.clock = Instant::now();
        progress.start(steps, steps - left, run.ahead());
        run.begin_session(&renderer.device())?;
        let result = run.work(renderer.as_mut(), progress);
        // After work without a fault they are written at the end.
        if result.is_err() && run.share.is_none() {
            run.write_tables()?;
        }
        run.end_session(started)?;
        result?;
    } else {
        progress.start(
            steps,
            steps,
            Ahead {
                share: 1.0,
                seconds: 0.0,
            },
        );
    }
    if run.makes_recovery(left > 0 || is_adopted) {
        progress.note("fitting materials to the photos");
    }
    run.finish(left > 0 || is_adopted)
}

/// Makes the renderer and checks that it can serve every cell.
fn opened(plan: &Plan, make_renderer: &mut MakeRenderer) -> Result<Box<dyn Renderer>, RunError> {
    let renderer = make_renderer()?;
    for point in plan.points_by_size() {
        renderer.check(&plan.request(&point))?;
    }
    Ok(renderer)
}

struct Run<'p> {
    plan: &'p Plan,
    store: Store,
    options: &'p RunOptions<'p>,
    /// The part of the plan that this process does; `None` for all.
    share: Option<Share>,
    results: Results,
    jobs: Vec<TimingJob<'p>>,
    timings: Vec<TimingRecord>,
    /// Whether a failure ended the run.
    is_halted: bool,
    /// Images of finished cells that are missing or differ from their records, by name.
    damaged: BTreeSet<String>,
    /// A sentence for each record that cannot be used.
    unusable: Vec<String>,
    /// Finished cells by device.
    devices: BTreeMap<String, usize>,
    /// Set while this invocation works.
    forecast: Option<Forecast>,
    /// When this invocation began to work.
    clock: Instant,
}

impl<'p> Run<'p> {
    fn load(plan: &'p Plan, store: Store, options: &'p RunOptions<'p>) -> Result<Self, RunError> {
        let share = options.shard.map(|shard| Share::new(plan, shard));
        let found = Found::read(plan, &store, &share)?;
        let mut jobs = timing::jobs(plan);
        jobs.retain(|job| {
            share
                .as_ref()
                .is_none_or(|share| share.timings.contains(&job.id))
        });
        Ok(Self {
            plan,
            store,
            options,
            share,
            results: found.results,
            jobs,
            timings: Vec::new(),
            is_halted: false,
            damaged: found.damaged,
            unusable: found.unusable,
            devices: found.devices,
            forecast: None,
            clock: Instant::now(),
        })
    }

    /// Forgets the results of cells whose images are missing or differ from their records.
    fn forget_changed(&mut self, progress: &mut dyn Progress) -> Result<(), RunError> {
        let plan = self.plan;
        if let Some(first) = self.unusable.first() {
            progress.note(&format!(
                "{} unusable records of finished cells; rendering these cells again; the first: \
                 {first}",
                self.unusable.len()
            ));
        }
        let damaged = std::mem::take(&mut self.damaged);
        let Some(name) = damaged.first() else {
            return Ok(());
        };
        progress.note(&format!(
            "{} missing or changed images of finished cells; rendering these cells again; the \
             first: images/{name}",
            damaged.len()
        ));
        for name in &damaged {
            // A folder in place of a file stays: only its cells fail.
            if !self.store.image_path(name).is_dir() {
                self.store.remove("images", name)?;
            }
        }
        for cell in &plan.cells {
            let files = images::files(plan, cell);
            if files.iter().any(|name| damaged.contains(name)) {
                self.results.forget(cell);
            }
        }
        Ok(())
    }

    /// The cells that this process renders.
    fn share_cells(&self) -> impl Iterator<Item = &'p Cell> {
        self.plan
            .cells
            .iter()
            .filter(|cell| is_in_share(&self.share, cell))
    }

    /// Whether a cell has its record, or belongs to another process.
    fn is_done(&self, cell: &Cell) -> bool {
        !is_in_share(&self.share, cell) || self.results.is_done(cell)
    }

    fn is_stopped(&self) -> bool {
        self.is_halted || self.options.stop.load(Ordering::Relaxed)
    }

    fn steps_left(&self) -> usize {
        self.plan
            .cells
            .iter()
            .filter(|cell| !self.is_done(cell))
            .count()
            + self.open_jobs().len()
    }

    /// Configurations to time: whole blocks that lack a record.
    fn open_jobs(&self) -> Vec<TimingJob<'p>> {
        let blocks = self.jobs.chunk_by(|a, b| a.block == b.block);
        blocks
            .filter(|block| !block.iter().all(|job| self.store.has_timing(job.id)))
            .flatten()
            .cloned()
            .collect()
    }

    /// Predicts the open work. References in the cache or the folder are free.
    fn forecast(&self, renderer: &dyn Renderer) -> Forecast {
        let groups = self.plan.groups();
        let cells = groups.iter().flat_map(ReferenceGroup::cells);
        let open: Vec<&Cell> = cells.filter(|cell| !self.is_done(cell)).collect();
        let is_kept = |group: &ReferenceGroup| {
            let id = group.reference?;
            let mut cells = group.cells();
            let first = cells.clone().find(|cell| !self.is_done(cell))?;
            let request = || {
                let point = self.plan.reference_point(&first.point);
                self.plan.least_reference(&point)
            };
            (cells.any(|cell| self.results.is_tried(cell)) || renderer.has_kept(&request()))
                .then_some(id)
        };
        let kept: Vec<Id> = groups.iter().filter_map(is_kept).collect();
        Forecast::new(self.plan, &open, &self.open_jobs(), kept)
    }

    fn ahead(&self) -> Ahead {
        self.forecast
            .as_ref()
            .map_or_else(Ahead::default, |forecast| {
                forecast.ahead(self.clock.elapsed().as_secs_f64())
            })
    }

    fn work(
        &mut self,
        renderer: &mut dyn Renderer,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let result = self
            .plan_files(renderer, progress)
            .and_then(|()| self.cells(renderer, progress))
            .and_then(|()| self.time(renderer, progress));
        for warning in renderer.take_warnings() {
            progress.note(&format!("warning: {warning}"));
        }
        result
    }

    /// Writes the files of the plan that do not exist. They come first, since a run whose cells are
    /// all done makes nothing more.
    fn plan_files(
        &self,
        renderer: &mut dyn Renderer,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        if !self.makes_plan_files() {
            return Ok(());
        }
        for file in self.options.companions.plan_files {
            let path = self.store.dir().join(file.name());
            if self.is_stopped() || path.exists() {
                continue;
            }
            match of_cell(file.text(self.plan, renderer).map_err(CellFault::from))? {
                Ok(text) => self.store.write_text(&path, &text)?,
                Err(reason) => progress.note(&format!("{}: {reason}", file.loss())),
            }
        }
        Ok(())
    }

    fn makes_plan_files(&self) -> bool {
        self.share.as_ref().is_none_or(|share| share.has_live)
    }

    fn remember(&mut self, cell: &Cell) {
        if let Some(forecast) = &mut self.forecast {
            forecast.finish(cell.id);
        }
        self.results.finish(cell.id);
    }

    fn fail(
        &mut self,
        cells: &[&Cell],
        reason: &str,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        for cell in cells {
            if self.is_done(cell) {
                continue;
            }
            let label = self.plan.label(cell);
            let record = FailureRecord {
                cell: cell.id,
                label: label.clone(),
                reason: reason.to_owned(),
            };
            self.store.write_failure(&record)?;
            self.results.fail(record);
            if let Some(forecast) = &mut self.forecast {
                forecast.finish(cell.id);
            }
            progress.step(&label, Some(reason), self.ahead());
            self.is_halted |= self.options.fail_fast;
        }
        Ok(())
    }

    fn failures(&self) -> Vec<FailureRecord> {
        let cells = self.plan.cells.iter();
        cells
            .filter_map(|cell| self.results.failure(cell))
            .cloned()
            .collect()
    }

    /// Writes the tables that are too long for memory.
    fn write_tables(&self) -> Result<(), RunError> {
        let errors = tables::errors(self.plan, &self.results, &self.store);
        self.store.write_table("errors.csv", errors)?;
        if self.plan.config.is_scored {
            let bins = tables::errors_by_n_dot_v(self.plan, &self.results, &self.store);
            self.store.write_table("errors_by_n_dot_v.csv", bins)?;
        }
        if self.plan.config.ladder.is_some() {
            let steps = tables::steps(self.plan, &self.results, &self.store);
            self.store.write_table("steps.csv", steps)?;
        }
        Ok(())
    }

    /// Writes tables and the companions' files.
    fn finish(mut self, has_worked: bool) -> Result<Outcome, RunError> {
        if self.share.is_some() {
            return Ok(self.outcome());
        }
        self.gather_sessions()?;
        for job in &self.jobs {
            self.timings
                .extend(self.store.timing::<TimingRecord>(job.id)?);
        }
        for cell in &self.plan.cells {
            if !self.results.is_tried(cell)
                && let Some(failure) = self.store.failure(cell.id)?
            {
                self.results.fail(failure);
            }
        }
        self.write_tables()?;
        if self.makes_recovery(has_worked) {
            let table = recovery::recovered(self.plan, &self.results, &self.store)?;
            self.store
                .write_table(RECOVERY_FILE, table.into_results())?;
        }
        if self.plan.config.timing.is_some() {
            let timings = tables::timings(&self.timings);
            self.store
                .write_table("timings.csv", timings.into_results())?;
        }
        let environments = environments::environments(self.plan);
        self.store
            .write_table("environments.csv", environments.into_results())?;
        let index = images::index(self.plan, &self.results);
        let index = csv::to_text(&index.columns, index.rows.iter().map(Vec::as_slice));
        let path = self.store.dir().join("images.csv");
        // Written last: if it is up to date, so are the companions' files.
        if has_worked || !holds(&path, &index) {
            for files in self.options.companions.result_files {
                files.write(&self.store, self.plan, &self.results)?;
            }
            self.store
                .write_text(&path, &String::from_utf8_lossy(&index))?;
        }
        Ok(self.outcome())
    }

    /// Whether this process fits materials: at the end of a whole run, unless they are up to date.
    fn makes_recovery(&self, has_worked: bool) -> bool {
        let is_asked = self.plan.config.recovery.is_some() && self.share.is_none();
        let is_new = || has_worked || !self.store.dir().join(RECOVERY_FILE).exists();
        is_asked && !self.is_stopped() && is_new()
    }

    fn outcome(self) -> Outcome {
        Outcome {
            dir: self.store.dir().to_owned(),
            cell_count: self.share_cells().count(),
            failures: self.failures(),
            is_stopped: self.is_stopped() && self.steps_left() > 0,
            timings: self.timings,
        }
    }
}

/// Whether this process renders the cell.
fn is_in_share(share: &Option<Share>, cell: &Cell) -> bool {
    share
        .as_ref()
        .is_none_or(|share| share.cells.contains(&cell.id))
}

/// The outer error ends the run, the inner one fails the cell.
fn of_cell<T>(result: Result<T, CellFault>) -> Result<Result<T, String>, RunError> {
    match result {
        Ok(value) => Ok(Ok(value)),
        Err(CellFault::Cell(reason)) => Ok(Err(reason)),
        Err(CellFault::Store(error)) => Err(error.into()),
        Err(CellFault::Lost(reason)) => Err(RunError::DeviceLost(reason)),
    }
}
