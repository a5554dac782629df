//! `splitsum plan`.

use super::cache::CacheArguments;
use super::shared::DeviceFlag;
use super::subject::Subject;
use super::{Failure, log, print, print_data, progress};
use clap::Args;
use serde_json::json;
use splitsum::experiment::Id;
use splitsum::experiment::axis::AxisId;
use splitsum::experiment::axis::named::{columns, fields};
use splitsum::experiment::fault::Lines;
use splitsum::experiment::{Cell, Plan};
use splitsum::instrument::pipeline::{chosen_device, is_kept};
use splitsum::run::RunError;
use splitsum::run::estimate::Forecast;
use splitsum::run::store::{Store, StoreError};
use splitsum::run::timing::{self, TimingJob};
use std::collections::BTreeMap;
use std::path::Path;

/// Show an experiment's cells, exclusions, progress and predicted time.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = "The predicted time assumes a software driver on two cores.\n\n\
    Examples:\n  splitsum plan experiments/quick.toml\n  splitsum plan experiments/quick.toml \
    --json | jq '.cells | length'"
)]
pub struct Arguments {
    #[command(flatten)]
    subject: Subject,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    cache: CacheArguments,
    #[command(flatten)]
    device: DeviceFlag,
}

const DONE: &str = "done";

fn state(store: &Store, cell: &Cell) -> Result<&'static str, StoreError> {
    let failure = store.failure(cell.id)?;
    Ok(match (store.cell(cell.id)?, failure) {
        (Some(_), _) => DONE,
        (None, Some(_)) => "failed",
        (None, None) => "open",
    })
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    progress::doing("planning");
    let plan = arguments.subject.plan()?;
    for warning in plan.warnings() {
        log(&format!("warning: {warning}"));
    }
    let dir = arguments.subject.dir(&plan);
    let store = Store::read_only(&dir);
    store.check_identity(&plan).map_err(Failure::input)?;
    let states = plan
        .cells
        .iter()
        .map(|cell| state(&store, cell))
        .collect::<Result<Vec<_>, _>>()
        .map_err(RunError::from)?;
    let open: Vec<&Cell> = plan
        .cells
        .iter()
        .zip(&states)
        .filter(|(_, state)| **state != DONE)
        .map(|(c, _)| c)
        .collect();
    let jobs = timing::jobs(&plan);
    // A block with a missing record is timed again as a whole.
    let blocks = jobs.chunk_by(|a, b| a.block == b.block);
    let left: Vec<_> = blocks
        .filter(|block| !block.iter().all(|job| store.has_timing(job.id)))
        .flatten()
        .cloned()
        .collect();
    let seconds = forecast(&plan, &open, &left, arguments)?.ahead(0.0).seconds;
    let timings = [jobs.len(), jobs.len() - left.len()];
    let shown = Shown {
        plan: &plan,
        states: &states,
        timings,
        seconds,
    };
    if arguments.json {
        shown.write_json()?;
    } else {
        print(&shown.as_text(&dir))?;
    }
    if plan.cells.is_empty() {
        return Err(arguments.subject.nothing_to_do());
    }
    Ok(())
}

fn forecast(
    plan: &Plan,
    open: &[&Cell],
    jobs: &[TimingJob],
    arguments: &Arguments,
) -> Result<Forecast, Failure> {
    let device = match chosen_device(arguments.device.choice()) {
        Ok(device) => Some(device),
        Err(error) if arguments.device.device.is_some() => return Err(Failure::input(error)),
        Err(_) => None,
    };
    let mut cache = arguments.cache.open().map_err(Failure::opening)?;
    if let (Some(cache), Some(device)) = (&mut cache, &device) {
        cache.set_device(device);
    }
    let is_kept = |cell: &Cell| {
        let request = plan
            .judge_of(cell)
            .map(|point| plan.least_reference(&point));
        let known = cache.as_ref().zip(request);
        known.is_some_and(|(cache, request)| is_kept(cache, &request))
    };
    let first_of_each: BTreeMap<Id, &Cell> = open
        .iter()
        .filter_map(|cell| Some((cell.reference?, *cell)))
        .collect();
    let kept = first_of_each
        .iter()
        .filter(|(_, cell)| is_kept(cell))
        .map(|(id, _)| *id);
    Ok(Forecast::new(plan, open, jobs, kept))
}

