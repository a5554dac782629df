//! The copy of the experiment, and an entry in the provenance for each invocation that did work.

use super::{Progress, Run, RunError};
use crate::base::files::holds;
use crate::instrument::pipeline::DeviceInfo;
use crate::run::frozen::EXPERIMENT_FILE;
use crate::run::provenance;
use crate::run::shard::Shard;
use crate::run::store::{FAILED_FOLDER, SHARDS_FOLDER};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::time::Instant;

const SHARD: &str = "shard";

impl Run<'_> {
    /// Makes the folder one of this plan and text: for a new run, a larger plan, a changed comment,
    /// a lost file. Returns whether it held a run of another plan.
    pub(super) fn adopt(&self, progress: &mut dyn Progress) -> Result<bool, RunError> {
        let found = provenance::read(self.store.dir())?;
        let is_other = found
            .as_ref()
            .is_some_and(|found| found["plan_hash"] != self.plan.hash);
        if is_other {
            let (all, done) = (self.own_cells().count(), self.results.len());
            progress.note(&format!(
                "continues a run of another plan: {done} of {all} cells are done"
            ));
            // They lack the environments and models of new cells.
            if done < all && self.makes_plan_files() {
                for file in self.options.companions.plan_files {
                    self.store.remove("", file.name())?;
                }
            }
            let planned: BTreeSet<&str> = self
                .plan
                .cells
                .iter()
                .map(|cell| cell.id.as_str())
                .collect();
            let gone = self
                .store
                .ids(FAILED_FOLDER)
                .into_iter()
                .filter(|id| !planned.contains(id.as_str()));
            gone.into_iter()
                .try_for_each(|id| self.store.remove_record(FAILED_FOLDER, &id))?;
        } else if found.is_some()
            && !holds(
                &self.store.dir().join(EXPERIMENT_FILE),
                self.plan.config.text.as_bytes(),
            )
        {
            progress.note(&format!(
                "{EXPERIMENT_FILE} was missing or edited; writing it again"
            ));
        }
        self.write_own()?;
        Ok(is_other)
    }

    /// Writes the copy of the experiment and the provenance, unless they are up to date.
    pub(super) fn write_own(&self) -> Result<(), RunError> {
        let (plan, dir) = (self.plan, self.store.dir());
        let value = match provenance::read(dir)? {
            Some(found) => provenance::of_now(&found, plan, dir),
            None => Some(provenance::provenance(plan, dir)),
        };
        if let Some(value) = value {
            self.store
                .write_json(&self.store.provenance_path(), &value)?;
        }
        Ok(self
            .store
            .write_text(&dir.join(EXPERIMENT_FILE), &plan.config.text)?)
    }

    /// Adds this invocation to the provenance, or to the sessions of its shard.
    pub(super) fn begin_session(&self, device: &DeviceInfo) -> Result<(), RunError> {
        let path = self.store.sessions_path();
        let mut value = provenance::read_file(&path)?
            .unwrap_or_else(|| provenance::provenance(self.plan, self.store.dir()));
        if let Some(sessions) = value["sessions"].as_array_mut() {
            let mut session = provenance::session(device, &self.options.command_line);
            session["plan_hash"] = json!(self.plan.hash);
            if let Some(shard) = self.options.shard {
                session[SHARD] = json!(shard.to_string());
                session["host"]["name"] = json!(provenance::host_name());
            }
            sessions.push(session);
        }
        Ok(self.store.write_json(&path, &value)?)
    }

    /// Copies the sessions of shards into the provenance of the run, ordered by date.
    pub(super) fn gather_sessions(&self) -> Result<(), RunError> {
        let shards = self
            .store
            .ids(SHARDS_FOLDER)
            .into_iter()
            .filter_map(|stem| Shard::by_stem(&stem));
        let Some(mut value) = provenance::read(self.store.dir())? else {
            return Ok(());
        };
        let list = |value: &Value| value["sessions"].as_array().cloned().unwrap_or_default();
        let mut sessions = list(&value);
        sessions.retain(|session| session[SHARD].is_null());
        for shard in shards {
            sessions.extend(
                provenance::read_file(&self.store.shard_path(shard))?
                    .iter()
                    .flat_map(list),
            );
        }
        sessions.sort_by_cached_key(|session| session["date_utc"].to_string());
        value["sessions"] = sessions.into();
        Ok(self
            .store
            .write_json(&self.store.provenance_path(), &value)?)
    }

    /// Completes this invocation's entry in the provenance.
    pub(super) fn end_session(&self, started: Instant) -> Result<(), RunError> {
        let path = self.store.sessions_path();
        let Some(mut value) = provenance::read_file(&path)? else {
            return Ok(());
        };
        if let Some(session) = value["sessions"]
            .as_array_mut()
            .and_then(|sessions| sessions.last_mut())
        {
            session["wall_s"] = json!(started.elapsed().as_secs_f64());
        }
        Ok(self.store.write_json(&path, &value)?)
    }
}
