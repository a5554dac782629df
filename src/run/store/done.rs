//! `done.json`: the state of the folder at the end of a run, so that repeating the command exits
//! immediately.
//!
//! Files are compared by size and modification time. If any differs, as in a copy of the folder,
//! the run checks every record and image.

use super::lock::LOCK_FILE;
use super::{ANSWERS_FOLDER, SUBFOLDERS, Store, StoreError};
use crate::base::files::names_in;
use crate::experiment::plan::Plan;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::UNIX_EPOCH;

const DONE_FILE: &str = "done.json";

#[derive(Deserialize, Serialize)]
struct Done {
    /// Hash over the program, the plan and every file: name, size and modification time.
    state: String,
    /// The summary that the run printed.
    printed: String,
}

impl Store {
    /// Marks the run as finished; `printed` is the summary that it printed.
    pub fn mark_done(&self, plan: &Plan, printed: &str) -> Result<(), StoreError> {
        let done = Done {
            state: self.state(plan),
            printed: printed.to_owned(),
        };
        self.write_json(&self.dir().join(DONE_FILE), &done)
    }

    /// The summary of a finished run of this plan, if nothing has changed since.
    pub fn printed_when_done(&self, plan: &Plan) -> Option<String> {
        let done: Done = self.read(&self.dir().join(DONE_FILE)).ok()??;
        (!self.is_under_way() && done.state == self.state(plan)).then_some(done.printed)
    }

    fn state(&self, plan: &Plan) -> String {
        let config = &plan.config;
        let mut hasher = blake3::Hasher::new();
        // The plan's hash covers the contents of its inputs; provenance and answers use the rest.
        let file = (
            &config.path,
            &config.text,
            &config.overrides,
            &config.file_dir,
            &config.set_dir,
        );
        // Provenance and printed summary name the folder.
        let dir = std::path::absolute(self.dir()).unwrap_or_default();
        let facts = (&plan.hash, file, plan.inputs.warnings(), dir);
        hasher.update(format!("{facts:?}").as_bytes());
        let mut add = |path: &Path| {
            let metadata = std::fs::metadata(path).ok();
            let changed = metadata
                .as_ref()
                .and_then(|known| known.modified().ok()?.duration_since(UNIX_EPOCH).ok());
            let facts = (
                path.file_name(),
                metadata.map(|known| (known.is_dir(), known.len())),
                changed,
            );
            hasher.update(format!("{facts:?}\n").as_bytes());
        };
        add(&std::env::current_exe().unwrap_or_default());
        for folder in SUBFOLDERS.iter().chain(&[ANSWERS_FOLDER, ""]) {
            let dir = self.dir().join(folder);
            let names = names_in(&dir)
                .into_iter()
                .filter(|name| !folder.is_empty() || is_of_run(name, &dir));
            names.for_each(|name| add(&dir.join(name)));
        }
        hasher.finalize().to_hex().to_string()
    }
}

/// Files of the folder itself, without subfolders.
fn is_of_run(name: &str, dir: &Path) -> bool {
    ![LOCK_FILE, DONE_FILE].contains(&name) && !dir.join(name).is_dir()
}
