//! One chunk of a plan file.

use super::ChunkError;
use super::file::PlanFile;
use super::split::Chunk;
use super::store::{Attempt, ChunkStore};
use crate::runner::live::LIVE_FILE;
use crate::runner::plan::Plan;
use crate::runner::run::{MakeRenderer, Progress, RunOptions, Share, run_share};
use crate::runner::store::FailureRecord;
use crate::runner::timing;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

/// How a chunk is to be done.
#[derive(Debug)]
pub struct ChunkOptions<'a> {
    /// The plan file, as the user named it.
    pub plan_file: PathBuf,
    pub chunk: usize,
    /// The folder that all chunks share.
    pub store: PathBuf,
    /// Set from outside to stop after the current cell.
    pub stop: &'a AtomicBool,
    /// The command line, for the provenance.
    pub command_line: Vec<String>,
    /// Ends the chunk at the first cell that fails.
    pub fail_fast: bool,
}

/// The outcome of a chunk.
#[derive(Debug)]
pub struct ChunkOutcome {
    /// Cells of the chunk.
    pub cell_count: usize,
    /// Cells without a record, each with its reason.
    pub failures: Vec<FailureRecord>,
    pub is_stopped: bool,
}

/// Does what no earlier attempt at the chunk has done.
pub fn run_chunk(
    file: &PlanFile,
    plan: &Plan,
    make_renderer: &mut MakeRenderer,
    options: &ChunkOptions,
    progress: &mut dyn Progress,
) -> Result<ChunkOutcome, ChunkError> {
    let chunk = file.chunks.get(options.chunk).ok_or_else(|| ChunkError::NoSuchChunk {
        path: options.plan_file.clone(),
        chunk: options.chunk,
        last: file.chunks.len().saturating_sub(1),
    })?;
    let store = ChunkStore::open(&options.store, file, plan)?;
    let attempts = store.attempts(chunk.index)?;
    let share = left(chunk, plan, &attempts)?;
    let step_count = chunk.cells.len() + chunk.timings.len();
    let done = step_count - share.cells.len() - share.timings.len();
    if done > 0 {
        progress.note(&format!("{done} of {step_count} steps of chunk {} are done already", chunk.index));
    }
    if done == step_count {
        return Ok(ChunkOutcome { cell_count: chunk.cells.len(), failures: Vec::new(), is_stopped: false });
    }
    let attempt = store.begin(chunk.index)?;
    let run_options = RunOptions {
        dir: attempt.store.dir().to_owned(),
        stop: options.stop,
        command_line: options.command_line.clone(),
        fail_fast: options.fail_fast,
        trace: false,
    };
    let (failures, is_stopped) = work(attempt, plan, &share, make_renderer, &run_options, progress)?;
    Ok(ChunkOutcome { cell_count: chunk.cells.len(), failures, is_stopped })
}

/// The work that no attempt has finished: a record that is not whole counts for nothing. A block of timings counts when one attempt holds all of it: its samples belong together.
fn left(chunk: &Chunk, plan: &Plan, attempts: &[Attempt]) -> Result<Share, ChunkError> {
    let mut share = Share { cells: chunk.cells.iter().cloned().collect(), timings: BTreeSet::new(), has_live: false };
    let mut blocks = chunk.blocks(&timing::jobs(plan));
    for attempt in attempts {
        for id in attempt.ids("cells")? {
            if attempt.store.cell(&id)?.is_some() {
                share.cells.remove(&id);
            }
        }
        let timings = attempt.ids("timings")?.into_iter();
        let timed: BTreeSet<String> = timings.filter(|id| attempt.store.has_timing(id)).collect();
        blocks.retain(|block| !block.iter().all(|id| timed.contains(id)));
    }
    // One chunk does it for all; the run is whole without it.
    share.has_live = chunk.index == 0 && attempts.iter().all(|attempt| !attempt.store.dir().join(LIVE_FILE).exists());
    share.timings = blocks.into_iter().flatten().collect();
    Ok(share)
}

/// Works, and notes in the attempt's folder how that ended, whatever way it did.
fn work(
    mut attempt: Attempt,
    plan: &Plan,
    share: &Share,
    make_renderer: &mut MakeRenderer,
    options: &RunOptions,
    progress: &mut dyn Progress,
) -> Result<(Vec<FailureRecord>, bool), ChunkError> {
    let mut noted = Noted { inner: progress, failures: Vec::new() };
    let result = run_share(plan, share, attempt.store.clone(), make_renderer, options, &mut noted);
    let fault = match &result {
        Ok((_, is_stopped)) => is_stopped.then(|| "stopped by the user".to_owned()),
        Err(error) => Some(error.to_string()),
    };
    let ended = attempt.end(fault, noted.failures);
    // What went wrong first is what the user must know: a full disk takes no last words either.
    let outcome = result?;
    ended?;
    Ok(outcome)
}

/// Keeps what failed while it passes everything on.
struct Noted<'a> {
    inner: &'a mut dyn Progress,
    failures: Vec<(String, String)>,
}

impl Progress for Noted<'_> {
    fn start(&mut self, total: usize, done: usize) {
        self.inner.start(total, done);
    }

    fn step(&mut self, label: &str, failure: Option<&str>) {
        self.failures.extend(failure.map(|reason| (label.to_owned(), reason.to_owned())));
        self.inner.step(label, failure);
    }

    fn note(&mut self, text: &str) {
        self.inner.note(text);
    }
}
