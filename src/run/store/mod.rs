//! The folder of a run. A record is written last and in one step: no record means not done.

mod done;
mod fault;
mod identity;
mod lock;

pub use super::record::{
    BinRecord, CellRecord, Exact, FailureRecord, Judgement, ReferenceRecord, ReferenceStop, Scores,
    SteadinessScores, StepRecord, StopReason,
};
pub use fault::StoreError;

use super::provenance::{PROVENANCE_FILE, Provenance};
use super::run_table::RunTable;
use super::seal;
use super::shard::Shard;
use crate::base::csv;
use crate::base::files::{PLAN_BYTES_MAX, RECORD_BYTES_MAX, holds, names_in, read_regular};
use crate::base::pixels::{PART_PREFIX, write_atomically};
use crate::experiment::id::Id;
use crate::experiment::plan::Plan;
use lock::Lock;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The folder of one run.
#[derive(Clone, Debug)]
pub struct Store {
    dir: PathBuf,
    /// The part of the plan that this process does, if several share the folder.
    shard: Option<Shard>,
    /// Held while a run works in the folder.
    _locks: Arc<Vec<Lock>>,
}

/// Sessions and locks of the processes that share the folder.
pub const SHARDS_FOLDER: &str = "shards";

pub const ANSWERS_FOLDER: &str = "answers";

/// Raw samples of timed configurations.
pub const TIMINGS_FOLDER: &str = "timings";
/// Records of finished cells.
pub const CELLS_FOLDER: &str = "cells";
/// Reasons of cells that failed.
pub const FAILED_FOLDER: &str = "failed";
pub const REFERENCES_FOLDER: &str = "references";

const SUBFOLDERS: &[&str] = &[
    CELLS_FOLDER,
    FAILED_FOLDER,
    "images",
    REFERENCES_FOLDER,
    "tables",
    TIMINGS_FOLDER,
];

impl Store {
    /// Opens a folder for reading.
    pub fn read_only(dir: &Path) -> Self {
        Self {
            dir: dir.to_owned(),
            shard: None,
            _locks: Arc::default(),
        }
    }

    /// Creates the folder or checks that the plan may run in it, and locks it.
    pub fn open(dir: &Path, plan: &Plan) -> Result<Self, StoreError> {
        let store = Self::read_only(dir).begin(plan)?;
        for folder in ["", ANSWERS_FOLDER].iter().chain(SUBFOLDERS) {
            remove_parts(&dir.join(folder))?;
        }
        Ok(store)
    }

    /// As [`Store::open`], for one of several processes that share the folder.
    pub fn open_shard(dir: &Path, plan: &Plan, shard: Shard) -> Result<Self, StoreError> {
        Self {
            shard: Some(shard),
            ..Self::read_only(dir)
        }
        .begin(plan)
    }

    fn begin(mut self, plan: &Plan) -> Result<Self, StoreError> {
        self.check_identity(plan)?;
        let shards = self.shard.map(|_| &SHARDS_FOLDER);
        SUBFOLDERS.iter().chain(shards).try_for_each(|folder| {
            let path = self.dir.join(folder);
            std::fs::create_dir_all(&path).map_err(|error| StoreError::Folder { path, error })
        })?;
        self._locks = Arc::new(self.locks()?);
        // Another run may have taken the folder between check and lock.
        self.check_identity(plan)?;
        Ok(self)
    }

    pub fn dir(&self) -> &Path {
        &self.dir
    }

    pub(super) fn provenance_path(&self) -> PathBuf {
        self.dir.join(PROVENANCE_FILE)
    }

    /// The file with the sessions of this process: `provenance.json`, or its shard's file.
    pub(super) fn sessions_path(&self) -> PathBuf {
        self.shard
            .map_or_else(|| self.provenance_path(), |shard| self.shard_path(shard))
    }

    pub(super) fn shard_path(&self, shard: Shard) -> PathBuf {
        self.dir.join(SHARDS_FOLDER).join(shard.stem() + ".json")
    }

    pub fn image_path(&self, name: &str) -> PathBuf {
        self.dir.join("images").join(name)
    }

