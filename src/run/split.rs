//! Splits a plan between processes that share one folder. Parts have no cell, reference or image in
//! common.
//!
//! Records and images are named by the hash of their content, so a merge only writes the tables.

use super::estimate::Steps;
use super::shard::Shard;
use super::timing;
use crate::experiment::axis::{BRDF, ENVIRONMENT};
use crate::experiment::plan::{Cell, Plan};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// The part of a plan that one process does.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Share {
    pub cells: BTreeSet<String>,
    pub timings: BTreeSet<String>,
    /// Whether it makes `live.json`.
    pub has_live: bool,
}

impl Share {
    pub fn of(plan: &Plan, shard: Shard) -> Self {
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
    let mut seconds = |cells: &[&Cell]| cells.iter().map(|cell| steps.cell(cell)).sum::<f64>();
    let units: Vec<(f64, Vec<&Cell>)> = units(plan)
        .into_iter()
        .map(|cells| (seconds(&cells), cells))
        .collect();
    let timed: f64 = jobs.iter().map(|job| steps.timing(job)).sum();
    let cells: f64 = units.iter().map(|(seconds, _)| seconds).sum();
    // If timings fill a part, the others get the cells.
    let is_apart = count > 1 && timed * count as f64 >= cells + timed;
    let (parts, total) = if is_apart {
        (count - 1, cells)
    } else {
        (count, cells + timed)
    };
    let mut shares = vec![Share::default(); count];
    let mut begun = 0.0;
    for (seconds, unit) in units {
        // The part that holds the middle of the unit.
        let place = (begun + 0.5 * seconds) / total * parts as f64;
        begun += seconds;
        shares[(place as usize).min(parts - 1)]
            .cells
            .extend(unit.iter().map(|cell| cell.id.clone()));
    }
    shares[count - 1].timings = jobs.into_iter().map(|job| job.id).collect();
    if let Some(first) = shares.iter_mut().find(|share| !share.cells.is_empty()) {
        first.has_live = true;
    }
    shares
}

/// Groups the cells that share references or images, ordered by environment and model.
fn units(plan: &Plan) -> Vec<Vec<&Cell>> {
    let groups = plan.groups();
    // Groups with a common image are one unit, named by its first group.
    let mut unit_of: Vec<usize> = (0..groups.len()).collect();
    let mut known: HashMap<&str, usize> = HashMap::new();
    for (place, group) in groups.iter().enumerate() {
        for id in std::iter::once(group.id).chain(group.radiances.iter().map(|(id, _)| *id)) {
            let other = unit_of[*known.entry(id).or_insert(place)];
            let [kept, lost] = [other.min(unit_of[place]), other.max(unit_of[place])];
            if kept != lost {
                unit_of
                    .iter_mut()
                    .filter(|unit| **unit == lost)
                    .for_each(|unit| *unit = kept);
            }
        }
    }
    let mut units: BTreeMap<usize, Vec<&Cell>> = BTreeMap::new();
    for (place, group) in groups.iter().enumerate() {
        units
            .entry(unit_of[place])
            .or_default()
            .extend(group.radiances.iter().flat_map(|(_, cells)| cells));
    }
    let mut units: Vec<Vec<&Cell>> = units.into_values().collect();
    let mut first: BTreeMap<Vec<String>, usize> = BTreeMap::new();
    let light_and_model = |unit: &Vec<&Cell>| {
        [ENVIRONMENT, BRDF]
            .map(|axis| unit[0].point[axis].to_string())
            .to_vec()
    };
    for (place, unit) in units.iter().enumerate() {
        let key = light_and_model(unit);
        first.entry(key[..1].to_vec()).or_insert(place);
        first.entry(key).or_insert(place);
    }
    units.sort_by_cached_key(|unit| {
        let key = light_and_model(unit);
        (first[&key[..1]], first[&key])
    });
    units
}
