//! `splitsum merge`.

use super::progress;
use super::run::{command_line, conclude};
use super::shared::InputFlags;
use super::stop::STOP;
use super::{Failure, log};
use clap::Args;
use splitsum::report::COMPANIONS;
use splitsum::run::frozen::{self, EXPERIMENT_FILE};
use splitsum::run::store::StoreError;
use splitsum::run::{Merged, RunOptions, merge, provenance};
use std::path::PathBuf;

/// Write the tables, answers and report of a run made by shards.
#[derive(Args, Debug)]
#[command(
    after_help = "The folder then equals the folder of one `splitsum run`. Exit codes: 0 complete; \
                  1 a record or an image is damaged; 2 not \
    a run; 4 cells failed or are missing, listed with commands to render them; 75 a shard is still \
    running.\n\n\
    Example:\n  splitsum run sweep.toml --shard 1/2 --out /shared/sweep   (and 2/2, on any \
    machine, in any order)\n  \
    splitsum merge /shared/sweep"
)]
pub struct Arguments {
    /// Merge the shards of this folder.
    #[arg(value_name = "DIR")]
    dir: PathBuf,
    #[command(flatten)]
    inputs: InputFlags,
}

const NAMED_CELLS: usize = 3;

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let dir = &arguments.dir;
    progress::doing("checking records and images");
    if provenance::read(dir).map_err(Failure::input)?.is_none() {
        let why = "contains no run; expected the --out of `splitsum run --shard`".to_owned();
        return Err(Failure::input(StoreError::Refused {
            dir: dir.clone(),
            why,
        }));
    }
    let (plan, _) = frozen::load(
        &dir.join(EXPERIMENT_FILE),
        &[],
        &arguments.inputs.options(),
        |_, _| {},
    )
    .map_err(Failure::input)?;
    let options = RunOptions {
        command_line: command_line(),
        companions: COMPANIONS,
        ..RunOptions::new(dir, &STOP)
    };
    let merged = merge(&plan, &options)?;
    merged
        .notes
        .iter()
        .for_each(|note| log(&format!("warning: {note}")));
    let failed = conclude(&plan, &merged.outcome)?;
    let missing = missing(arguments, &merged);
    match (missing, failed) {
        (None, failed) => failed.map_or(Ok(()), Err),
        (Some(text), None) => Err(Failure::cells_failed(text)),
        (Some(text), Some(failed)) => {
            Err(Failure::cells_failed(format!("{text}\n{}", failed.text)))
        }
    }
}

/// Lists missing cells, with the commands that render them.
fn missing(arguments: &Arguments, merged: &Merged) -> Option<String> {
    let missing = &merged.missing;
    let dir = arguments.dir.display();
    let cells = missing.cells.len();
    if cells + missing.timings == 0 {
        return None;
    }
    let all = merged.outcome.cell_count;
    let mut lines = vec![format!(
        "{cells} of {all} cells and {} timed configurations are missing:",
        missing.timings
    )];
    lines.extend(
        missing
            .cells
            .iter()
            .take(NAMED_CELLS)
            .map(|label| format!("  {label}")),
    );
    lines.extend(
        cells
            .checked_sub(NAMED_CELLS)
            .filter(|more| *more > 0)
            .map(|more| format!("  {more} more")),
    );
    let flags = arguments.inputs.text();
    let run = format!("splitsum run {dir}/{EXPERIMENT_FILE}{flags} --out {dir}");
    let shards = missing
        .shards
        .iter()
        .map(|(shard, end)| format!("shard {shard}, {end}: {run} --shard {shard}"));
    lines.extend(shards);
    if missing.shards.is_empty() {
        lines.push(format!("to render them: {run}"));
    }
    Some(lines.join("\n"))
}
