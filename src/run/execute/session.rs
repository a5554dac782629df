//! The origin of a run: the frozen experiment, and an entry in the provenance for each invocation that did work.

use super::{Progress, Run, RunError, Work, milliseconds};
use crate::pipeline::DeviceInfo;
use crate::run::frozen::EXPERIMENT_FILE;
use crate::run::provenance;
use crate::run::renderer::Renderer;
use serde_json::json;
use std::time::Instant;

impl Run<'_> {
    /// Writes the frozen experiment of a run that was begun, where it is missing or not the text of the plan.
    pub(super) fn freeze_again(&self, progress: &mut dyn Progress) -> Result<(), RunError> {
        let Some(value) = provenance::read(self.store.dir())? else { return Ok(()) };
        let (path, text) = (self.store.dir().join(EXPERIMENT_FILE), &self.plan.config.text);
        if !std::fs::read(&path).is_ok_and(|found| found == text.as_bytes()) {
            progress.note(&format!("{EXPERIMENT_FILE} was not the experiment of this run; it is written anew"));
            self.store.write_text(&path, text)?;
        }
        // A comment may have changed, or the question, or the place of the files: what makes no other cells.
        match provenance::of_now(value, self.plan, self.store.dir()) {
            Some(value) => Ok(self.store.write_json(&self.store.provenance_path(), &value)?),
            None => Ok(()),
        }
    }

    /// Writes the frozen experiment and adds this invocation to the provenance.
    pub(super) fn begin_session(&self, device: &DeviceInfo) -> Result<(), RunError> {
        let path = self.store.provenance_path();
        let mut value =
            provenance::read(self.store.dir())?.unwrap_or_else(|| provenance::provenance(self.plan, self.store.dir()));
        if let Some(sessions) = value["sessions"].as_array_mut() {
            sessions.push(provenance::session(device, &self.options.command_line));
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
