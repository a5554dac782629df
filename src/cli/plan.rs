//! `splitsum plan`: what a run would do.

use super::cache::CacheArguments;
use super::estimate::{Estimated, Question, estimated};
use super::subject::Subject;
use super::{Failure, print, print_data, tell};
use clap::Args;
use serde_json::json;
use splitsum::experiment::fault::Lines;
use splitsum::experiment::{Cell, Plan};
use splitsum::run::RunError;
use splitsum::run::chunk::{PlanFile, Prices};
use splitsum::run::estimate::{Part, SAMPLES_PER_SECOND, Source};
use splitsum::run::store::{CELLS_FOLDER, CHUNKS_FOLDER, Store, StoreError};
use splitsum::run::timing;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Shows the cells of an experiment, what is left out and why, what is done, and what the rest will cost; or cuts it into chunks for several machines.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    mut_arg("out", |out| out.value_name("PATH").help(
        "Folder of the run to compare with; runs/NAME when left out. With --chunk-seconds: the plan file to write"
    )),
    after_help = "Time and disk are estimated from the records of the run's folder and of --from. For work that these do not know, stated \
    constants stand, scaled by a short probe of the device. Each figure says where it comes from.\n\n\
    Chunks depend on the experiment, its inputs, --chunk-seconds and --samples-per-second alone: two people get the same.\n\n\
    Examples:\n  splitsum plan experiments/quick.toml\n  splitsum plan experiments/quick.toml --json | jq '.cells | length'\n  \
    splitsum plan experiments/quick.toml --chunk-seconds 60 --out plan.json"
)]
pub struct Arguments {
    #[command(flatten)]
    subject: Subject,
    /// Prints JSON for programs.
    #[arg(long, conflicts_with = "chunk_seconds")]
    json: bool,
    /// Cuts the experiment into chunks of about this many seconds and writes the plan file --out.
    #[arg(long, value_name = "S", requires = "out", value_parser = positive)]
    chunk_seconds: Option<f64>,
    /// Samples of the method `sampled` that the device draws in a second [default: 6e7, a software driver on two cores].
    #[arg(long, value_name = "RATE", requires = "chunk_seconds", value_parser = positive)]
    samples_per_second: Option<f64>,
    /// Folders whose records tell what cells cost: earlier runs, or the --store of one in chunks.
    #[arg(long, value_name = "DIR", visible_alias = "store", conflicts_with = "chunk_seconds")]
    from: Vec<PathBuf>,
    #[command(flatten)]
    cache: CacheArguments,
    /// Index of the device to estimate for, as `splitsum devices` lists them.
    #[arg(long, value_name = "N", conflicts_with = "chunk_seconds")]
    device: Option<usize>,
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "expected a number above 0".to_owned())
}

const DONE: &str = "done";
/// Bytes of JSON that are written in one piece.
const BLOCK_BYTES: usize = 1 << 16;

