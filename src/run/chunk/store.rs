//! The folder that the chunks of one plan share: `chunks/NUMBER/ATTEMPT/`, one attempt for each process that worked on a chunk.
//!
//! An attempt is written by its process only and looks like a run: records, images, provenance. So any number of processes on any number
//! of machines may work on one chunk at once; what one of them has finished, a later one need not do again.

use super::ChunkError;
use super::file::PlanFile;
use crate::experiment::plan::Plan;
use crate::files::{PLAN_BYTES_MAX, names_in, read_text};
use crate::run::provenance::{host_name, now_utc};
use crate::run::store::{CHUNKS_FOLDER, PLAN_FILE, Store, StoreError};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// `attempt.json`: who works, or worked, here.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct AttemptRecord {
    /// [`PlanFile::id`].
    pub plan: String,
    pub chunk: usize,
    pub host: String,
    pub process: u32,
    pub began_utc: String,
    /// `None` while the process works, and for ever when it was killed.
    pub ended: Option<End>,
}

/// How an attempt ended.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct End {
    pub date_utc: String,
    /// Why it ended before all was tried.
    pub fault: Option<String>,
    /// Label and reason of every cell and timing that failed.
    pub failed: Vec<(String, String)>,
}

/// The folder of one attempt.
#[derive(Debug)]
pub struct Attempt {
    /// Begins with the date, so that names in order are attempts in order.
    pub name: String,
    pub store: Store,
    pub record: AttemptRecord,
}

impl Attempt {
    /// Notes how the attempt ended.
    pub fn end(&mut self, fault: Option<String>, failed: Vec<(String, String)>) -> Result<(), StoreError> {
        self.record.ended = Some(End { date_utc: now_utc(), fault, failed });
        self.store.write_json(&self.store.dir().join(ATTEMPT_FILE), &self.record)
    }
}

const ATTEMPT_FILE: &str = "attempt.json";

/// All attempts at the chunks of a plan.
#[derive(Debug)]
pub struct ChunkStore {
    dir: PathBuf,
    plan: String,
}

impl ChunkStore {
    /// Makes the folder this plan's, or checks that it is.
    pub fn open(dir: &Path, file: &PlanFile, plan: &Plan) -> Result<Self, ChunkError> {
        let folder = Store::at(dir);
        folder.check_identity(plan)?;
        let chunks = dir.join(CHUNKS_FOLDER);
        std::fs::create_dir_all(&chunks).map_err(|error| StoreError::Folder { path: chunks, error })?;
        let path = dir.join(PLAN_FILE);
        if !path.exists() {
            file.write(&path)?;
        }
        // Read after it was written: of two plans that came at the same moment one finds the other's.
        Self::existing(dir, file)
    }

    /// The folder as it is.
    pub fn existing(dir: &Path, file: &PlanFile) -> Result<Self, ChunkError> {
        let path = dir.join(PLAN_FILE);
        match read_text(&path, PLAN_BYTES_MAX) {
            Ok(text) if text == file.text() => Ok(Self { dir: dir.to_owned(), plan: file.id() }),
            Ok(_) => Err(ChunkError::OtherPlan { dir: dir.to_owned() }),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                Err(ChunkError::NoStore { dir: dir.to_owned() })
            }
            Err(error) => Err(StoreError::Io { path, error }.into()),
        }
    }

    /// Makes the folder of a new attempt. Its name is new on every machine, since making a folder either succeeds or fails as a whole.
    pub fn begin(&self, chunk: usize) -> Result<Attempt, ChunkError> {
        let parent = self.chunk_dir(chunk);
        let made = |error| StoreError::Folder { path: parent.clone(), error };
        std::fs::create_dir_all(&parent).map_err(made)?;
        let (host, process, began_utc) = (host_name(), std::process::id(), now_utc());
        let is_plain = |c: &char| c.is_ascii_alphanumeric() || *c == '-';
        let prefix =
            format!("{}-{}-{process}-", began_utc.replace(':', ""), host.chars().filter(is_plain).collect::<String>());
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix);
        // Temporary folders are private to the user; this one is read by whoever merges, as any new folder may be.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
        let folder = builder.tempdir_in(&parent).map_err(made)?.keep();
        let name = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let store = Store::own(&folder)?;
        let record = AttemptRecord { plan: self.plan.clone(), chunk, host, process, began_utc, ended: None };
        store.write_json(&folder.join(ATTEMPT_FILE), &record)?;
        Ok(Attempt { name, store, record })
    }

    /// The attempts at a chunk, first begun first. One whose first file is not written yet has done nothing and is left out.
    pub fn attempts(&self, chunk: usize) -> Result<Vec<Attempt>, ChunkError> {
        let parent = self.chunk_dir(chunk);
        let mut attempts = Vec::new();
        for name in names_in(&parent).into_iter().filter(|name| parent.join(name).is_dir()) {
            let store = Store::at(&parent.join(&name));
            let Some(record) = store.read::<AttemptRecord>(&store.dir().join(ATTEMPT_FILE))? else { continue };
            if record.plan != self.plan {
                return Err(ChunkError::OtherPlan { dir: store.dir().to_owned() });
            }
            attempts.push(Attempt { name, store, record });
        }
        Ok(attempts)
    }

    /// Numbers of at least five digits, so that their order is that of the names up to a hundred thousand.
    fn chunk_dir(&self, chunk: usize) -> PathBuf {
        self.dir.join(CHUNKS_FOLDER).join(format!("{chunk:05}"))
    }
}
