//! `splitsum merge`.

use super::run::{command_line, conclude};
use super::stop::STOP;
use super::{Failure, tell};
use clap::Args;
use splitsum::run::RunOptions;
use splitsum::run::chunk::{Hole, PlanFile, merge};
use std::fmt::Write;
use std::path::PathBuf;

/// Makes one run of the chunks of a plan file.
#[derive(Args, Debug)]
#[command(
    after_help = "The folder is what `splitsum run` would have left on one machine. What is missing is named with the chunk to run \
    again, and the exit code is 4. Cells that were done twice on one device must agree.\n\n\
    Example:\n  splitsum plan sweep.toml --chunk-seconds 60 --out plan.json\n  \
    splitsum run --plan plan.json --chunk 0 --store shared/sweep     # and every other chunk, anywhere\n  \
    splitsum merge --plan plan.json --store shared/sweep"
)]
pub struct Arguments {
    /// The plan file that `splitsum plan --chunk-seconds` wrote.
    #[arg(long, value_name = "FILE")]
    plan: PathBuf,
    /// The folder that the chunks share.
    #[arg(long, value_name = "DIR")]
    store: PathBuf,
    /// Folder of the run to make; the store itself when left out.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Writes the timed passes to trace.json, which Perfetto opens (needs [timing] in the experiment).
    #[arg(long)]
    trace: bool,
}

/// Cells that are named for each hole.
const NAMED_CELLS: usize = 3;

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let (file, plan) = PlanFile::load(&arguments.plan)?;
    let options = RunOptions {
        dir: arguments.out.clone().unwrap_or_else(|| arguments.store.clone()),
        stop: &STOP,
        command_line: command_line(),
        fail_fast: false,
        trace: arguments.trace,
    };
    let merged = merge(&file, &plan, &arguments.store, &options)?;
    for note in &merged.notes {
        tell(&format!("warning: {note}"));
    }
    let failed = conclude(&plan, &merged.outcome)?;
    if merged.holes.is_empty() {
        return failed.map_or(Ok(()), Err);
    }
    let cells: usize = merged.holes.iter().map(|hole| hole.cells.len()).sum();
    let blocks: usize = merged.holes.iter().map(|hole| hole.block_count).sum();
    let mut text = format!("{cells} of {} cells and {blocks} blocks of timings are missing:\n", plan.cells.len());
    for hole in &merged.holes {
        let _ = writeln!(text, "{}", words(hole));
    }
    let (plan, store) = (arguments.plan.display(), arguments.store.display());
    for hole in &merged.holes {
        let _ = writeln!(text, "to fill it: splitsum run --plan {plan} --chunk {} --store {store}", hole.chunk);
    }
    text.extend(failed.map(|failure| failure.text));
    Err(Failure::cells_failed(text.trim_end().to_owned()))
}

fn words(hole: &Hole) -> String {
    let mut what: Vec<String> =
        hole.cells.iter().take(NAMED_CELLS).map(|(id, label)| format!("{id} {label}")).collect();
    if let Some(more) = hole.cells.len().checked_sub(NAMED_CELLS).filter(|more| *more > 0) {
        what.push(format!("{more} more cells"));
    }
    if hole.block_count > 0 {
        what.push(format!("{} blocks of timings", hole.block_count));
    }
    format!("  chunk {} ({}): {}", hole.chunk, hole.last, what.join("; "))
}
