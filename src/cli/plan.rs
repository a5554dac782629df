//! `splitsum plan`: what a run would do.

use super::run::{default_dir, load_plan};
use super::{Failure, print};
use clap::Args;
use serde_json::json;
use splitsum::experiment::store::{CellRecord, Store};
use splitsum::experiment::timing;
use splitsum::experiment::{Cell, Plan};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Shows the cells of an experiment, what is left out and why, what is done, and a rough cost.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = "Examples:\n  splitsum plan experiments/quick.toml\n  splitsum plan experiments/quick.toml --json | jq '.cells | length'"
)]
pub struct Arguments {
    /// The experiment file.
    experiment: PathBuf,
    /// Folder of the run to compare with; runs/NAME when left out.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replaces the values of an axis, as axis=v1,v2.
    #[arg(long = "set", value_name = "AXIS=VALUES")]
    overrides: Vec<String>,
    /// Sets NaN, infinite and negative texels of environments to 0, with a warning, instead of refusing them.
    #[arg(long)]
    clamp_invalid: bool,
    /// Prints JSON for programs.
    #[arg(long)]
    json: bool,
}

/// Samples a second that a software driver draws on two cores; used until the run itself has records.
const ASSUMED_SAMPLES_PER_SECOND: f64 = 25e6;

/// Scoring and writing of one cell of 128x128 to 256x256 pixels.
const ASSUMED_SECONDS_PER_CELL: f64 = 0.03;
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
    let plan = load_plan(&arguments.experiment, &arguments.overrides, arguments.clamp_invalid)?;
    let dir = default_dir(&plan, arguments.out.as_ref());
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
        return Err(Failure::NothingToDo(format!("{}: no cell is left", arguments.experiment.display())));
    }
    Ok(())
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
        let seconds = samples / ASSUMED_SAMPLES_PER_SECOND + open.len() as f64 * ASSUMED_SECONDS_PER_CELL;
        let basis = format!(
            "{} million samples a second and {ASSUMED_SECONDS_PER_CELL} s a cell, a software driver on 2 cores; images as they are stored",
            ASSUMED_SAMPLES_PER_SECOND / 1e6
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
