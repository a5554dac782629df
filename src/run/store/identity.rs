//! Checks whether a plan may run in a folder.
//!
//! Cells are named by their content, so a larger plan continues a smaller one. A plan that lacks a
//! finished cell is refused: the cell would drop out of the tables.

use super::lock::LOCK_FILE;
use super::{CELLS_FOLDER, SHARDS_FOLDER, SUBFOLDERS, Store, StoreError, TIMINGS_FOLDER, is_part};
use crate::base::csv::Table;
use crate::base::files::names_in;
use crate::experiment::id::Id;
use crate::experiment::plan::Plan;
use crate::instrument::metrics::METRICS;
use crate::run::columns::FAILED;
use crate::run::provenance::{self, Provenance};
use crate::run::timing;
use std::collections::{BTreeMap, BTreeSet};

impl Store {
    /// Checks that the folder holds no run, or one whose finished work `plan` includes. Returns
    /// whether it is a run of exactly this plan.
    pub fn check_identity(&self, plan: &Plan) -> Result<bool, StoreError> {
        if self.dir.is_file() {
            return Err(self.refused("is a file; expected a folder, or the name of a new one"));
        }
        let Some(found) = provenance::read(&self.dir)? else {
            return self.check_empty().map(|()| false);
        };
        if let Some(metric) = other_metric(&found) {
            return Err(self.refused(format!(
                "contains scores of another version of the metric {metric}; choose another --out"
            )));
        }
        if found.plan_hash == plan.hash {
            return Ok(true);
        }
        self.check_nothing_is_lost(&found, plan).map(|()| false)
    }

    fn refused(&self, why: impl Into<String>) -> StoreError {
        StoreError::Refused {
            dir: self.dir.clone(),
            why: why.into(),
        }
    }

    /// Fails if a folder without provenance holds files. A run stopped before its first file leaves
    /// only empty folders.
    fn check_empty(&self) -> Result<(), StoreError> {
        let is_written_by_a_run = |name: &String| {
            if self.dir.join(name).is_dir() {
                name == SHARDS_FOLDER || SUBFOLDERS.contains(&name.as_str())
            } else {
                name == LOCK_FILE || is_part(name)
            }
        };
        if names_in(&self.dir).iter().all(is_written_by_a_run) {
            return Ok(());
        }
        Err(self.refused(
            "is not empty and not a run (it has no provenance.json); choose another --out",
        ))
    }

    /// Fails if the folder holds finished work that `plan` lacks; `found` is the folder's
    /// provenance.
    pub(in crate::run) fn check_nothing_is_lost(
        &self,
        found: &Provenance,
        plan: &Plan,
    ) -> Result<(), StoreError> {
        let lost = self.lost_cells(plan)?.len();
        if lost > 0 {
            let cause = cause(found, &Provenance::new(plan, &self.dir));
            let path = plan.config.path.display();
            return Err(self.refused(format!(
                "holds another run; choose another --out ({lost} finished cells are not in \
                 {path}{cause})"
            )));
        }
        let jobs: BTreeSet<Id> = timing::jobs(plan).into_iter().map(|job| job.id).collect();
        let lost = self
            .ids(TIMINGS_FOLDER)
            .into_iter()
            .filter(|id| !jobs.contains(id) && self.has_timing(*id))
            .count();
        match lost {
            0 => Ok(()),
            lost => Err(self.refused(format!(
                "holds another run; choose another --out ({lost} timed configurations are not in \
                 {})",
                plan.config.path.display()
            ))),
        }
    }

    /// Ids of finished cells that `plan` lacks, from usable records and, in a published folder,
    /// from the table.
    fn lost_cells(&self, plan: &Plan) -> Result<BTreeSet<String>, StoreError> {
        let planned: BTreeSet<Id> = plan.cells.iter().map(|cell| cell.id).collect();
        let mut lost = BTreeSet::new();
        for id in self
            .ids(CELLS_FOLDER)
            .into_iter()
            .filter(|id| !planned.contains(id))
        {
            if self.cell(id)?.is_some() {
                lost.insert(id.to_string());
            }
        }
        let path = self.dir.join("errors.csv");
        if path.is_file() {
            let table = Table::read(&path)?;
            let [cell, verdict] = [table.column("cell")?, table.column("verdict")?];
            let is_lost = |row: &&Vec<String>| {
                row[verdict] != FAILED
                    && !row[cell].parse().is_ok_and(|id: Id| planned.contains(&id))
            };
            lost.extend(
                table
                    .rows
                    .iter()
                    .filter(is_lost)
                    .map(|row| row[cell].clone()),
            );
        }
        Ok(lost)
    }

    /// Ids of the records in a folder, in order.
    pub fn ids(&self, folder: &str) -> Vec<Id> {
        let stems = self.stems(folder);
        stems.iter().filter_map(|stem| stem.parse().ok()).collect()
    }

    /// Names of the JSON files in a folder without their extension, in order.
    pub fn stems(&self, folder: &str) -> Vec<String> {
        let names = names_in(&self.dir.join(folder));
        names
            .iter()
            .filter_map(|name| Some(name.strip_suffix(".json")?.to_owned()))
            .collect()
    }
}

/// The first metric with another version than in this program.
fn other_metric(provenance: &Provenance) -> Option<String> {
    let versions: BTreeMap<&str, u64> = provenance
        .metrics
        .iter()
        .map(|metric| (metric.name.as_str(), metric.version))
        .collect();
    METRICS
        .iter()
        .find(|metric| {
            versions
                .get(metric.name)
                .is_some_and(|version| *version != u64::from(metric.version))
        })
        .map(|metric| metric.name.to_owned())
}

/// The reason why all cells differ, by both provenances: " (seed is 1 there and 2 here)"; else
/// empty.
fn cause(there: &Provenance, here: &Provenance) -> String {
    if there.shader_hash != here.shader_hash {
        return ": they were rendered by other shaders".to_owned();
    }
    let changed = there
        .inputs
        .iter()
        .find(|(name, hash)| here.inputs.get(*name).is_some_and(|now| now != *hash));
    if let Some((name, _)) = changed {
        return format!(": {name} has changed since");
    }
    if there.seed != here.seed {
        return format!(": seed is {} there and {} here", there.seed, here.seed);
    }
    if there.reference != here.reference {
        let json = |reference| serde_json::to_string(reference).unwrap_or_default();
        return format!(
            ": reference is {} there and {} here",
            json(&there.reference),
            json(&here.reference)
        );
    }
    String::new()
}
