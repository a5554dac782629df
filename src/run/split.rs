//! Splits a plan between processes that share one folder. Parts have no cell, reference or image in
//! common.
//!
//! Records and images are named by the hash of their content, so a merge only writes the tables.

use super::estimate::Steps;
use super::shard::Shard;
use super::timing;
use crate::experiment::axis::{BRDF, ENVIRONMENT};
use crate::experiment::id::Id;
use crate::experiment::plan::{Cell, Plan};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// The part of a plan that one process does.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Share {
    pub cells: BTreeSet<Id>,
    pub timings: BTreeSet<Id>,
    /// Whether it makes the files of the plan (`companion`).
    pub has_live: bool,
}

impl Share {
    pub fn new(plan: &Plan, shard: Shard) -> Self {
        split(plan, shard.count).swap_remove(shard.index - 1)
    }
}

/// Splits a plan into `count` parts of similar stated work, the same on every machine. Cells that
/// share a reference or an image stay together; cells of one environment and model, which share
/// tables, follow each other. All timed configurations are in the last part: times of two devices
/// cannot be compared.
pub fn split(plan: &Plan, count: usize) -> Vec<Share> {
    let jobs = timing::jobs(plan);
    let mut steps = Steps::new(plan, &jobs, []);
    let units: Vec<Unit> = units(plan)
        .into_iter()
        .map(|cells| Unit {
            seconds: cells.iter().map(|cell| steps.cell(cell)).sum(),
            cells,
        })
        .collect();
    let timed: f64 = jobs.iter().map(|job| steps.timing(job)).sum();
    let cells: f64 = units.iter().map(|unit| unit.seconds).sum();
    // If timings fill a part, the others get the cells.
    let is_apart = count > 1 && timed * count as f64 >= cells + timed;
    let parts = if is_apart { count - 1 } else { count };
    let total = if is_apart { cells } else { cells + timed };
    let mut shares = vec![Share::default(); count];
    let mut begun = 0.0;
    for unit in units {
        // The part that holds the middle of the unit.
        let part = (begun + 0.5 * unit.seconds) / total * parts as f64;
        begun += unit.seconds;
        shares[(part as usize).min(parts - 1)]
            .cells
            .extend(unit.cells.iter().map(|cell| cell.id));
    }
    shares[count - 1].timings = jobs.into_iter().map(|job| job.id).collect();
    if let Some(first) = shares.iter_mut().find(|share| !share.cells.is_empty()) {
        first.has_live = true;
    }
    shares
}

/// Cells that stay together.
struct Unit<'p> {
    /// Stated work.
    seconds: f64,
    cells: Vec<&'p Cell>,
}

/// Groups the cells that share references or images, ordered by environment and model.
fn units(plan: &Plan) -> Vec<Vec<&Cell>> {
    let groups = plan.groups();
    // Groups with a common image are one unit, named by its first group.
    let mut unit_of: Vec<usize> = (0..groups.len()).collect();
    let mut known: HashMap<Id, usize> = HashMap::new();
    for (index, group) in groups.iter().enumerate() {
        let images = group.radiances.iter().map(|radiance| radiance.id);
        for id in group.reference.into_iter().chain(images) {
            let other = unit_of[*known.entry(id).or_insert(index)];
            let kept = other.min(unit_of[index]);
            let merged = other.max(unit_of[index]);
            for unit in &mut unit_of {
                if *unit == merged {
                    *unit = kept;
                }
            }
        }
    }
    let mut units: BTreeMap<usize, Vec<&Cell>> = BTreeMap::new();
    for (index, group) in groups.iter().enumerate() {
        units
            .entry(unit_of[index])
            .or_default()
            .extend(group.cells());
    }
    let mut units: Vec<Vec<&Cell>> = units.into_values().collect();
    let mut first: BTreeMap<Vec<String>, usize> = BTreeMap::new();
    let light_and_model = |unit: &Vec<&Cell>| {
        [ENVIRONMENT, BRDF]
            .map(|axis| unit[0].point[axis].to_string())
            .to_vec()
    };
    for (index, unit) in units.iter().enumerate() {
        let key = light_and_model(unit);
        first.entry(key[..1].to_vec()).or_insert(index);
        first.entry(key).or_insert(index);
    }
    units.sort_by_cached_key(|unit| {
        let key = light_and_model(unit);
        (first[&key[..1]], first[&key])
    });
    units
}
