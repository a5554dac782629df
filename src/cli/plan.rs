//! `splitsum plan`: what a run would do.

use super::run::default_dir;
use super::{Failure, print};
use clap::Args;
use serde_json::json;
use splitsum::experiment::store::Store;
use splitsum::experiment::timing;
use splitsum::experiment::{Cell, Plan};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::PathBuf;

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
    /// Prints JSON for programs.
    #[arg(long)]
    json: bool,
}

/// Samples a second that a software driver draws on two cores; used until the run itself has records.
const ASSUMED_SAMPLES_PER_SECOND: f64 = 50e6;

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

/// What is left to do, in samples and in seconds.
struct Cost {
    samples: f64,
    seconds: f64,
    basis: String,
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let plan = Plan::load(&arguments.experiment, &arguments.overrides).map_err(Failure::input)?;
    let dir = default_dir(&plan, arguments.out.as_ref());
    let store = Store::at(&dir);
    store.check_identity(&plan).map_err(Failure::input)?;
    let mut states = Vec::new();
    let mut wall_ms = Vec::new();
    for cell in &plan.cells {
        let record = store.cell(&cell.id).map_err(Failure::failed)?;
        let failure = store.failure(&cell.id).map_err(Failure::failed)?;
        states.push(match (&record, failure) {
            (Some(_), _) => State::Done,
            (None, Some(_)) => State::Failed,
            (None, None) => State::Open,
        });
        wall_ms.extend(record.map(|record| record.wall_ms));
    }
    let cost = cost(&plan, &states, &wall_ms);
    print(&if arguments.json { as_json(&plan, &states, &cost) } else { as_text(&plan, &states, &cost, &dir) })?;
    if plan.cells.is_empty() {
        return Err(Failure::NothingToDo(format!("{}: no cell is left", arguments.experiment.display())));
    }
    Ok(())
}

fn cost(plan: &Plan, states: &[State], wall_ms: &[f64]) -> Cost {
    let open: Vec<&Cell> = plan.cells.iter().zip(states).filter(|(_, s)| **s != State::Done).map(|(c, _)| c).collect();
    let pixels = f64::from(plan.config.size[0]) * f64::from(plan.config.size[1]);
    let radiances: BTreeSet<(&str, u32)> =
        open.iter().map(|cell| (cell.radiance.as_str(), cell.point.settings().samples)).collect();
    let references: BTreeSet<&str> = open.iter().map(|cell| cell.reference.as_str()).collect();
    let drawn: f64 = radiances.iter().map(|(_, samples)| f64::from(*samples)).sum();
    let samples = pixels * (drawn + references.len() as f64 * f64::from(plan.config.reference.samples));
    if wall_ms.is_empty() {
        let basis =
            format!("at {} million samples a second, a software driver on 2 cores", ASSUMED_SAMPLES_PER_SECOND / 1e6);
        return Cost { samples, seconds: samples / ASSUMED_SAMPLES_PER_SECOND, basis };
    }
    let mean_ms = wall_ms.iter().sum::<f64>() / wall_ms.len() as f64;
    let basis = format!("from the {} cells that are done", wall_ms.len());
    Cost { samples, seconds: open.len() as f64 * mean_ms / 1e3, basis }
}

fn as_text(plan: &Plan, states: &[State], cost: &Cost, dir: &std::path::Path) -> String {
    let mut text = format!("{}: {}\n", plan.config.name, plan.config.question);
    let groups = plan.groups();
    let radiances: usize = groups.iter().map(|group| group.radiances.len()).sum();
    let count = |state: State| states.iter().filter(|s| **s == state).count();
    let _ = writeln!(
        text,
        "{} cells from {radiances} images and {} references, {} x {} pixels; {} done, {} failed, {} open in {}",
        plan.cells.len(),
        groups.len(),
        plan.config.size[0],
        plan.config.size[1],
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
        "at most {:.0} million samples left to draw: about {} ({})",
        cost.samples / 1e6,
        indicatif::HumanDuration(std::time::Duration::from_secs_f64(cost.seconds)),
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
        "estimate": { "samples": cost.samples, "seconds": cost.seconds, "basis": cost.basis },
    });
    format!("{value:#}\n")
}
