//! The options and the outcome of a run.

use crate::run::companion::Companions;
use crate::run::estimate::Ahead;
use crate::run::provenance::ProvenanceError;
use crate::run::renderer::RenderFault;
use crate::run::shard::Shard;
use crate::run::store::{FailureRecord, StoreError};
use crate::run::timing::TimingRecord;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

#[derive(Debug)]
pub struct RunOptions<'a> {
    pub dir: PathBuf,
    /// Set from outside: stops after the current cell.
    pub stop: &'a AtomicBool,
    pub command_line: Vec<String>,
    /// The part of the plan to do, if several processes share the folder. [`merge`](super::merge)
    /// then writes the tables.
    pub shard: Option<Shard>,
    /// Ends the run at the first cell that fails.
    pub fail_fast: bool,
    /// Files of the report that the run leaves in its folder.
    pub companions: Companions<'a>,
}

impl<'a> RunOptions<'a> {
    /// A whole run in `dir` with defaults, without companions.
    pub fn new(dir: &Path, stop: &'a AtomicBool) -> Self {
        let command_line = Vec::new();
        Self {
            dir: dir.to_owned(),
            stop,
            command_line,
            shard: None,
            fail_fast: false,
            companions: Companions::default(),
        }
    }
}

/// Reports the progress of a run.
pub trait Progress {
    /// The run has `total` steps (cells and timed configurations), of which `done` are finished.
    fn start(&mut self, total: usize, done: usize, ahead: Ahead);
    /// A step ended; `failure` says why it failed.
    fn step(&mut self, label: &str, failure: Option<&str>, ahead: Ahead);
    /// Finished steps count as open again.
    fn open_again(&mut self, _count: usize) {}
    /// A line for the user.
    fn note(&mut self, text: &str);
}

#[derive(Debug, thiserror::Error)]
pub enum RunError {
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(
        "the device was lost: {0}; finished cells are kept: run the same command again to continue"
    )]
    DeviceLost(String),
    #[error(
        "nothing was merged: records or images are damaged or missing; run their shards again, \
         then merge:\n{}",
        .0.join("\n")
    )]
    Damaged(Vec<String>),
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
        if fault.device_lost {
            Self::DeviceLost(fault.message)
        } else {
            Self::NoRenderer(fault.message)
        }
    }
}

#[derive(Debug)]
pub struct Outcome {
    pub dir: PathBuf,
    /// Cells of the plan, or of the shard.
    pub cell_count: usize,
    pub timings: Vec<TimingRecord>,
    /// Cells that failed.
    pub failures: Vec<FailureRecord>,
    /// Whether some steps were not tried.
    pub is_stopped: bool,
}
