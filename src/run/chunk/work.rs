//! One chunk of a plan file.

use super::ChunkError;
use super::file::PlanFile;
use super::split::Chunk;
use super::store::{Attempt, ChunkStore};
use crate::experiment::plan::Plan;
use crate::run::execute::{MakeRenderer, Progress, RunOptions, Share, ShareOutcome, run_share};
use crate::run::live::LIVE_FILE;
use crate::run::store::CELLS_FOLDER;
use crate::run::timing;
use std::collections::BTreeSet;

/// Does what no earlier attempt at a chunk has done. The folder of the options is the one that all chunks share.
pub fn run_chunk(
    file: &PlanFile,
    plan: &Plan,
    chunk: usize,
    make_renderer: &mut MakeRenderer,
    options: &RunOptions,
    progress: &mut dyn Progress,
) -> Result<ShareOutcome, ChunkError> {
    let last = file.chunks.len().saturating_sub(1);
    let chunk = file.chunks.get(chunk).ok_or(ChunkError::NoSuchChunk { chunk, last })?;
    let store = ChunkStore::open(&options.dir, file, plan)?;
    let attempts = store.attempts(chunk.index)?;
    let share = left(chunk, plan, &attempts)?;
    let step_count = chunk.cells.len() + chunk.timings.len();
    let done = step_count - share.cells.len() - share.timings.len();
    if done > 0 {
        progress.note(&format!("{done} of {step_count} steps of chunk {} are done already", chunk.index));
    }
    if done == step_count {
        return Ok(ShareOutcome::default());
    }
    let mut attempt = store.begin(chunk.index)?;
    let mut noted = Noted { inner: progress, failures: Vec::new() };
    let result = run_share(plan, &share, attempt.store.clone(), make_renderer, options, &mut noted);
    let fault = match &result {
        Ok(outcome) => outcome.is_stopped.then(|| "stopped by the user".to_owned()),
        Err(error) => Some(error.to_string()),
    };
    let ended = attempt.end(fault, noted.failures);
    // What went wrong first is what the user must know: a full disk takes no last words either.
    let outcome = result?;
    ended?;
    Ok(outcome)
}

/// The work that no attempt has finished: a record that is not whole counts for nothing. A block of timings counts when one attempt holds all of it: its samples belong together.
fn left(chunk: &Chunk, plan: &Plan, attempts: &[Attempt]) -> Result<Share, ChunkError> {
    let mut share = Share { cells: chunk.cells.iter().cloned().collect(), timings: BTreeSet::new(), has_live: false };
    let mut blocks = chunk.blocks(&timing::jobs(plan));
    for attempt in attempts {
        for id in attempt.store.ids(CELLS_FOLDER) {
            if attempt.store.cell(&id)?.is_some() {
                share.cells.remove(&id);
            }
        }
        blocks.retain(|block| !block.iter().all(|id| attempt.store.has_timing(id)));
    }
    // One chunk does it for all; the run is whole without it.
    share.has_live = chunk.index == 0 && attempts.iter().all(|attempt| !attempt.store.dir().join(LIVE_FILE).exists());
    share.timings = blocks.into_iter().flatten().collect();
    Ok(share)
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
