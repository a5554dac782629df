//! One run by several processes: each does its part of the plan in a folder that all share, and a merge writes the
//! tables.
//!
//! Every process writes records and images by the id of their content, so there is nothing to join but the tables.
//! Parts have no cell, reference or image in common.

use super::estimate::{Steps, Work};
use super::shard::Shard;
use super::timing;
use crate::experiment::axis::{BRDF, ENVIRONMENT, ENVIRONMENT_CLIP};
use crate::experiment::plan::{Cell, Plan};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// The part of a plan that one process does.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Share {
    /// Ids of cells.
    pub cells: BTreeSet<String>,
    /// Ids of timed configurations.
    pub timings: BTreeSet<String>,
    /// Whether it makes what the live view of the report needs.
    pub has_live: bool,
}

impl Share {
    /// The part of a plan that belongs to a shard.
    pub fn of(plan: &Plan, shard: Shard) -> Self {
        split(plan, shard.count).swap_remove(shard.index - 1)
    }
}

/// Cells that share images.
struct Unit<'p> {
    cells: Vec<&'p Cell>,
    seconds: f64,
}

/// A plan in `count` parts of about the same stated cost, the same on every machine. Cells that share a reference or an
/// image stay together, and those of one environment and model follow each other, since they share tables. All timed
/// configurations are in the last part: times of two devices cannot be compared.
pub fn split(plan: &Plan, count: usize) -> Vec<Share> {
    let jobs = timing::jobs(plan);
    let mut steps = Steps::new(plan, &jobs, []);
    let units: Vec<Unit> =
        units(plan).into_iter().map(|cells| Unit { seconds: seconds(&cells, &mut steps), cells }).collect();
    let timed: f64 = jobs.iter().map(|job| steps.timing(job).stated_s()).sum();
    let cells: f64 = units.iter().map(|unit| unit.seconds).sum();
    // Timings that fill a part leave the cells to the others.
    let is_apart = count > 1 && timed * count as f64 >= cells + timed;
    let (parts, total) = if is_apart { (count - 1, cells) } else { (count, cells + timed) };
    let mut shares = vec![Share::default(); count];
    let mut begun = 0.0;
    for unit in units {
        // The part in which the middle of the unit falls.
        let place = (begun + 0.5 * unit.seconds) / total * parts as f64;
        begun += unit.seconds;
        shares[(place as usize).min(parts - 1)].cells.extend(unit.cells.iter().map(|cell| cell.id.clone()));
    }
    shares[count - 1].timings = jobs.into_iter().map(|job| job.id).collect();
    shares.iter_mut().find(|share| !share.cells.is_empty()).into_iter().for_each(|first| first.has_live = true);
    shares
}

fn seconds(cells: &[&Cell], steps: &mut Steps) -> f64 {
    let mut work = Work::default();
    cells.iter().for_each(|cell| work.append(&steps.cell(cell)));
    work.stated_s()
}

/// The cells of a plan that share references or images, in the order of their environments and models.
fn units(plan: &Plan) -> Vec<Vec<&Cell>> {
    let groups = plan.groups();
    // Groups with an image in common are one unit, named by the first of them.
    let mut unit_of: Vec<usize> = (0..groups.len()).collect();
    let mut known: HashMap<&str, usize> = HashMap::new();
    for (place, group) in groups.iter().enumerate() {
        for id in std::iter::once(group.id).chain(group.radiances.iter().map(|(id, _)| *id)) {
            let other = unit_of[*known.entry(id).or_insert(place)];
            let [kept, lost] = [other.min(unit_of[place]), other.max(unit_of[place])];
            if kept != lost {
                unit_of.iter_mut().filter(|unit| **unit == lost).for_each(|unit| *unit = kept);
            }
        }
    }
    let mut units: BTreeMap<usize, Vec<&Cell>> = BTreeMap::new();
    for (place, group) in groups.iter().enumerate() {
        units.entry(unit_of[place]).or_default().extend(group.radiances.iter().flat_map(|(_, cells)| cells));
    }
    let mut units: Vec<Vec<&Cell>> = units.into_values().collect();
    let mut first: BTreeMap<Vec<String>, usize> = BTreeMap::new();
    let light_and_model =
        |unit: &Vec<&Cell>| [ENVIRONMENT, ENVIRONMENT_CLIP, BRDF].map(|axis| unit[0].point[axis].to_string()).to_vec();
    for (place, unit) in units.iter().enumerate() {
        let key = light_and_model(unit);
        first.entry(key[..2].to_vec()).or_insert(place);
        first.entry(key).or_insert(place);
    }
    units.sort_by_cached_key(|unit| {
        let key = light_and_model(unit);
        (first[&key[..2]], first[&key])
    });
    units
}