    pub fn table_path(&self, name: &str) -> PathBuf {
        self.dir.join("tables").join(name)
    }

    /// Removes a file of a folder of the run, if it exists.
    pub(super) fn remove(&self, folder: &str, name: &str) -> Result<(), StoreError> {
        remove(self.dir.join(folder).join(name))
    }

    pub fn cell_path(&self, id: Id) -> PathBuf {
        self.record_path(CELLS_FOLDER, id)
    }

    /// The record of a finished cell. As for all records, an unusable one counts as missing: its
    /// work is repeated.
    pub fn cell(&self, id: Id) -> Result<Option<CellRecord>, StoreError> {
        usable(self.record(CELLS_FOLDER, id))
    }

    /// Keeps a finished cell and forgets its earlier failure.
    pub fn write_cell(&self, record: &CellRecord) -> Result<(), StoreError> {
        // Not synced to the disk, which takes longer than a small cell: the checksum detects what a
        // power cut truncates.
        self.write_sealed(&self.cell_path(record.cell), record)?;
        self.remove_record(FAILED_FOLDER, record.cell)
    }

    /// Why a cell failed the last time it was tried.
    pub fn failure(&self, id: Id) -> Result<Option<FailureRecord>, StoreError> {
        usable(self.record(FAILED_FOLDER, id))
    }

    pub fn write_failure(&self, record: &FailureRecord) -> Result<(), StoreError> {
        self.write_sealed(&self.record_path(FAILED_FOLDER, record.cell), record)
    }

    pub fn reference(&self, id: Id) -> Result<Option<ReferenceRecord>, StoreError> {
        usable(self.record(REFERENCES_FOLDER, id))
    }

    pub fn write_reference(&self, id: Id, record: &ReferenceRecord) -> Result<(), StoreError> {
        self.write_named(REFERENCES_FOLDER, id, record)
    }

    pub fn timing<T: DeserializeOwned>(&self, id: Id) -> Result<Option<T>, StoreError> {
        usable(self.record(TIMINGS_FOLDER, id))
    }

    /// Whether a configuration has a usable timing record.
    pub fn has_timing(&self, id: Id) -> bool {
        matches!(self.timing::<serde_json::Value>(id), Ok(Some(_)))
    }

    pub fn write_timing<T: Serialize>(&self, id: Id, record: &T) -> Result<(), StoreError> {
        self.write_named(TIMINGS_FOLDER, id, record)
    }

    /// Removes a record, if it exists.
    pub(super) fn remove_record(&self, folder: &str, id: Id) -> Result<(), StoreError> {
        remove(self.record_path(folder, id))
    }

    /// Replaces a table of the run in one step. Rows are made one at a time to save memory.
    pub fn write_table(
        &self,
        name: &str,
        table: RunTable<impl IntoIterator<Item = Result<Vec<csv::Cell>, StoreError>>>,
    ) -> Result<(), StoreError> {
        let path = self.dir.join(name);
        let part = self.dir.join(format!("{name}.part"));
        csv::write(&part, &table.columns, table.rows)?;
        std::fs::rename(&part, &path).map_err(|error| StoreError::Io { path, error })
    }

    /// Writes a file of the run in one step, unless it has this content already.
    pub fn write_text(&self, path: &Path, text: &str) -> Result<(), StoreError> {
        if holds(path, text.as_bytes()) {
            return Ok(());
        }
        Ok(write_atomically(path, |writer| {
            writer.write_all(text.as_bytes())
        })?)
    }

    /// Writes indented JSON.
    pub fn write_json<T: Serialize>(&self, path: &Path, value: &T) -> Result<(), StoreError> {
        self.write_text(path, &pretty(path, value)?)
    }

    /// Writes a provenance file.
    pub(super) fn write_provenance(
        &self,
        path: &Path,
        provenance: &Provenance,
    ) -> Result<(), StoreError> {
        self.write_json(path, &provenance.to_json())
    }

