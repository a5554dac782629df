//! `splitsum plan`: what a run would do.

use super::subject::Subject;
use super::{Failure, print};
use clap::Args;
use serde_json::json;
use splitsum::experiment::chunk::{PlanFile, Rates};
use splitsum::experiment::store::{CellRecord, Store};
use splitsum::experiment::timing;
use splitsum::experiment::{Cell, Plan};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

/// Shows the cells of an experiment, what is left out and why, what is done, and a rough cost; or cuts it into chunks for several machines.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    mut_arg("out", |out| out.value_name("PATH").help(
        "Folder of the run to compare with; runs/NAME when left out. With --chunk-seconds: the plan file to write"
    )),
    after_help = "Chunks are a function of the experiment, its inputs, --chunk-seconds and --samples-per-second only: the same on every machine.\n\n\
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
    /// The speed that the lengths of chunks are reckoned with. Nothing is measured, so that chunks do not depend on the machine.
    #[arg(long, value_name = "RATE", requires = "chunk_seconds", value_parser = positive)]
    #[arg(default_value_t = Rates::default().samples_per_second)]
    samples_per_second: f64,
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "expected a number above 0".to_owned())
}

/// f32 R, G, B and A.
const IMAGE_BYTES_PER_PIXEL: f64 = 16.0;
/// The same with the three channels of the standard error.
const REFERENCE_BYTES_PER_PIXEL: f64 = 28.0;
/// Display image and error map as PNG.
const PICTURE_BYTES_PER_PIXEL: f64 = 4.0;

/// How far a cell is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    Done,
    Failed,
    Open,
}

impl State {
    fn name(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Failed => "failed",
            Self::Open => "open",
        }
    }
}

/// What is left to do: in samples, in seconds, on the disk.
struct Cost {
    samples: f64,
    seconds: f64,
    bytes: f64,
    basis: String,
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let plan = arguments.subject.plan()?;
    for warning in plan.warnings() {
        eprintln!("warning: {warning}");
    }
    if let (Some(seconds), Some(path)) = (arguments.chunk_seconds, &arguments.subject.out) {
        return write_chunks(arguments, &plan, seconds, path);
    }
    let dir = arguments.subject.dir(&plan);
    let store = Store::at(&dir);
    store.check_identity(&plan).map_err(Failure::input)?;
    let mut states = Vec::new();
    let mut records = Vec::new();
    for cell in &plan.cells {
        let record = store.cell(&cell.id).map_err(Failure::failed)?;
        let failure = store.failure(&cell.id).map_err(Failure::failed)?;
        states.push(match (&record, failure) {
            (Some(_), _) => State::Done,
            (None, Some(_)) => State::Failed,
            (None, None) => State::Open,
        });
        records.extend(record);
    }
    let cost = cost(&plan, &states, &records, &dir);
    print(&if arguments.json { as_json(&plan, &states, &cost) } else { as_text(&plan, &states, &cost, &dir) })?;
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
        return Err(Failure::BadInput(text.to_owned()));
    }
    let rates = Rates { samples_per_second: arguments.samples_per_second, ..Rates::default() };
    let file = PlanFile::new(plan, seconds, rates);
    file.write(path).map_err(Failure::input)?;
    let timed: usize = file.chunks.iter().map(|chunk| chunk.timings.len()).sum();
    let longest = file.chunks.iter().map(|chunk| chunk.seconds).fold(0.0, f64::max);
    print(&format!(
        "{}: {} cells and {timed} timed configurations in {}, numbered from 0; the longest is reckoned to take {longest:.0} s\n\
         at {} million samples a second\nWritten to {}\n",
        file.name,
        plan.cells.len(),
        match file.chunks.len() {
            1 => "1 chunk".to_owned(),
            count => format!("{count} chunks"),
        },
        rates.samples_per_second / 1e6,
        path.display()
    ))
}

