//! What a run is to do and what comes of it.

use crate::pipeline::{SharedWork, Tally};
use crate::run::estimate::Ahead;
use crate::run::provenance::ProvenanceError;
use crate::run::renderer::RenderFault;
use crate::run::shard::Shard;
use crate::run::store::{FailureRecord, StoreError};
use crate::run::timing::TimingRecord;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// How a run is to be done.
#[derive(Debug)]
pub struct RunOptions<'a> {
    /// The folder of the run.
    pub dir: PathBuf,
    /// Set from outside to stop after the current cell.
    pub stop: &'a AtomicBool,
    /// The command line, for the provenance.
    pub command_line: Vec<String>,
    /// The part of the plan to do, where several processes share the folder. Tables are then left to [`merge`].
    pub shard: Option<Shard>,
    /// The file with the speeds of earlier runs, which forecast the time of this one.
    pub speeds: Option<PathBuf>,
    /// Ends the run at the first cell that fails, instead of going on with the others.
    pub fail_fast: bool,
    /// Writes the timed passes as a Chrome trace, `trace.json`.
    pub trace: bool,
}

impl<'a> RunOptions<'a> {
    /// A whole run in `dir`, without what can be left out.
    pub fn new(dir: &Path, stop: &'a AtomicBool) -> Self {
        let command_line = Vec::new();
        Self { dir: dir.to_owned(), stop, command_line, shard: None, speeds: None, fail_fast: false, trace: false }
    }
}

/// Follows a run.
pub trait Progress {
    /// The run has `total` steps (cells and timed configurations), `done` of them from earlier.
    fn start(&mut self, total: usize, done: usize, ahead: Ahead);
    /// A step ended; `failure` says why it failed.
    fn step(&mut self, label: &str, failure: Option<&str>, ahead: Ahead);
    /// A line for the user.
    fn note(&mut self, text: &str);
}

/// Why a run ended early.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error("the device was lost: {0}; what is done is kept, run the same command again to go on")]
    DeviceLost(String),
    /// One sentence for each file.
    #[error(
        "records or images are damaged or missing, so nothing was merged; run their shards again, which renders them again, then merge:\n{}",
        .0.join("\n")
    )]
    Damaged(Vec<String>),
    /// The renderer could not be made.
    #[error("{0}")]
    NoRenderer(String),
}

impl From<ProvenanceError> for RunError {
    fn from(error: ProvenanceError) -> Self {
        Self::Store(error.into())
    }
}

impl From<RenderFault> for RunError {
    fn from(fault: RenderFault) -> Self {
        if fault.device_lost { Self::DeviceLost(fault.message) } else { Self::NoRenderer(fault.message) }
    }
}

/// The outcome of a run.
#[derive(Debug)]
pub struct Outcome {
    pub dir: PathBuf,
    /// Cells of the plan, or of the shard.
    pub cell_count: usize,
    pub timings: Vec<TimingRecord>,
    /// Cells without a record, each with its reason.
    pub failures: Vec<FailureRecord>,
    /// Whether it was stopped before all steps were tried.
    pub is_stopped: bool,
    /// The work of this invocation; nothing where all was done before.
    pub work: Option<Work>,
}

/// Time and shared work of an invocation.
#[derive(Clone, Debug, Default)]
pub struct Work {
    /// Host time in which the device worked or was waited for, ms.
    pub waited_ms: f64,
    pub shared: SharedWork,
    /// References that an earlier invocation had left in the run's folder.
    pub references_read_back: usize,
}

impl Work {
    /// One line for the user, after `wall_ms` of the whole invocation.
    pub fn line(&self, wall_ms: f64) -> String {
        let mut made = Vec::new();
        for (kind, Tally { made: count, read }) in &self.shared {
            let from_disk = if *read > 0 { format!(" (and {read} from the cache)") } else { String::new() };
            made.push(format!("{kind} {count}{from_disk}"));
        }
        if self.references_read_back > 0 {
            made.push(format!("references of the run read back {}", self.references_read_back));
        }
        format!(
            "{:.1} s, {:.0} % of it without the device. Made once and shared: {}",
            wall_ms / 1e3,
            100.0 * (1.0 - self.waited_ms / wall_ms).max(0.0),
            if made.is_empty() { "nothing".to_owned() } else { made.join(", ") }
        )
    }
}