struct Shown<'a> {
    plan: &'a Plan,
    states: &'a [&'static str],
    /// Timed configurations, and how many are done.
    timings: [usize; 2],
    /// Predicted for the rest.
    seconds: f64,
}

impl Shown<'_> {
    /// Lists count, reason and place of each exclusion.
    fn excluded(&self) -> impl Iterator<Item = (usize, &str, String)> {
        let lines = Lines::new(&self.plan.config.text);
        let exclusions = self.plan.config.exclusions.iter().zip(&self.plan.excluded);
        exclusions.map(move |(e, count)| {
            (
                *count,
                e.why.as_str(),
                e.location.words(&self.plan.config.path, &lines),
            )
        })
    }

    fn as_text(&self, dir: &Path) -> String {
        let plan = self.plan;
        let groups = plan.groups();
        let radiances: usize = groups.iter().map(|group| group.radiances.len()).sum();
        let count = |state: &str| self.states.iter().filter(|s| **s == state).count();
        let states = [DONE, "failed", "open"]
            .map(|state| format!("{} {state}", count(state)))
            .join(", ");
        let headline = match plan.config.question.as_str() {
            "" => plan.config.name.clone(),
            question => format!("{}: {question}", plan.config.name),
        };
        let mut lines = vec![
            headline,
            format!(
                "{} cells from {radiances} images and {}; {states} in {}",
                plan.cells.len(),
                if plan.config.is_scored {
                    format!("{} references", groups.len())
                } else {
                    "no references: they are not scored".to_owned()
                },
                dir.display()
            ),
        ];
        lines.extend(
            self.excluded()
                .map(|(count, why, place)| format!("excluded {count} by {place}: {why}")),
        );
        let collapsed = plan.collapsed;
        lines.extend(
            (collapsed > 0)
                .then(|| format!("collapsed {collapsed}: they differ only in unused parameters")),
        );
        let [timed, done] = self.timings;
        lines.extend((timed > 0).then(|| format!("{timed} configurations are timed; {done} done")));
        let seconds = std::time::Duration::from_secs_f64(self.seconds);
        lines.push(format!(
            "about {}, assuming a software driver on 2 cores",
            indicatif::HumanDuration(seconds)
        ));
        let states = plan.cells.iter().zip(self.states);
        lines.extend(
            states.map(|(cell, state)| format!("{} {state:6} {}", cell.id, plan.label(cell))),
        );
        lines.join("\n") + "\n"
    }

    /// Writes one object, its cells first, one per line.
    fn write_json(&self) -> Result<(), Failure> {
        let plan = self.plan;
        print_data("{\n  \"cells\": [")?;
        for (index, (cell, state)) in plan.cells.iter().zip(self.states).enumerate() {
            let names = |axis: AxisId| columns(axis).zip(fields(axis, &cell.point[axis]));
            let axes: BTreeMap<&str, String> =
                plan.columns.iter().flat_map(|axis| names(*axis)).collect();
            let line = json!({
                "id": cell.id,
                "radiance": cell.radiance,
                "reference": cell.reference,
                "state": state,
                "axes": axes,
            });
            let comma = if index == 0 { "" } else { "," };
            print_data(&format!("{comma}\n    {line}"))?;
        }
        let rest = format!("{:#}\n", self.rest());
        print_data(&format!("\n  ],\n{}", rest.trim_start_matches("{\n")))
    }

    fn rest(&self) -> serde_json::Value {
        let plan = self.plan;
        let exclusions = self
            .excluded()
            .map(|(count, why, place)| json!({ "why": why, "count": count, "place": place }));
        json!({
            "name": plan.config.name,
            "plan_hash": plan.hash,
            "excluded": exclusions.collect::<Vec<_>>(),
            "collapsed": plan.collapsed,
            "timings": self.timings[0],
            "timings_done": self.timings[1],
            "estimate": { "seconds": self.seconds },
        })
    }
}
