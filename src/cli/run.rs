//! `splitsum run`.

use super::cache::CacheArguments;
use super::progress::Terminal;
use super::{Failure, print};
use clap::Args;
use splitsum::environment::LoadOptions;
use splitsum::experiment::{Plan, Progress, RenderFault, Renderer, RunOptions, run};
use splitsum::pipeline::{DeviceChoice, Options, Pipeline};
use splitsum::report::ReportOptions;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Runs an experiment, or what is left of it.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = "A run that was stopped (Ctrl-C, a crash, a full disk) goes on where it stopped: give the same command again.\n\n\
    Examples:\n  splitsum run experiments/quick.toml\n  \
    splitsum run experiments/quick.toml --set alpha=0.1,0.5 --set brdf=ggx --out runs/short\n  \
    splitsum run experiments/real.toml --set environment=sky.hdr --set scene=teapot.obj --out runs/teapot"
)]
pub struct Arguments {
    /// The experiment file.
    experiment: PathBuf,
    /// Folder of the run; runs/NAME when left out.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replaces the values of an axis, as axis=v1,v2. Paths are relative to the current folder.
    #[arg(long = "set", value_name = "AXIS=VALUES")]
    overrides: Vec<String>,
    /// Sets NaN, infinite and negative texels of environments to 0, with a warning, instead of refusing them.
    #[arg(long)]
    clamp_invalid: bool,
    /// Ends the run at the first cell that fails; without it the others are still done.
    #[arg(long)]
    fail_fast: bool,
    /// Writes the timed passes to trace.json, which Perfetto opens (needs [timing] in the experiment).
    #[arg(long)]
    trace: bool,
    #[command(flatten)]
    cache: CacheArguments,
    /// Index of the device, as `splitsum devices` lists them.
    #[arg(long, value_name = "N")]
    device: Option<usize>,
}

/// Set by Ctrl-C. The second Ctrl-C ends the process at once.
static STOP: AtomicBool = AtomicBool::new(false);
/// What shells report for a process ended by SIGINT.
const EXIT_INTERRUPTED: i32 = 130;

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let started = Instant::now();
    let plan = load_plan(&arguments.experiment, &arguments.overrides, arguments.clamp_invalid)?;
    if plan.cells.is_empty() {
        return Err(Failure::NothingToDo(format!("{}: no cell is left", arguments.experiment.display())));
    }
    let mut progress = Terminal::default();
    for warning in plan.inputs.warnings() {
        progress.note(&format!("warning: {warning}"));
    }
    for why in plan.idle_exclusions() {
        progress.note(&format!("warning: the exclusion \"{why}\" matches no cell"));
    }
    ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(EXIT_INTERRUPTED);
        }
        eprintln!("\nstopping after the current cell (Ctrl-C again: at once)");
    })
    .map_err(|error| Failure::Failed(format!("Ctrl-C cannot be handled: {error}")))?;

    let options = RunOptions {
        dir: default_dir(&plan, arguments.out.as_ref()),
        stop: &STOP,
        command_line: std::env::args().collect(),
        fail_fast: arguments.fail_fast,
        trace: arguments.trace,
    };
    let mut open = || -> Result<Box<dyn Renderer>, RenderFault> {
        let cache = arguments.cache.open()?;
        let mut pipeline = open_device(arguments.device)?;
        if let Some(cache) = cache {
            pipeline.keep_on_disk(cache);
        }
        Ok(Box::new(pipeline))
    };
    let outcome = run(&plan, &mut open, &options, &mut progress)?;
    print(&outcome.summary)?;
    print(&format!("Written to {}\n", outcome.dir.display()))?;
    // The run is kept whatever becomes of its report.
    let report = splitsum::report::write(&ReportOptions::of_run(&outcome.dir)).map_err(Failure::failed);
    print(&report.as_ref().map_or_else(|failure| format!("No report: {failure}\n"), super::report::line))?;
    if let Some(work) = &outcome.work {
        progress.note(&work.line(started.elapsed().as_secs_f64() * 1e3));
    }
    if outcome.is_stopped && outcome.failures.is_empty() {
        let command: Vec<String> = options.command_line;
        return Err(Failure::Failed(format!("stopped; to go on: {}", command.join(" "))));
    }
    if !outcome.failures.is_empty() {
        let lines: Vec<String> =
            outcome.failures.iter().map(|f| format!("  {} {}: {}", f.cell, f.label, f.reason)).collect();
        let count = outcome.failures.len();
        return Err(Failure::CellsFailed(format!(
            "{count} of {} cells failed:\n{}",
            plan.cells.len(),
            lines.join("\n")
        )));
    }
    Ok(())
}

/// The checked experiment of `run` and `plan`.
pub fn load_plan(path: &Path, overrides: &[String], clamp_invalid: bool) -> Result<Plan, Failure> {
    let options = LoadOptions { clamp_invalid, ..LoadOptions::default() };
    Plan::load_with(path, overrides, &options).map_err(Failure::input)
}

/// The folder of a run when none is given.
pub fn default_dir(plan: &Plan, out: Option<&PathBuf>) -> PathBuf {
    out.cloned().unwrap_or_else(|| PathBuf::from("runs").join(&plan.config.name))
}

/// Opens the device of `--device`.
pub fn open_device(index: Option<usize>) -> Result<Pipeline, RenderFault> {
    let device = index.map_or(DeviceChoice::Default, DeviceChoice::Index);
    Ok(Pipeline::new(Options { device, ..Options::default() })?)
}
