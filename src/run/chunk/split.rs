//! Cuts a plan into chunks of about equal cost.
//!
//! The cut is a function of the plan, the wanted length and the prices, and of nothing else. Cells that share a reference stay together;
//! only a group whose own images outweigh its reference is parted, since each part renders the reference again. Groups of one
//! environment and model follow each other, because they share tables. Configurations that are compared by time are never parted, nor
//! parted from the tables they are weighed against: a ratio over two devices would mean nothing.

use super::prices::Prices;
use crate::experiment::axis::{BRDF, ENVIRONMENT, ENVIRONMENT_CLIP, Point};
use crate::experiment::plan::{Cell, Plan, ReferenceGroup};
use crate::run::estimate::Item;
use crate::run::timing::{self, TimingJob};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// The work of one process.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Chunk {
    /// Its number, from 0.
    pub index: usize,
    /// Expected seconds at the plan file's prices.
    pub seconds: f64,
    /// Ids of cells, in the order of the plan.
    pub cells: Vec<String>,
    /// Ids of timed configurations, block after block.
    pub timings: Vec<String>,
}

impl Chunk {
    /// The ids of its timed configurations block by block; `jobs` are those of the whole plan.
    pub fn blocks(&self, jobs: &[TimingJob]) -> Vec<Vec<String>> {
        let block_of: BTreeMap<&str, &str> = jobs.iter().map(|job| (job.id.as_str(), job.block.as_str())).collect();
        let same = |a: &String, b: &String| block_of.get(a.as_str()) == block_of.get(b.as_str());
        self.timings.chunk_by(same).map(<[String]>::to_vec).collect()
    }
}

/// Work that is never parted.
#[derive(Default)]
struct Unit<'p> {
    cells: Vec<&'p Cell>,
    jobs: Vec<TimingJob<'p>>,
    /// Seconds without what can be shared.
    seconds: f64,
    /// References and tables by name, each with its seconds: a chunk pays for each once.
    shared: BTreeMap<String, f64>,
}

/// A chunk that is being filled.
#[derive(Default)]
struct Load<'p> {
    units: Vec<Unit<'p>>,
    seconds: f64,
    shared: BTreeSet<String>,
}

impl Load<'_> {
    /// Seconds that a unit would add.
    fn extra(&self, unit: &Unit) -> f64 {
        let shared = unit.shared.iter().filter(|(name, _)| !self.shared.contains(*name)).map(|(_, seconds)| seconds);
        unit.seconds + shared.sum::<f64>()
    }
}

/// The chunks of a plan, each of about `seconds`: more only where one unit takes longer, less where the next one did not fit.
pub fn split(plan: &Plan, seconds: f64, prices: &Prices) -> Vec<Chunk> {
    let mut units: Vec<Unit> =
        ordered(plan).iter().flat_map(|group| cell_units(plan, group, seconds, prices)).collect();
    units.extend(timing_units(plan, prices));
    let start = prices.seconds(&Item::start());
    let mut loads: Vec<Load> = Vec::new();
    for unit in units {
        let fits = |load: &Load| load.seconds + load.extra(&unit) <= seconds;
        if !loads.last().is_some_and(fits) {
            loads.push(Load { seconds: start, ..Load::default() });
        }
        if let Some(load) = loads.last_mut() {
            load.seconds += load.extra(&unit);
            load.shared.extend(unit.shared.keys().cloned());
            load.units.push(unit);
        }
    }
    let places: BTreeMap<&str, usize> = plan.cells.iter().enumerate().map(|(i, c)| (c.id.as_str(), i)).collect();
    let chunk = |(index, load): (usize, Load)| {
        let mut cells: Vec<&Cell> = load.units.iter().flat_map(|unit| &unit.cells).copied().collect();
        cells.sort_by_key(|cell| places[cell.id.as_str()]);
        Chunk {
            index,
            // To the millisecond: people read it.
            seconds: (load.seconds * 1e3).round() / 1e3,
            cells: cells.into_iter().map(|cell| cell.id.clone()).collect(),
            timings: load.units.iter().flat_map(|unit| &unit.jobs).map(|job| job.id.clone()).collect(),
        }
    };
    loads.into_iter().enumerate().map(chunk).collect()
}