/// How far a cell is.
fn state(store: &Store, cell: &Cell) -> Result<&'static str, StoreError> {
    let failure = store.failure(&cell.id)?;
    Ok(match (store.cell(&cell.id)?, failure) {
        (Some(_), _) => DONE,
        (None, Some(_)) => "failed",
        (None, None) => "open",
    })
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let plan = arguments.subject.plan()?;
    for warning in plan.warnings() {
        tell(&format!("warning: {warning}"));
    }
    if let (Some(seconds), Some(path)) = (arguments.chunk_seconds, &arguments.subject.out) {
        return write_chunks(arguments, &plan, seconds, path);
    }
    let dir = arguments.subject.dir(&plan);
    let store = Store::at(&dir);
    store.check_identity(&plan).map_err(Failure::input)?;
    let states =
        plan.cells.iter().map(|cell| state(&store, cell)).collect::<Result<Vec<_>, _>>().map_err(RunError::from)?;
    let open: Vec<&Cell> =
        plan.cells.iter().zip(&states).filter(|(_, state)| **state != DONE).map(|(c, _)| c).collect();
    let jobs = timing::jobs(&plan);
    // The samples of a block belong together: one that lacks a record is timed anew as a whole.
    let blocks = jobs.chunk_by(|a, b| a.block == b.block);
    let left: Vec<_> =
        blocks.filter(|block| !block.iter().all(|job| store.has_timing(&job.id))).flatten().cloned().collect();
    let is_run = |dir: &&PathBuf| dir.join(CELLS_FOLDER).is_dir() || dir.join(CHUNKS_FOLDER).is_dir();
    if let Some(stranger) = arguments.from.iter().find(|dir| !is_run(dir)) {
        let stranger = stranger.display();
        let text =
            format!("--from: {stranger} holds no run; expected a folder with {CELLS_FOLDER}/ or {CHUNKS_FOLDER}/");
        return Err(Failure::input(text));
    }
    let folders: Vec<PathBuf> = std::iter::once(dir.clone()).chain(arguments.from.iter().cloned()).collect();
    let (cache, device) = (&arguments.cache, arguments.device);
    let cost = estimated(&plan, &Question { open: &open, jobs: &left, folders: &folders, cache, device })?;
    let shown = Shown { plan: &plan, states: &states, timings: [jobs.len(), jobs.len() - left.len()], cost: &cost };
    match arguments.json {
        true => shown.write_json()?,
        false => print(&shown.as_text(&dir))?,
    }
    if plan.cells.is_empty() {
        return Err(arguments.subject.nothing_to_do());
    }
    Ok(())
}

fn write_chunks(arguments: &Arguments, plan: &Plan, seconds: f64, path: &Path) -> Result<(), Failure> {
    if plan.cells.is_empty() {
        return Err(arguments.subject.nothing_to_do());
    }
    if arguments.subject.clamp_invalid {
        let text = "--clamp-invalid: a plan file does not keep it; expected environments without invalid texels";
        return Err(Failure::input(text.to_owned()));
    }
    let prices = Prices::stated(arguments.samples_per_second.unwrap_or(SAMPLES_PER_SECOND));
    let file = PlanFile::new(plan, path.parent().unwrap_or(Path::new("")), seconds, prices);
    file.write(path)?;
    let timed: usize = file.chunks.iter().map(|chunk| chunk.timings.len()).sum();
    let longest = file.chunks.iter().map(|chunk| chunk.seconds).fold(0.0, f64::max);
    let whole: f64 = file.chunks.iter().map(|chunk| chunk.seconds).sum();
    print(&format!(
        "{}: {} cells and {timed} timed configurations in {}, numbered from 0; the longest is reckoned to take {longest:.0} s,\n\
         all together {whole:.0} s; prices: {}\nWritten to {}\n",
        file.name,
        plan.cells.len(),
        if file.chunks.len() == 1 { "1 chunk".to_owned() } else { format!("{} chunks", file.chunks.len()) },
        file.prices.basis,
        path.display()
    ))
}

/// The printed plan.
struct Shown<'a> {
    plan: &'a Plan,
    states: &'a [&'static str],
    /// Timed configurations, and how many are done.
    timings: [usize; 2],
    cost: &'a Estimated,
}

