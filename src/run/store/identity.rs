//! Whose run a folder holds, and whether it may become the run of another plan.

use super::lock::LOCK_FILE;
use super::{
    CELLS_FOLDER, CHUNKS_FOLDER, FAILED_FOLDER, PLAN_FILE, SUBFOLDERS, Store, StoreError, TIMINGS_FOLDER, is_part,
};
use crate::experiment::axis::AXES;
use crate::experiment::inputs::short_names;
use crate::experiment::plan::Plan;
use crate::experiment::value::Kind;
use crate::files::names_in;
use crate::metrics::METRICS;
use crate::run::provenance;
use crate::run::timing;
use crate::spelling::short_number;
use crate::table::csv::Table;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Names that a message lists.
const LISTED: usize = 3;

/// A run of another plan of the same experiment, seen by a plan that has all of its cells.
#[derive(Clone, Debug)]
pub struct Extension {
    /// `provenance.json` of the run.
    pub from: Value,
    /// Ids of the cells that are finished.
    pub kept: BTreeSet<String>,
    /// How many timed configurations have records but stand in a block with some that have none: a block is a set of configurations timed in
    /// the same rounds, so that it is timed anew as a whole.
    pub timed_again: usize,
}

impl Store {
    /// Fails when the folder holds something else than a run of this plan.
    pub fn check_identity(&self, plan: &Plan) -> Result<(), StoreError> {
        match self.extension(plan)? {
            None => Ok(()),
            Some(extension) => {
                let (name, found) = (&plan.config.name, extension.from["plan_hash"].as_str().unwrap_or_default());
                let count = self.tabulated()?.len();
                Err(self.refused(format!(
                    "holds a run of another plan of {name} ({found}), and each of its {count} cells is in this one; `splitsum run --extend` \
                     keeps them and does the others, else give another --out"
                )))
            }
        }
    }

    fn refused(&self, why: impl Into<String>) -> StoreError {
        StoreError::Refused { dir: self.dir.clone(), why: why.into() }
    }

    /// The [`Extension`] of the run in the folder, where it is one of another plan that the plan extends; `None` where it is one of this
    /// plan, or none at all. Fails when the folder holds something else.
    pub fn extension(&self, plan: &Plan) -> Result<Option<Extension>, StoreError> {
        if self.dir.is_file() {
            return Err(self.refused("is a file; expected a folder, or the name of one to make"));
        }
        match provenance::read(&self.dir)? {
            None => self.check_empty().map(|()| None),
            Some(found) if found["plan_hash"] == plan.hash => Ok(None),
            Some(found) => self.extension_of(found, plan).map(Some),
        }
    }

    /// Fails when a folder without provenance holds files: a run that was stopped before its first file leaves empty folders only.
    fn check_empty(&self) -> Result<(), StoreError> {
        let is_own = |name: &str, is_dir: bool| match is_dir {
            true => name == CHUNKS_FOLDER || SUBFOLDERS.contains(&name),
            false => [LOCK_FILE, PLAN_FILE].contains(&name) || is_part(name),
        };
        let is_own = |name: &String| is_own(name, self.dir.join(name).is_dir());
        match names_in(&self.dir).iter().all(is_own) {
            true => Ok(()),
            false => Err(self.refused("is not empty and not a run (it has no provenance.json); give another --out")),
        }
    }

