//! The origin of a run: the frozen experiment, and an entry in the provenance for each invocation that did work.

use super::{Progress, Run, RunError, Work, milliseconds};
use crate::files::holds;
use crate::pipeline::DeviceInfo;
use crate::run::frozen::EXPERIMENT_FILE;
use crate::run::live::LIVE_FILE;
use crate::run::provenance;
use crate::run::renderer::Renderer;
use crate::run::store::FAILED_FOLDER;
use serde_json::json;
use std::collections::BTreeSet;
use std::time::Instant;

impl Run<'_> {
    /// Makes a run that was begun one of this plan and this text: a larger plan, a changed comment, a lost file. Returns whether it was one of
    /// another plan.
    pub(super) fn adopt(&self, progress: &mut dyn Progress) -> Result<bool, RunError> {
        let (plan, dir) = (self.plan, self.store.dir());
        let Some(found) = provenance::read(dir)? else { return Ok(false) };
        let is_other = found["plan_hash"] != plan.hash;
        if is_other {
            let (all, done) = (plan.cells.len(), self.results.len());
            progress.note(&format!("goes on from a run of another plan: {done} of {all} cells are done"));
            // It shows the environments and models of all cells.
            if done < all {
                self.store.remove_file(LIVE_FILE)?;
            }
            let planned: BTreeSet<&str> = plan.cells.iter().map(|cell| cell.id.as_str()).collect();
            let gone = self.store.ids(FAILED_FOLDER).into_iter().filter(|id| !planned.contains(id.as_str()));
            gone.into_iter().try_for_each(|id| self.store.remove_failure(&id))?;
        }
        if let Some(value) = provenance::of_now(&found, plan, dir) {
            self.store.write_json(&self.store.provenance_path(), &value)?;
        }
        let (path, text) = (dir.join(EXPERIMENT_FILE), &plan.config.text);
        if !holds(&path, text.as_bytes()) {
            if !is_other {
                progress.note(&format!("{EXPERIMENT_FILE} was not the experiment of this run; it is written again"));
            }
            self.store.write_text(&path, text)?;
        }
        Ok(is_other)
    }

    /// Writes the frozen experiment and adds this invocation to the provenance.
    pub(super) fn begin_session(&self, device: &DeviceInfo) -> Result<(), RunError> {
        let path = self.store.provenance_path();
        let mut value =
            provenance::read(self.store.dir())?.unwrap_or_else(|| provenance::provenance(self.plan, self.store.dir()));
        if let Some(sessions) = value["sessions"].as_array_mut() {
            let mut session = provenance::session(device, &self.options.command_line);
            session["plan_hash"] = json!(self.plan.hash);
            sessions.push(session);
        }
        self.store.write_json(&path, &value)?;
        self.store.write_text(&self.store.dir().join(EXPERIMENT_FILE), &self.plan.config.text)?;
        Ok(())
    }

    /// Completes this invocation's entry in the provenance.
    pub(super) fn end_session(&mut self, renderer: &dyn Renderer, started: Instant) -> Result<(), RunError> {
        let work = Work {
            waited_ms: renderer.waited_ms(),
            shared: renderer.shared_work(),
            references_read_back: self.references_read,
        };
        let path = self.store.provenance_path();
        let Some(mut value) = provenance::read(self.store.dir())? else { return Ok(()) };
        if let Some(session) = value["sessions"].as_array_mut().and_then(|sessions| sessions.last_mut()) {
            session["wall_s"] = json!(milliseconds(started) / 1e3);
            session["device_s"] = json!(work.waited_ms / 1e3);
            session["shared_work"] = json!(work.shared);
            session["references_read_back"] = json!(work.references_read_back);
        }
        self.work = Some(work);
        Ok(self.store.write_json(&path, &value)?)
    }
}
