//! `splitsum run`.

use super::cache::CacheArguments;
use super::progress::Terminal;
use super::stop::{self, STOP};
use super::subject::Subject;
use super::{Failure, print};
use clap::Args;
use splitsum::experiment::Plan;
use splitsum::pipeline::{DeviceChoice, Options, Pipeline};
use splitsum::report::page::{PageOptions, Told, write};
use splitsum::report::write::Written;
use splitsum::run::chunk::{PlanFile, run_chunk};
use splitsum::run::store::{FailureRecord, Store};
use splitsum::run::{Outcome, Progress, RenderFault, Renderer, RunError, RunOptions, run};
use splitsum::study::finished::Finished;
use splitsum::study::questions::answers;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Runs an experiment, or what is left of it.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    override_usage = "splitsum run [OPTIONS] <EXPERIMENT>\n       splitsum run --plan <FILE> --chunk <K> --store <DIR> [--device <N>]",
    after_help = "A run that was stopped (Ctrl-C, SIGTERM, a crash, a full disk) goes on where it stopped: give the same command again. One \
    that is finished ends with 0 at once. Cells whose images are gone, or not those that their records name, are done again.\n\n\
    A larger sweep goes on in the folder of a smaller one: give the experiment more values or axes. An experiment that lacks a finished \
    cell of the folder is refused. Configurations that are compared by time are timed again when one joins them.\n\n\
    The experiment.toml that a run keeps runs again as it stands: provenance.json beside it says where its files are and which --set \
    belong to it.\n\n\
    Examples:\n  splitsum run experiments/quick.toml\n  \
    splitsum run experiments/quick.toml --set alpha=0.1,0.5 --set brdf=ggx --out runs/short\n  \
    splitsum run experiments/quick.toml --set alpha=0.1,0.25,0.5 --set brdf=ggx --out runs/short\n  \
    splitsum run experiments/real.toml --set environment=sky.hdr --set scene=teapot.obj --out runs/teapot\n  \
    splitsum run experiments/ladder.toml --set environment=my.hdr --set brdf=ggx   (where the split sum's error comes from)\n  \
    splitsum run --plan plan.json --chunk 17 --store shared/sweep"
)]
pub struct Arguments {
    #[command(flatten)]
    subject: Option<Subject>,
    /// Runs one chunk of this plan file (see `splitsum plan --chunk-seconds`) instead of a whole experiment.
    #[arg(long, value_name = "FILE", requires_all = ["chunk", "store"])]
    #[arg(conflicts_with_all = ["experiment", "out", "overrides", "trace"])]
    plan: Option<PathBuf>,
    /// Number of the chunk, from 0.
    #[arg(long, value_name = "K", requires = "plan", conflicts_with = "experiment")]
    chunk: Option<usize>,
    /// The folder that all chunks share; `splitsum merge` makes one run of it.
    #[arg(long, value_name = "DIR", requires = "plan", conflicts_with = "experiment")]
    store: Option<PathBuf>,
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

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    match (&arguments.subject, &arguments.plan, arguments.chunk, &arguments.store) {
        (_, Some(plan), Some(chunk), Some(store)) => execute_chunk(arguments, plan, chunk, store),
        (Some(subject), ..) => execute_whole(arguments, subject),
        // The parser lets nothing else through.
        _ => Err(Failure::input("expected an experiment file, or --plan, --chunk and --store".to_owned())),
    }
}

fn execute_whole(arguments: &Arguments, subject: &Subject) -> Result<(), Failure> {
    let started = Instant::now();
    let plan = subject.plan()?;
    if plan.cells.is_empty() {
        return Err(subject.nothing_to_do());
    }
    if arguments.trace && plan.config.timing.is_none() {
        let file = plan.config.path.display();
        return Err(Failure::input(format!("--trace: {file} times nothing; expected a [timing] section")));
    }
    let mut progress = begin(&plan)?;
    let options = options(arguments, subject.dir(&plan));
    if let Some(told) = Store::at(&options.dir).told_when_done(&plan).filter(|_| !arguments.trace) {
        return print(&told);
    }
    let outcome = run(&plan, &mut opener(arguments), &options, &mut progress)?;
    let failed = conclude(&plan, &outcome)?;
    if let Some(work) = &outcome.work {
        progress.note(&work.line(started.elapsed().as_secs_f64() * 1e3));
    }
    failed.or_else(|| outcome.is_stopped.then(stopped)).map_or(Ok(()), Err)
}

