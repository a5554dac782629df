//! Runs a plan: renders each reference and each radiance once, scores every cell, keeps records, writes tables.

use super::axis::Point;
use super::images;
use super::plan::{Cell, Plan, ReferenceGroup};
use super::provenance;
use super::renderer::{RenderFault, Renderer};
use super::store::{BinRecord, CellRecord, Exact, FailureRecord, Scores, Store, StoreError};
use super::summary;
use super::tables::{self, CellResult, FLOORED, HEADLINE, Results, metric_names};
use super::timing::{self, PassSamples, TimingJob, TimingRecord};
use crate::metrics::{Comparison, METRICS, N_DOT_V_BIN_EDGES, metric, noise_floor, verdict};
use crate::pipeline::{DeviceInfo, Frame};
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
    let store = Store::open(&options.dir, plan)?;
    let mut run = Run::load(plan, store, options)?;
    let steps_left = run.steps_left();
    progress.start(plan.cells.len() + run.jobs.len(), plan.cells.len() + run.jobs.len() - steps_left);
    if steps_left > 0 {
        let renderer = make_renderer().map_err(fault_error)?;
        run.begin_session(&renderer.device())?;
        let result = run.work(renderer, progress);
        // What is done is kept also when the device was lost.
        run.write_tables()?;
        result?;
    }
    run.finish(steps_left > 0)
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
}

/// A rendered reference with what is computed from it once.
struct ReferenceFrame {
    frame: Frame,
    /// Score of an exact test by metric, where it is known.
    noise_floors: Vec<(&'static str, f64)>,
}

impl<'p> Run<'p> {
    fn load(plan: &'p Plan, store: Store, options: &'p RunOptions<'p>) -> Result<Self, RunError> {
        let mut results = Results::new();
        for cell in &plan.cells {
            if let Some(record) = store.cell(&cell.id)? {
                results.insert(cell.id.clone(), CellResult::Done(record));
            }
        }
        let jobs = timing::jobs(plan);
        Ok(Self { plan, store, options, results, jobs, timings: Vec::new(), tables_written: Instant::now() })
    }

    fn is_done(&self, cell: &Cell) -> bool {
        matches!(self.results.get(&cell.id), Some(CellResult::Done(_)))
    }

    fn is_stopped(&self) -> bool {
        self.options.stop.load(Ordering::Relaxed)
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
        let plan = self.plan;
        for group in plan.groups() {
            self.group(&group, renderer.as_mut(), progress)?;
        }
        for index in 0..self.jobs.len() {
            self.time(index, renderer.as_mut(), progress)?;
        }
        Ok(())
    }

    /// All cells of one reference that are not done.
    fn group(
        &mut self,
        group: &ReferenceGroup<'p>,
        renderer: &mut dyn Renderer,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let started = Instant::now();
        let todo = group.radiances.iter().flat_map(|(_, cells)| cells).find(|cell| !self.is_done(cell));
        let (Some(first), false) = (todo.copied(), self.is_stopped()) else { return Ok(()) };
        let point = first.point.reference(&self.plan.config.reference);
        let reference = match self.reference(group.id, &point, renderer)? {
            Ok(reference) => reference,
            Err(reason) => {
                let cells: Vec<&Cell> = group.radiances.iter().flat_map(|(_, cells)| cells).copied().collect();
                return self.fail(&cells, &format!("its reference: {reason}"), progress);
            }
        };
        // Shared work is counted with the first cell that needs it.
        let mut shared_ms = milliseconds(started);
        for (id, cells) in &group.radiances {
            let todo: Vec<&Cell> = cells.iter().copied().filter(|cell| !self.is_done(cell)).collect();
            if todo.is_empty() {
                continue;
            }
            if self.is_stopped() {
                return Ok(());
            }
            let started = Instant::now();
            let frame = if *id == group.id {
                Ok(reference.frame.clone())
            } else {
                match self.render(&todo[0].point, renderer)? {
                    Ok(frame) => self.keep_radiance(&todo[0].point, id, &frame).map(|()| frame),
                    Err(reason) => Err(reason),
                }
            };
            shared_ms += milliseconds(started);
            for cell in todo {
                if self.is_stopped() {
                    return Ok(());
                }
                let started = Instant::now();
                let scored = match &frame {
                    Ok(frame) => self.score(cell, frame, &reference, renderer)?,
                    Err(reason) => Err(reason.clone()),
                };
                match scored {
                    Ok(record) => {
                        let record = CellRecord { wall_ms: shared_ms + milliseconds(started), ..record };
                        self.store.write_cell(&record)?;
                        self.results.insert(cell.id.clone(), CellResult::Done(record));
                        progress.step(&self.plan.label(cell), None);
                    }
                    Err(reason) => self.fail(&[cell], &reason, progress)?,
                }
                shared_ms = 0.0;
                self.write_tables_sometimes()?;
            }
        }
        Ok(())
    }