    /// Writes indented JSON with a checksum.
    fn write_sealed<T: Serialize>(&self, path: &Path, record: &T) -> Result<(), StoreError> {
        self.write_text(path, &seal::sealed(&pretty(path, record)?))
    }

    /// Writes a record with its own name in it and syncs it to the disk: it is expensive, or
    /// impossible, to reproduce.
    fn write_named<T: Serialize>(
        &self,
        folder: &str,
        id: Id,
        record: &T,
    ) -> Result<(), StoreError> {
        let path = self.record_path(folder, id);
        self.write_sealed(
            &path,
            &Named {
                record: id,
                content: record,
            },
        )?;
        let sync = File::open(&path).and_then(|file| file.sync_all());
        sync.map_err(|error| StoreError::Io { path, error })
    }

    fn record_path(&self, folder: &str, id: Id) -> PathBuf {
        self.dir.join(folder).join(format!("{id}.json"))
    }

    /// Parses a file; `None` if it does not exist.
    pub fn read<T: DeserializeOwned>(&self, path: &Path) -> Result<Option<T>, StoreError> {
        read_bytes(path, PLAN_BYTES_MAX)?
            .map(|bytes| parsed(path, &bytes))
            .transpose()
    }

    /// Reads a record. A wrong checksum or name is an error; older records have neither.
    pub fn record<T: DeserializeOwned>(
        &self,
        folder: &str,
        id: Id,
    ) -> Result<Option<T>, StoreError> {
        let path = self.record_path(folder, id);
        let Some(bytes) = read_bytes(&path, RECORD_BYTES_MAX)? else {
            return Ok(None);
        };
        let record = parsed(&path, &bytes)?;
        let name: Name = parsed(&path, &bytes)?;
        if seal::is_broken(&String::from_utf8_lossy(&bytes)) {
            return Err(StoreError::Damaged { path });
        }
        // A timing names an example cell.
        match name
            .record
            .or(name.cell.filter(|_| folder != TIMINGS_FOLDER))
            .filter(|found| *found != id.to_string())
        {
            Some(found) => Err(StoreError::Stranger { path, found }),
            None => Ok(Some(record)),
        }
    }
}

#[derive(Serialize)]
struct Named<'r, T> {
    record: Id,
    #[serde(flatten)]
    content: &'r T,
}

#[derive(Deserialize)]
struct Name {
    record: Option<String>,
    cell: Option<String>,
}

/// Turns an unusable record into a missing one.
fn usable<T>(read: Result<Option<T>, StoreError>) -> Result<Option<T>, StoreError> {
    match read {
        Err(error) if error.is_unusable_record() => Ok(None),
        read => read,
    }
}

/// Reads a file; `None` if it does not exist.
fn read_bytes(path: &Path, most_bytes: u64) -> Result<Option<Vec<u8>>, StoreError> {
    match read_regular(path, most_bytes) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(StoreError::Io {
            path: path.to_owned(),
            error,
        }),
    }
}

fn parsed<T: DeserializeOwned>(path: &Path, bytes: &[u8]) -> Result<T, StoreError> {
    serde_json::from_slice(bytes).map_err(|error| StoreError::Corrupt {
        path: path.to_owned(),
        error,
    })
}

/// Indented, with a final newline.
fn pretty<T: Serialize>(path: &Path, value: &T) -> Result<String, StoreError> {
    let text = serde_json::to_string_pretty(value);
    text.map(|text| text + "\n")
        .map_err(|error| StoreError::Corrupt {
            path: path.to_owned(),
            error,
        })
}

fn remove(path: PathBuf) -> Result<(), StoreError> {
    match std::fs::remove_file(&path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(StoreError::Io { path, error })
        }
        _ => Ok(()),
    }
}

/// Whether a file is a half-written one of a killed run.
fn is_part(name: &str) -> bool {
    (name.starts_with(PART_PREFIX) || name.ends_with(".csv.part")) && name.ends_with(".part")
}

fn remove_parts(folder: &Path) -> Result<(), StoreError> {
    names_in(folder)
        .iter()
        .filter(|name| is_part(name))
        .try_for_each(|name| remove(folder.join(name)))
}