    fn extension_of(&self, found: Value, plan: &Plan) -> Result<Extension, StoreError> {
        let name = &plan.config.name;
        if found["shader_hash"] != crate::gpu::build_hash() {
            let why = "holds a run made with other shaders, whose images may differ; give another --out, or remove it";
            return Err(self.refused(why));
        }
        if found["name"] != *name {
            let overrides: String = plan.config.overrides.iter().map(|o| format!(" --set {o}")).collect();
            return Err(self.refused(format!(
                "holds a run of another experiment ({}: its cells are not those of {}{overrides}); give another --out, or remove it",
                found["name"],
                plan.config.path.display()
            )));
        }
        if let Some(metric) = other_metric(&found) {
            return Err(self.refused(format!(
                "holds a run scored by another version of the metric {metric}, whose numbers do not belong beside those of this one; give \
                 another --out"
            )));
        }
        let tabulated = self.tabulated()?;
        let differs = self.difference(&found, &tabulated, plan);
        let would_lose = |what: &str, count: usize, lost: &[String]| {
            let more = lost.len().saturating_sub(LISTED);
            let listed =
                lost[..lost.len() - more].join("; ") + &if more > 0 { format!("; {more} more") } else { String::new() };
            self.refused(format!(
                "holds a run of another plan of {name}{differs}. Of its {count} {what} {} would not be in the tables of this one: {listed}; \
                 give another --out, or extend it (`splitsum run --extend`) by a plan with all of them",
                lost.len()
            ))
        };
        let planned: BTreeSet<&str> = plan.cells.iter().map(|cell| cell.id.as_str()).collect();
        let count = self.in_tables_alone(&tabulated)?;
        if count > 0 {
            return Err(self.refused(format!(
                "holds the tables of a run of another plan, but no records of {count} of its cells, as a published run does; give another \
                 --out, or extend the run that it was published from"
            )));
        }
        let lost: Vec<&String> = tabulated.keys().filter(|id| !planned.contains(id.as_str())).collect();
        if !lost.is_empty() {
            let lost: Vec<String> = lost.into_iter().map(|id| words(id, &tabulated)).collect();
            return Err(would_lose("cells", tabulated.len(), &lost));
        }
        let jobs = timing::jobs(plan);
        let timed: Vec<String> = self.ids(TIMINGS_FOLDER).into_iter().filter(|id| self.has_timing(id)).collect();
        let to_time: BTreeSet<&str> = jobs.iter().map(|job| job.id.as_str()).collect();
        let lost: Vec<String> = timed.iter().filter(|id| !to_time.contains(id.as_str())).cloned().collect();
        if !lost.is_empty() {
            return Err(would_lose("timed configurations (their [timing] counts)", timed.len(), &lost));
        }
        let is_timed = |id: &String| timed.contains(id);
        let blocks = jobs.chunk_by(|a, b| a.block == b.block);
        let partly = blocks.filter(|block| !block.iter().all(|job| is_timed(&job.id)));
        let timed_again = partly.flatten().filter(|job| is_timed(&job.id)).count();
        let mut kept = BTreeSet::new();
        for id in tabulated.into_keys() {
            if self.cell(&id)?.is_some() {
                kept.insert(id);
            }
        }
        Ok(Extension { from: found, kept, timed_again })
    }

    /// ": alpha is 0.1, 0.5 there and 0.1, 0.25 here": the first axis or key that tells the run in the folder from a plan.
    fn difference(&self, found: &Value, cells: &BTreeMap<String, BTreeMap<String, String>>, plan: &Plan) -> String {
        let there = |axis: usize| cells.values().filter_map(move |axes| axes.get(AXES[axis].name).cloned());
        let here = |axis: usize| plan.cells.iter().map(move |cell| cell.point[axis].to_string());
        // A file has as many spellings as folders to name it from: its short name stands for it.
        let set = |axis: usize, values: &mut dyn Iterator<Item = String>| -> BTreeSet<String> {
            let texts: BTreeSet<String> = values.filter(|text| !text.is_empty()).collect();
            let is_file = matches!(AXES[axis].kind, Kind::Input);
            if is_file { short_names(texts.iter().map(String::as_str)).into_values().collect() } else { texts }
        };
        let of_axis = (0..AXES.len()).find_map(|axis| {
            let [there, here] = [set(axis, &mut there(axis)), set(axis, &mut here(axis))];
            let listed = |values: &BTreeSet<String>| {
                let mut values: Vec<_> = values.iter().map(|text| short_number(text)).collect();
                // Names stand as they are.
                values.sort_by(|a, b| a.parse::<f64>().unwrap_or(0.0).total_cmp(&b.parse::<f64>().unwrap_or(0.0)));
                values.join(", ")
            };
            (there != here).then(|| [AXES[axis].name.to_owned(), listed(&there), listed(&here)])
        });
        let new = provenance::provenance(plan, &self.dir);
        let of_key = || {
            let contents = |all: &Value| -> BTreeSet<String> {
                all.as_object().into_iter().flat_map(|all| all.values()).map(Value::to_string).collect()
            };
            let differs = |key: &&str| match *key {
                "inputs" => contents(&found[*key]) != contents(&new[*key]),
                key => found[key] != new[key],
            };
            let key = ["seed", "reference", "inputs"].into_iter().find(differs)?;
            let entries = found[key].as_object().into_iter().chain(new[key].as_object()).flat_map(|all| all.keys());
            let entry = entries.map(String::as_str).find(|entry| found[key][*entry] != new[key][*entry]);
            let of = |all: &Value| entry.map_or(&all[key], |entry| &all[key][entry]).to_string();
            let name = entry.map_or(key.to_owned(), |entry| format!("{key}.{entry}"));
            Some([name, of(found), of(&new)])
        };
        let told = of_axis.or_else(of_key);
        told.map_or_else(String::new, |[what, there, here]| format!(": {what} is {there} there and {here} here"))
    }