    /// Renders a point. The outer error ends the run, the inner one fails the cells that need the image.
    fn render(&self, point: &Point, renderer: &mut dyn Renderer) -> Result<Result<Frame, String>, RunError> {
        cell_result(renderer.render(&self.plan.request(point)))
    }

    fn reference(
        &self,
        id: &str,
        point: &Point,
        renderer: &mut dyn Renderer,
    ) -> Result<Result<ReferenceFrame, String>, RunError> {
        let frame = match self.render(point, renderer)? {
            Ok(frame) => frame,
            Err(reason) => return Ok(Err(reason)),
        };
        if let Err(reason) = self.keep_radiance(point, id, &frame) {
            return Ok(Err(reason));
        }
        let floors = match &frame.standard_error {
            Some(standard_error) => noise_floor(&frame.radiance, standard_error, &frame.mask),
            None => Ok(Vec::new()),
        };
        Ok(floors.map_err(|error| error.to_string()).map(|floors| ReferenceFrame {
            noise_floors: floors.into_iter().filter_map(|(name, floor)| Some((name, floor?))).collect(),
            frame,
        }))
    }

    fn keep_radiance(&self, point: &Point, id: &str, frame: &Frame) -> Result<(), String> {
        let path = self.store.image_path(&images::radiance_name(self.plan, point, id));
        images::write_radiance(&path, frame).map_err(|error| error.to_string())
    }

    /// Scores one cell and writes its pictures.
    fn score(
        &self,
        cell: &Cell,
        frame: &Frame,
        reference: &ReferenceFrame,
        renderer: &mut dyn Renderer,
    ) -> Result<Result<CellRecord, String>, RunError> {
        let curve = cell.point.settings().curve;
        let mut picture = |frame: &Frame| cell_result(renderer.tonemap(&frame.radiance, curve));
        let (test_picture, reference_picture) = match (picture(frame)?, picture(&reference.frame)?) {
            (Ok(test), Ok(reference)) => (test, reference),
            (Err(reason), _) | (_, Err(reason)) => return Ok(Err(reason)),
        };
        let device = renderer.device();
        let compute = || -> Result<CellRecord, String> {
            let mask = &reference.frame.mask;
            let comparison = Comparison::new(&frame.radiance, &reference.frame.radiance, mask, curve)
                .map_err(|error| error.to_string())?;
            let scores = by_name(comparison.evaluate_all());
            let bins = comparison
                .evaluate_bins(&reference.frame.n_dot_v, &N_DOT_V_BIN_EDGES, METRICS)
                .map_err(|error| error.to_string())?;
            let noise_floors = by_name(reference.noise_floors.clone());
            let pictures = images::CellPictures {
                test: &test_picture,
                reference: &reference_picture,
                error: &images::error_picture(&comparison, mask),
            };
            pictures.write(&self.store, self.plan, cell).map_err(|error| error.to_string())?;
            Ok(CellRecord {
                cell: cell.id.clone(),
                axes: self.plan.columns_of(cell).iter().map(|(n, v)| (n.to_string(), v.to_string())).collect(),
                verdict: verdict_name(&scores, &noise_floors),
                noise_floors: noise_floors.into_iter().filter(|(n, _)| FLOORED.contains(&n.as_str())).collect(),
                scores,
                bins: bins
                    .into_iter()
                    .map(|b| BinRecord { lo: b.lo, hi: b.hi, pixel_count: b.pixel_count, scores: by_name(b.values) })
                    .collect(),
                device: device.name.clone(),
                driver: device.driver.clone(),
                wall_ms: 0.0,
            })
        };
        Ok(compute())
    }

