//! The copy of the experiment, and an entry in the provenance for each invocation that did work.

use super::{Progress, Run, RunError};
use crate::base::files::holds;
use crate::experiment::id::Id;
use crate::instrument::pipeline::DeviceInfo;
use crate::run::frozen::EXPERIMENT_FILE;
use crate::run::provenance::{self, Provenance, Session};
use crate::run::shard::Shard;
use crate::run::store::{FAILED_FOLDER, SHARDS_FOLDER};
use std::collections::BTreeSet;
use std::time::Instant;

impl Run<'_> {
    /// Makes the folder one of this plan and text: for a new run, a larger plan, a changed comment,
    /// a lost file. Returns whether it held a run of another plan.
    pub(super) fn adopt(&self, progress: &mut dyn Progress) -> Result<bool, RunError> {
        let found = provenance::read(self.store.dir())?;
        let is_other = found
            .as_ref()
            .is_some_and(|found| found.plan_hash != self.plan.hash);
        if is_other {
            let all = self.share_cells().count();
            let done = self.results.done_count();
            progress.note(&format!(
                "continues a run of another plan: {done} of {all} cells are done"
            ));
            // They lack the environments, models and pictures of new cells. A share knows its own
            // cells alone; the share that makes the files may come later, and then sees this plan
            // already.
            if done < all || self.options.shard.is_some() {
                for file in self.options.companions.plan_files {
                    self.store.remove("", file.name())?;
                }
            }
            let planned: BTreeSet<Id> = self.plan.cells.iter().map(|cell| cell.id).collect();
            let gone = self
                .store
                .ids(FAILED_FOLDER)
                .into_iter()
                .filter(|id| !planned.contains(id));
            gone.into_iter()
                .try_for_each(|id| self.store.remove_record(FAILED_FOLDER, id))?;
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
        self.write_identity()?;
        Ok(is_other)
    }

    /// Writes the copy of the experiment and the provenance, unless they are up to date.
    pub(super) fn write_identity(&self) -> Result<(), RunError> {
        let plan = self.plan;
        let dir = self.store.dir();
        let changed = match provenance::read(dir)? {
            Some(found) => found.updated(plan, dir),
            None => Some(Provenance::new(plan, dir)),
        };
        if let Some(provenance) = changed {
            self.store
                .write_provenance(&self.store.provenance_path(), &provenance)?;
        }
        Ok(self
            .store
            .write_text(&dir.join(EXPERIMENT_FILE), &plan.config.text)?)
    }

    /// Adds this invocation to the provenance, or to the sessions of its shard.
    pub(super) fn begin_session(&self, device: &DeviceInfo) -> Result<(), RunError> {
        let path = self.store.sessions_path();
        let mut provenance = provenance::read_file(&path)?
            .unwrap_or_else(|| Provenance::new(self.plan, self.store.dir()));
        let mut session = Session::new(device, &self.options.command_line, &self.plan.hash);
        if let Some(shard) = self.options.shard {
            session.shard = Some(shard.to_string());
            session.host.name = Some(provenance::host_name());
        }
        provenance.sessions.push(session);
        Ok(self.store.write_provenance(&path, &provenance)?)
    }

    /// Copies the sessions of shards into the provenance of the run, ordered by date.
    pub(super) fn gather_sessions(&self) -> Result<(), RunError> {
        let Some(mut provenance) = provenance::read(self.store.dir())? else {
            return Ok(());
        };
        let sessions = &mut provenance.sessions;
        sessions.retain(|session| session.shard.is_none());
        for stem in self.store.stems(SHARDS_FOLDER) {
            let Some(shard) = Shard::by_stem(&stem) else {
                continue;
            };
            if let Some(of_shard) = provenance::read_file(&self.store.shard_path(shard))? {
                sessions.extend(of_shard.sessions);
            }
        }
        sessions.sort_by(|a, b| a.date_utc.cmp(&b.date_utc));
        Ok(self
            .store
            .write_provenance(&self.store.provenance_path(), &provenance)?)
    }

    /// Completes this invocation's entry in the provenance.
    pub(super) fn end_session(&self, started: Instant) -> Result<(), RunError> {
        let path = self.store.sessions_path();
        let Some(mut provenance) = provenance::read_file(&path)? else {
            return Ok(());
        };
        if let Some(session) = provenance.sessions.last_mut() {
            session.wall_s = Some(started.elapsed().as_secs_f64());
        }
        Ok(self.store.write_provenance(&path, &provenance)?)
    }
}