    /// Id and axes of every cell that the tables of the run in the folder name: those with a record that can be used. Of failed ones no axes
    /// are known.
    fn tabulated(&self) -> Result<BTreeMap<String, BTreeMap<String, String>>, StoreError> {
        let mut found = BTreeMap::new();
        for id in self.ids(FAILED_FOLDER) {
            if self.failure(&id)?.is_some() {
                found.insert(id, BTreeMap::new());
            }
        }
        for id in self.ids(CELLS_FOLDER) {
            if let Some(record) = self.cell(&id)? {
                found.insert(id, record.axes);
            }
        }
        Ok(found)
    }

    /// How many cells stand in `errors.csv` but not in `records`.
    fn in_tables_alone(&self, records: &BTreeMap<String, BTreeMap<String, String>>) -> Result<usize, StoreError> {
        let path = self.dir.join("errors.csv");
        if !path.is_file() {
            return Ok(0);
        }
        let table = Table::read(&path)?;
        let cell = table.column("cell")?;
        Ok(table.rows.iter().filter(|row| !records.contains_key(&row[cell])).count())
    }

    /// Names of the records in a folder, in order; none where it does not exist.
    pub fn ids(&self, folder: &str) -> Vec<String> {
        let names = names_in(&self.dir.join(folder));
        names.iter().filter_map(|name| Some(name.strip_suffix(".json")?.to_owned())).collect()
    }
}

/// The first metric of this program that has another version in a run, or that only one of them has.
fn other_metric(provenance: &Value) -> Option<String> {
    let then = provenance["metrics"].as_array().into_iter().flatten();
    let then: BTreeMap<&str, u64> =
        then.filter_map(|metric| Some((metric["name"].as_str()?, metric["version"].as_u64()?))).collect();
    let descriptions = METRICS.iter().map(|metric| metric.description());
    let now: BTreeMap<&str, u64> = descriptions.map(|d| (d.name, u64::from(d.version))).collect();
    let mut names = then.keys().chain(now.keys());
    names.find(|name| then.get(*name) != now.get(*name)).map(|name| name.to_string())
}

/// A cell by what tells it from the others of its run.
fn words(id: &str, cells: &BTreeMap<String, BTreeMap<String, String>>) -> String {
    let varies = |name: &str| {
        let values = cells.values().filter_map(|axes| axes.get(name));
        // What only some methods use tells nothing beside the method.
        let values: BTreeSet<&String> = values.filter(|value| !value.is_empty()).collect();
        values.len() > 1
    };
    let axes = &cells[id];
    let swept = AXES.iter().filter(|axis| varies(axis.name));
    let set = swept.filter_map(|axis| Some((axis.name, axes.get(axis.name).filter(|value| !value.is_empty())?)));
    let words = set.map(|(name, value)| format!(" {name}={}", short_number(value)));
    format!("{id}{}", words.collect::<String>())
}