    fn fail(&mut self, cells: &[&Cell], reason: &str, progress: &mut dyn Progress) -> Result<(), RunError> {
        for cell in cells.iter().filter(|cell| !self.is_done(cell)).copied().collect::<Vec<_>>() {
            let label = self.plan.label(cell);
            let record = FailureRecord { cell: cell.id.clone(), label: label.clone(), reason: reason.to_owned() };
            self.store.write_failure(&record)?;
            self.results.insert(cell.id.clone(), CellResult::Failed(record));
            progress.step(&label, Some(reason));
        }
        Ok(())
    }

    /// Times one configuration unless it is done. A failure is a note: the errors do not depend on it.
    fn time(&mut self, index: usize, renderer: &mut dyn Renderer, progress: &mut dyn Progress) -> Result<(), RunError> {
        let job = &self.jobs[index];
        let (Some(timing), false) = (self.plan.config.timing, self.is_stopped()) else { return Ok(()) };
        if self.store.has_timing(&job.id) {
            return Ok(());
        }
        let request = self.plan.request(&job.cell.point);
        let samples = match job.phase {
            timing::PRECOMPUTE => renderer.time_precompute(&request, timing.warmup, timing.rounds),
            _ => renderer.time(&request, timing.warmup, timing.rounds),
        };
        let label = format!("timing {} {}", job.phase, self.plan.label(job.cell));
        match cell_result(samples)? {
            Ok(samples) => {
                let device = renderer.device();
                let record = TimingRecord {
                    cell: job.cell.id.clone(),
                    phase: job.phase.to_owned(),
                    environment_size: job.environment_size,
                    size: self.plan.config.size,
                    axes: job.axes.clone(),
                    warmup: timing.warmup,
                    passes: samples
                        .passes
                        .into_iter()
                        .map(|(pass, ms)| PassSamples { pass: pass.to_owned(), ms })
                        .collect(),
                    wall_ms: samples.wall_ms,
                    device: device.name,
                    device_type: device.device_type.to_owned(),
                    driver: device.driver,
                };
                self.store.write_timing(&job.id, &record)?;
                progress.step(&label, None);
            }
            Err(reason) => progress.step(&label, Some(&reason)),
        }
        Ok(())
    }

    fn write_tables_sometimes(&mut self) -> Result<(), RunError> {
        if self.tables_written.elapsed() >= TABLE_INTERVAL { self.write_tables() } else { Ok(()) }
    }

    fn write_tables(&mut self) -> Result<(), RunError> {
        let (columns, rows) = tables::errors(self.plan, &self.results);
        self.store.write_table("errors.csv", &columns, &rows)?;
        let (columns, rows) = tables::errors_by_n_dot_v(self.plan, &self.results);
        self.store.write_table("errors_by_n_dot_v.csv", &columns, &rows)?;
        self.tables_written = Instant::now();
        Ok(())
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
        self.store.write_table("images.csv", &columns, &rows)?;
        if self.plan.config.timing.is_some() {
            let (columns, rows) = tables::timings(&self.timings);
            self.store.write_table("timings.csv", &columns, &rows)?;
        }
        let summary = summary::markdown(self.plan, &self.results, &self.timings);
        let summary_path = self.store.dir().join("summary.md");
        if has_worked || std::fs::read_to_string(&summary_path).ok().as_deref() != Some(&summary) {
            images::write_sheets(&self.store, self.plan, &self.results)?;
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

fn by_name(values: Vec<(&'static str, f64)>) -> Scores {
    values.into_iter().map(|(name, value)| (name.to_owned(), Exact(value))).collect()
}

/// The verdict of the headline metric; `no-noise-floor` when the reference does not know its own error.
fn verdict_name(scores: &Scores, floors: &Scores) -> String {
    let metric = metric(HEADLINE).expect("the headline is one of the metrics");
    debug_assert!(FLOORED.iter().all(|name| metric_names().contains(name)));
    match (scores.get(HEADLINE), floors.get(HEADLINE)) {
        (Some(score), Some(floor)) => verdict(metric, score.0, floor.0).name().to_owned(),
        _ => "no-noise-floor".to_owned(),
    }
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}