fn execute_chunk(arguments: &Arguments, plan_file: &Path, chunk: usize, store: &Path) -> Result<(), Failure> {
    let (file, plan) = PlanFile::load(plan_file)?;
    let mut progress = begin(&plan)?;
    let options = options(arguments, store.to_owned());
    let outcome = run_chunk(&file, &plan, chunk, &mut opener(arguments), &options, &mut progress)?;
    let failed = cells_failed(&outcome.failures, file.chunks[chunk].cells.len());
    failed.or_else(|| outcome.is_stopped.then(stopped)).map_or(Ok(()), Err)?;
    print(&format!("Chunk {chunk} of 0 to {} is done, in {}\n", file.chunks.len() - 1, store.display()))
}

fn options(arguments: &Arguments, dir: PathBuf) -> RunOptions<'static> {
    RunOptions {
        dir,
        stop: &STOP,
        command_line: command_line(),
        fail_fast: arguments.fail_fast,
        trace: arguments.trace,
    }
}

/// What the user typed, for the provenance: where the program lies is nobody's business.
pub fn command_line() -> Vec<String> {
    let mut words: Vec<String> = std::env::args().collect();
    if let Some(program) = words.first_mut() {
        *program = Path::new(program).file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    }
    words
}

/// Says what is odd about the experiment and takes requests to stop.
fn begin(plan: &Plan) -> Result<Terminal, Failure> {
    let mut progress = Terminal::default();
    for warning in plan.inputs.warnings().into_iter().chain(plan.warnings()) {
        progress.note(&format!("warning: {warning}"));
    }
    stop::listen()?;
    Ok(progress)
}

/// Answers the questions of a run that has ended, prints the summary and writes the report; the result says which of its cells failed.
pub fn conclude(plan: &Plan, outcome: &Outcome) -> Result<Option<Failure>, Failure> {
    let run = Finished::read(&outcome.dir).map_err(Failure::failed)?;
    let answers = answers(&run, None);
    let written = Written::new(&run, &answers).map_err(Failure::failed)?;
    written.write().map_err(Failure::failed)?;
    let told = format!("{}Written to {}\n", written.summary, outcome.dir.display());
    print(&told)?;
    // The run is kept whatever becomes of its report.
    let options = PageOptions::in_folder(&outcome.dir);
    let report = write(&options, &Told::of_runs(&[(run, answers)]));
    let line = report.as_ref().map_or_else(|error| format!("No report: {error}\n"), super::report::line);
    print(&line)?;
    if report.is_ok() && outcome.failures.is_empty() && !outcome.is_stopped {
        Store::at(&outcome.dir).mark_done(plan, &(told + &line)).map_err(RunError::from)?;
    }
    Ok(cells_failed(&outcome.failures, plan.cells.len()))
}

fn cells_failed(failures: &[FailureRecord], cell_count: usize) -> Option<Failure> {
    let lines: Vec<String> = failures.iter().map(|f| format!("  {} {}: {}", f.cell, f.label, f.reason)).collect();
    let text = format!("{} of {cell_count} cells failed:\n{}", failures.len(), lines.join("\n"));
    (!failures.is_empty()).then_some(Failure::cells_failed(text))
}

fn stopped() -> Failure {
    Failure::failed(format!("stopped; to go on: {}", std::env::args().collect::<Vec<_>>().join(" ")))
}

/// Opens the device, with the cache beside it.
fn opener(arguments: &Arguments) -> impl FnMut() -> Result<Box<dyn Renderer>, RenderFault> {
    || {
        let cache = arguments.cache.open()?;
        let mut pipeline = open_device(arguments.device)?;
        if let Some(cache) = cache {
            pipeline.keep_on_disk(cache);
        }
        Ok(Box::new(pipeline))
    }
}

/// Opens the device of `--device`.
pub fn open_device(index: Option<usize>) -> Result<Pipeline, RenderFault> {
    let device = index.map_or(DeviceChoice::Default, DeviceChoice::Index);
    Ok(Pipeline::new(Options { device, ..Options::default() })?)
}