fn cost(plan: &Plan, states: &[State], records: &[CellRecord], dir: &Path) -> Cost {
    let open: Vec<&Cell> = plan.cells.iter().zip(states).filter(|(_, s)| **s != State::Done).map(|(c, _)| c).collect();
    let pixels = |cell: &Cell| plan.size_of(cell).iter().map(|&side| f64::from(side)).product::<f64>();
    let mut seen = BTreeSet::new();
    let (mut samples, mut bytes) = (0.0, 0.0);
    for cell in &open {
        if seen.insert(&cell.reference) {
            samples += pixels(cell) * f64::from(plan.config.reference.samples);
            bytes += pixels(cell) * REFERENCE_BYTES_PER_PIXEL;
        }
        if seen.insert(&cell.radiance) {
            let images = 1 + plan.repeats_of(&cell.point).unwrap_or(0);
            samples += pixels(cell) * f64::from(cell.point.settings().samples * images);
            bytes += pixels(cell) * IMAGE_BYTES_PER_PIXEL;
        }
        bytes += pixels(cell) * PICTURE_BYTES_PER_PIXEL;
    }
    if records.is_empty() {
        let rates = Rates::default();
        let seconds = samples / rates.samples_per_second + open.len() as f64 * rates.seconds_per_cell;
        let basis = format!(
            "{} million samples a second and {} s a cell, a software driver on 2 cores; images as they are stored",
            rates.samples_per_second / 1e6,
            rates.seconds_per_cell
        );
        return Cost { samples, seconds, bytes, basis };
    }
    let done = records.len() as f64;
    let mean_ms = records.iter().map(|record| record.wall_ms).sum::<f64>() / done;
    let basis = format!("from the {done} cells that are done");
    let seconds = open.len() as f64 * mean_ms / 1e3;
    Cost { samples, seconds, bytes: open.len() as f64 * folder_bytes(dir) / done, basis }
}

/// Bytes of all files below a folder.
fn folder_bytes(dir: &Path) -> f64 {
    let entries = std::fs::read_dir(dir).into_iter().flatten().flatten();
    entries
        .map(|entry| match entry.metadata() {
            Ok(metadata) if metadata.is_dir() => folder_bytes(&entry.path()),
            Ok(metadata) => metadata.len() as f64,
            Err(_) => 0.0,
        })
        .sum()
}

fn as_text(plan: &Plan, states: &[State], cost: &Cost, dir: &Path) -> String {
    let mut text = format!("{}: {}\n", plan.config.name, plan.config.question);
    let groups = plan.groups();
    let radiances: usize = groups.iter().map(|group| group.radiances.len()).sum();
    let count = |state: State| states.iter().filter(|s| **s == state).count();
    let _ = writeln!(
        text,
        "{} cells from {radiances} images and {} references; {} done, {} failed, {} open in {}",
        plan.cells.len(),
        groups.len(),
        count(State::Done),
        count(State::Failed),
        count(State::Open),
        dir.display()
    );
    for (exclusion, count) in plan.config.exclusions.iter().zip(&plan.excluded) {
        let _ = writeln!(text, "excluded {count}: {}", exclusion.why);
    }
    if plan.collapsed > 0 {
        let _ = writeln!(
            text,
            "collapsed {}: they differ only in parameters that their method does not use",
            plan.collapsed
        );
    }
    let timings = timing::jobs(plan).len();
    if timings > 0 {
        let _ = writeln!(text, "{timings} configurations are timed");
    }
    let _ = writeln!(
        text,
        "at most {:.0} million samples left to draw: about {} and {} of disk ({})",
        cost.samples / 1e6,
        indicatif::HumanDuration(std::time::Duration::from_secs_f64(cost.seconds)),
        indicatif::HumanBytes(cost.bytes as u64),
        cost.basis
    );
    for (cell, state) in plan.cells.iter().zip(states) {
        let _ = writeln!(text, "{} {:6} {}", cell.id, state.name(), plan.label(cell));
    }
    text
}

fn as_json(plan: &Plan, states: &[State], cost: &Cost) -> String {
    let cells = plan.cells.iter().zip(states).map(|(cell, state)| {
        let axes: serde_json::Map<String, serde_json::Value> =
            plan.columns_of(cell).iter().map(|(name, value)| (name.to_string(), json!(value.to_string()))).collect();
        json!({ "id": cell.id, "radiance": cell.radiance, "reference": cell.reference, "state": state.name(), "axes": axes })
    });
    let exclusions = plan.config.exclusions.iter().zip(&plan.excluded);
    let value = json!({
        "name": plan.config.name,
        "plan_hash": plan.hash,
        "cells": cells.collect::<Vec<_>>(),
        "excluded": exclusions.map(|(e, count)| json!({ "why": e.why, "count": count })).collect::<Vec<_>>(),
        "collapsed": plan.collapsed,
        "timings": timing::jobs(plan).len(),
        "estimate": { "samples": cost.samples, "seconds": cost.seconds, "bytes": cost.bytes, "basis": cost.basis },
    });
    format!("{value:#}\n")
}