/// The reference groups, those that share an environment and a model beside each other, each in the place of the first of them.
fn ordered(plan: &Plan) -> Vec<ReferenceGroup<'_>> {
    let environment_and_model = |group: &ReferenceGroup| {
        let point = &group.radiances[0].1[0].point;
        [ENVIRONMENT, ENVIRONMENT_CLIP, BRDF].map(|axis| point[axis].to_string()).to_vec()
    };
    let mut groups = plan.groups();
    let mut first: BTreeMap<Vec<String>, usize> = BTreeMap::new();
    for (place, group) in groups.iter().enumerate() {
        let key = environment_and_model(group);
        first.entry(key[..2].to_vec()).or_insert(place);
        first.entry(key).or_insert(place);
    }
    groups.sort_by_cached_key(|group| {
        let key = environment_and_model(group);
        (first[&key[..2]], first[&key])
    });
    groups
}

/// A group whole, or in parts that each cost no less than the reference they render again.
fn cell_units<'p>(plan: &Plan, group: &ReferenceGroup<'p>, seconds: f64, prices: &Prices) -> Vec<Unit<'p>> {
    let first = group.radiances[0].1[0];
    let reference = prices.seconds(&Item::reference(plan, first));
    let start = prices.seconds(&Item::start());
    let own = |id: &str, cells: &[&Cell]| {
        let image = if id == group.id { 0.0 } else { prices.seconds(&Item::image(plan, &cells[0].point)) };
        let beside = cells.iter().enumerate().flat_map(|(i, cell)| Item::cell(plan, cell, i == 0));
        image + beside.map(|item| prices.seconds(&item)).sum::<f64>()
    };
    let total: f64 = group.radiances.iter().map(|(id, cells)| own(id, cells)).sum();
    let parts = match start + reference + total <= seconds {
        true => 1.0,
        false => (total / (seconds - start - reference).max(reference)).ceil().max(1.0),
    };
    let mut units = vec![Unit::default()];
    let mut begun = 0.0;
    for (id, cells) in &group.radiances {
        let share = own(id, cells);
        // The part in which the middle of this image falls.
        let part = ((begun + 0.5 * share) / total * parts).floor() + 1.0;
        begun += share;
        if part > units.len() as f64 && units.last().is_some_and(|unit| !unit.cells.is_empty()) {
            units.push(Unit::default());
        }
        if let Some(unit) = units.last_mut() {
            unit.seconds += share;
            unit.cells.extend(cells);
            unit.shared.insert(format!("reference {}", group.id), reference);
            unit.shared.extend(priced_tables(plan, &cells[0].point, prices));
        }
    }
    units
}

/// The tables of a point, each with its seconds.
fn priced_tables(plan: &Plan, point: &Point, prices: &Prices) -> Vec<(String, f64)> {
    Item::tables(plan, point).into_iter().map(|(key, item)| (key, prices.seconds(&item))).collect()
}

/// Blocks of configurations that are compared, with the tables whose times they are weighed against.
fn timing_units<'p>(plan: &'p Plan, prices: &Prices) -> Vec<Unit<'p>> {
    let Some(timing) = plan.config.timing else { return Vec::new() };
    let jobs = timing::jobs(plan);
    let mut members: BTreeMap<String, usize> = BTreeMap::new();
    for job in &jobs {
        *members.entry(job.block.clone()).or_default() += 1;
    }
    let mut unit_of: BTreeMap<String, usize> = BTreeMap::new();
    let mut units: Vec<Unit> = Vec::new();
    for job in jobs {
        let tables_key = format!("{:?} {}", job.environment_size, job.cell.point[BRDF]);
        let known = [&job.block, &tables_key].into_iter().find_map(|key| unit_of.get(key)).copied();
        let index = known.unwrap_or(units.len());
        if known.is_none() {
            units.push(Unit::default());
        }
        unit_of.insert(job.block.clone(), index);
        unit_of.insert(tables_key, index);
        units[index].shared.extend(priced_tables(plan, &job.cell.point, prices));
        let work = Item::timing(plan, timing, &job, members[&job.block]);
        units[index].seconds += work.iter().map(|item| prices.seconds(item)).sum::<f64>();
        units[index].jobs.push(job);
    }
    for unit in &mut units {
        // A block that begins between the members of another stays whole.
        let blocks: Vec<String> = unit.jobs.iter().map(|job| job.block.clone()).collect();
        unit.jobs.sort_by_key(|job| blocks.iter().position(|block| *block == job.block));
    }
    units
}