impl Shown<'_> {
    /// Count, reason and place of each exclusion.
    fn excluded(&self) -> impl Iterator<Item = (usize, &str, String)> {
        let lines = Lines::new(&self.plan.config.text);
        let exclusions = self.plan.config.exclusions.iter().zip(&self.plan.excluded);
        exclusions.map(move |(e, count)| (*count, e.why.as_str(), e.place.words(&self.plan.config.path, &lines)))
    }

    fn as_text(&self, dir: &Path) -> String {
        let (plan, dir) = (self.plan, dir.display());
        let groups = plan.groups();
        let radiances: usize = groups.iter().map(|group| group.radiances.len()).sum();
        let count = |state: &str| self.states.iter().filter(|s| **s == state).count();
        let states = [DONE, "failed", "open"].map(|state| format!("{} {state}", count(state))).join(", ");
        let (cells, references) = (plan.cells.len(), groups.len());
        let mut lines = vec![
            format!("{}: {}", plan.config.name, plan.config.question),
            format!("{cells} cells from {radiances} images and {references} references; {states} in {dir}"),
        ];
        lines.extend(self.excluded().map(|(count, why, place)| format!("excluded {count} by {place}: {why}")));
        let collapsed = plan.collapsed;
        lines.extend(
            (collapsed > 0).then(|| {
                format!("collapsed {collapsed}: they differ only in parameters that their method does not use")
            }),
        );
        let [timed, done] = self.timings;
        lines.extend((timed > 0).then(|| format!("{timed} configurations are timed; {done} done")));
        lines.extend(self.cost_lines());
        let states = plan.cells.iter().zip(self.states);
        lines.extend(states.map(|(cell, state)| format!("{} {state:6} {}", cell.id, plan.label(cell))));
        lines.join("\n") + "\n"
    }

    fn cost_lines(&self) -> Vec<String> {
        let estimate = &self.cost.estimate;
        let mut lines = vec![format!(
            "at most {:.0} million samples left to draw: about {} and {} of disk",
            estimate.samples / 1e6,
            indicatif::HumanDuration(std::time::Duration::from_secs_f64(estimate.seconds)),
            indicatif::HumanBytes(estimate.bytes as u64),
        )];
        for (part, found) in &estimate.parts {
            let sources: Vec<&str> = found.sources.keys().map(|source| source.name()).collect();
            let count = match part {
                Part::Timing => format!("{:.0} frames and tables", found.count),
                Part::Ends => String::new(),
                _ => format!("{:.0}", found.count),
            };
            let (name, seconds, sources) = (part.name(), found.seconds, sources.join(", "));
            lines.push(format!("  {name:16} {count:>24} {seconds:>8.1} s  from {sources}"));
        }
        let disk = |source: Source| format!("  {:16} {:>24} {:>10}  from {}", "disk", "", "", source.name());
        lines.extend(estimate.bytes_source.map(disk));
        lines.extend(self.cost.notes.iter().map(|note| format!("  {note}")));
        lines
    }

    /// One object, its cells first, a line each: they are written as they are made.
    fn write_json(&self) -> Result<(), Failure> {
        let plan = self.plan;
        print_data("{\n  \"cells\": [")?;
        // A block is one write.
        let mut block = String::new();
        for (place, (cell, state)) in plan.cells.iter().zip(self.states).enumerate() {
            let columns = plan.columns_of(cell);
            let axes: BTreeMap<&str, String> = columns.iter().map(|(name, value)| (*name, value.to_string())).collect();
            let line = json!({ "id": cell.id, "radiance": cell.radiance, "reference": cell.reference, "state": state, "axes": axes });
            let comma = if place == 0 { "" } else { "," };
            let _ = write!(block, "{comma}\n    {line}");
            if block.len() > BLOCK_BYTES {
                print_data(&std::mem::take(&mut block))?;
            }
        }
        let rest = format!("{:#}\n", self.rest());
        print_data(&format!("{block}\n  ],\n{}", rest.trim_start_matches("{\n")))
    }

    /// All but the cells.
    fn rest(&self) -> serde_json::Value {
        let (plan, estimate) = (self.plan, &self.cost.estimate);
        let exclusions =
            self.excluded().map(|(count, why, place)| json!({ "why": why, "count": count, "place": place }));
        let parts = estimate.parts.iter().map(|(part, found)| {
            let sources: serde_json::Map<String, serde_json::Value> =
                found.sources.iter().map(|(source, seconds)| (source.name().to_owned(), json!(seconds))).collect();
            (part.name().to_owned(), json!({ "count": found.count, "seconds": found.seconds, "seconds_from": sources }))
        });
        json!({
            "name": plan.config.name,
            "plan_hash": plan.hash,
            "excluded": exclusions.collect::<Vec<_>>(),
            "collapsed": plan.collapsed,
            "timings": self.timings[0],
            "timings_done": self.timings[1],
            "estimate": {
                "samples": estimate.samples,
                "seconds": estimate.seconds,
                "bytes": estimate.bytes,
                "bytes_from": estimate.bytes_source.map(|source| source.name()),
                "parts": parts.collect::<serde_json::Map<_, _>>(),
                "notes": self.cost.notes,
            },
        })
    }
}
