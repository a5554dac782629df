//! `splitsum run`.

use super::cache::CacheArguments;
use super::progress::{self, Terminal};
use super::shared::DeviceFlag;
use super::stop::{self, STOP};
use super::subject::Subject;
use super::{Failure, log, print};
use clap::Args;
use splitsum::experiment::Plan;
use splitsum::report::COMPANIONS;
use splitsum::report::page::{PageOptions, PageRun, write};
use splitsum::report::write::Written;
use splitsum::run::shard::Shard;
use splitsum::run::store::Store;
use splitsum::run::{Outcome, Progress, RenderFault, Renderer, RunError, RunOptions, run};
use splitsum::study::finished::Finished;
use splitsum::study::questions::{Answer, answers};
use std::path::Path;
use std::time::Instant;

/// Run an experiment, or resume it.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = "A stopped run (Ctrl-C, SIGTERM, a crash, a full disk) continues with the same \
                  command. A finished run exits 0 immediately \
    and reprints its summary. Cells with missing or changed images are rendered again.\n\n\
    A larger sweep continues in the folder of a smaller one: add values or axes. An experiment \
    that lacks a finished cell of the folder is \
    refused. Configurations that are compared by time are timed again if one joins them.\n\n\
    The experiment.toml in a run's folder can be run again; provenance.json in the same folder has \
    its paths and --set.\n\n\
    Examples:\n  splitsum run experiments/quick.toml\n  \
    splitsum run experiments/quick.toml --set alpha=0.1,0.5 --set brdf=ggx --out runs/short\n  \
    splitsum run experiments/quick.toml --set alpha=0.1,0.25,0.5 --set brdf=ggx --out \
    runs/short\n  \
    splitsum run experiments/real.toml --set environment=sky.hdr --set scene=teapot.obj --out \
    runs/teapot\n  \
    splitsum run experiments/ladder.toml --set environment=my.hdr --set brdf=ggx   (what causes \
    the split sum's error)\n  \
    splitsum run sweep.toml --shard 2/4 --out /shared/sweep   (one of four processes; then \
    splitsum merge /shared/sweep)"
)]
pub struct Arguments {
    #[command(flatten)]
    subject: Subject,
    /// Run part K of N into the shared folder --out; `splitsum merge` joins parts.
    #[arg(long, value_name = "K/N", requires = "out")]
    shard: Option<Shard>,
    /// Stop at the first cell that fails.
    #[arg(long)]
    fail_fast: bool,
    #[command(flatten)]
    cache: CacheArguments,
    #[command(flatten)]
    device: DeviceFlag,
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let started = Instant::now();
    let subject = &arguments.subject;
    progress::doing("reading the experiment");
    let plan = subject.plan()?;
    if plan.cells.is_empty() {
        return Err(subject.nothing_to_do());
    }
    let mut progress = begin(&plan)?;
    let options = RunOptions {
        dir: subject.dir(&plan),
        stop: &STOP,
        command_line: command_line(),
        shard: arguments.shard,
        fail_fast: arguments.fail_fast,
        companions: COMPANIONS,
    };
    let is_whole = arguments.shard.is_none();
    if let Some(printed) = Store::read_only(&options.dir)
        .printed_when_done(&plan)
        .filter(|_| is_whole)
    {
        return print(&printed);
    }
    let outcome = run(&plan, &mut opener(arguments), &options, &mut progress)?;
    let failed = match arguments.shard {
        None => conclude(&plan, &outcome)?,
        Some(_) => cells_failed(&outcome),
    };
    progress.note(&format!(
        "done in {}",
        indicatif::HumanDuration(started.elapsed())
    ));
    failed
        .or_else(|| outcome.is_stopped.then(stopped))
        .map_or(Ok(()), Err)?;
    let Some(shard) = arguments.shard else {
        return Ok(());
    };
    print(&format!(
        "Shard {shard} is done: {} of {} cells, in {}\n",
        outcome.cell_count,
        plan.cells.len(),
        outcome.dir.display()
    ))
}

/// Returns the command line for the provenance, without the program's folder.
pub fn command_line() -> Vec<String> {
    let mut words: Vec<String> = std::env::args().collect();
    if let Some(program) = words.first_mut() {
        *program = Path::new(program)
            .file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    }
    words
}

/// Prints warnings and handles Ctrl-C.
fn begin(plan: &Plan) -> Result<Terminal, Failure> {
    let mut progress = Terminal;
    let of_inputs = plan.inputs.warnings();
    let of_inputs = of_inputs.iter().map(|warning| super::with_guide(warning));
    for warning in of_inputs.chain(plan.warnings()) {
        progress.note(&format!("warning: {warning}"));
    }
    stop::listen()?;
    Ok(progress)
}

/// Answers the questions of an ended run, prints the summary and writes the report. Returns the
/// failure of its cells.
pub fn conclude(plan: &Plan, outcome: &Outcome) -> Result<Option<Failure>, Failure> {
    progress::doing("answering the questions");
    let mut run = Finished::read(&outcome.dir).map_err(Failure::failed)?;
    let answers = answers(&run, None);
    run.drop_bins();
    let summary = write_answers(&run, &answers)?;
    let printed = format!("{summary}Written to {}\n", outcome.dir.display());
    print(&printed)?;
    progress::doing("writing the report");
    let options = PageOptions::in_folder(&outcome.dir);
    let report = write(&options, &PageRun::of_runs(&[(run, answers)]));
    let failed = cells_failed(outcome);
    let line = match report {
        Ok(written) => super::report::line(&written),
        Err(error) if failed.is_none() => {
            return Err(Failure::failed(format!("no report: {error}")));
        }
        Err(error) => {
            log(&format!("no report: {error}"));
            return Ok(failed);
        }
    };
    print(&line)?;
    if failed.is_none() && !outcome.is_stopped {
        Store::read_only(&outcome.dir)
            .mark_done(plan, &(printed + &line))
            .map_err(RunError::from)?;
    }
    Ok(failed)
}

/// Writes the answers beside the run; returns the summary. The texts of the files are dropped
/// before the page is made.
fn write_answers(run: &Finished, answers: &[Answer]) -> Result<String, Failure> {
    let written = Written::new(run, answers).map_err(Failure::failed)?;
    written.write().map_err(Failure::failed)?;
    Ok(written.summary)
}

fn cells_failed(outcome: &Outcome) -> Option<Failure> {
    let failures = &outcome.failures;
    let lines: Vec<String> = failures
        .iter()
        .map(|f| format!("  {} {}: {}", f.cell, f.label, f.reason))
        .collect();
    let text = format!(
        "{} of {} cells failed:\n{}",
        failures.len(),
        outcome.cell_count,
        lines.join("\n")
    );
    (!failures.is_empty()).then_some(Failure::cells_failed(text))
}

fn stopped() -> Failure {
    Failure::failed(format!(
        "stopped; to go on: {}",
        std::env::args().collect::<Vec<_>>().join(" ")
    ))
}

fn opener(arguments: &Arguments) -> impl FnMut() -> Result<Box<dyn Renderer>, RenderFault> {
    || {
        let cache = arguments.cache.open()?;
        let mut pipeline = arguments.device.open()?;
        if let Some(cache) = cache {
            pipeline.keep_on_disk(cache);
        }
        Ok(Box::new(pipeline))
    }
}
