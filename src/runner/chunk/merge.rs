//! Makes one run of the attempts at all chunks: the folder that `run` would have left on one machine.
//!
//! Every record carries a checksum and the hashes of its images. All are checked before anything is written. Scores and images depend on cell
//! and device alone, so records of one cell from one device must agree to the last bit. Where they do not, a machine is at fault, and nothing
//! is merged. Times do not repeat: of several timings of a block the first is kept whole, and no table compares times of two devices.
//!
//! Long because finding, checking, choosing and writing are steps of one operation, which has no use apart.

use super::ChunkError;
use super::file::PlanFile;
use super::store::{Attempt, ChunkStore};
use crate::files::content_hash;
use crate::runner::frozen::EXPERIMENT_FILE;
use crate::runner::images;
use crate::runner::live::LIVE_FILE;
use crate::runner::plan::{Cell, Plan};
use crate::runner::provenance;
use crate::runner::run::{Outcome, RunOptions, tabulate};
use crate::runner::store::{
    CELLS_FOLDER, CellRecord, FAILED_FOLDER, FailureRecord, ReferenceStop, Spent, Store, StoreError,
};
use crate::runner::timing::{self, TimingRecord};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::{Path, PathBuf};

/// The outcome of a merge.
#[derive(Debug)]
pub struct Merged {
    pub outcome: Outcome,
    /// Chunks of which something is missing; empty when the run is whole.
    pub holes: Vec<Hole>,
    /// Notes for a reader of the tables, one sentence each.
    pub notes: Vec<String>,
}

/// The missing part of one chunk.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hole {
    pub chunk: usize,
    /// Id and label of each cell that was not tried.
    pub cells: Vec<(String, String)>,
    pub block_count: usize,
    /// How the last attempt ended.
    pub last: String,
}

/// Device and driver: what the scores of a cell may depend on.
type Device = (String, String);

/// The timings of a block, each with its id.
type Block = Vec<(String, TimingRecord)>;

/// The record that was chosen for each cell or block.
type Chosen<'f, T> = BTreeMap<&'f str, &'f Found<T>>;

/// A record and where it stands.
struct Found<T> {
    record: T,
    store: Store,
    device: Device,
}

/// Merges what there is. All of it is read and checked before the first byte is written: nothing is when a record or an image is damaged
/// or missing, or when records contradict each other.
///
/// `store` is the folder that the chunks share; that of the options, where the run is made, may be the same.
pub fn merge(file: &PlanFile, plan: &Plan, store: &Path, options: &RunOptions) -> Result<Merged, ChunkError> {
    let chunks = ChunkStore::existing(store, file)?;
    let attempts: Vec<Vec<Attempt>> =
        file.chunks.iter().map(|chunk| chunks.attempts(chunk.index)).collect::<Result<_, _>>()?;
    if attempts.iter().all(Vec::is_empty) {
        return Err(ChunkError::NoStore { dir: store.to_owned() });
    }
    let out = Store::at(&options.dir);
    out.check_identity(plan)?;
    let mut merge = Merge { file, plan, out, attempts, damage: Vec::new(), notes: Vec::new() };
    let cells = merge.find_cells()?;
    let blocks = merge.find_blocks()?;
    let chosen = choose(&cells, "cells", &mut merge.notes);
    let chosen_blocks = choose(&blocks, "blocks of timings", &mut merge.notes);
    let belongings = merge.belongings(&chosen)?;
    if !merge.damage.is_empty() {
        return Err(ChunkError::Damaged(merge.damage));
    }
    let disagreements = disagreements(plan, &cells);
    if !disagreements.is_empty() {
        return Err(ChunkError::Disagreement(disagreements));
    }

    merge.out = Store::open(&options.dir, plan)?;
    merge.import_cells(&chosen, &belongings)?;
    merge.import_failures(&chosen)?;
    for (id, record) in chosen_blocks.values().flat_map(|block| &block.record) {
        merge.out.write_timing(id, record)?;
    }
    merge.write_provenance(options)?;
    let holes = merge.holes()?;
    Ok(Merged { outcome: tabulate(plan, merge.out, options)?, holes, notes: merge.notes })
}

/// A merge at work.
struct Merge<'a> {
    file: &'a PlanFile,
    plan: &'a Plan,
    /// The folder of the run to make.
    out: Store,
    /// At each chunk.
    attempts: Vec<Vec<Attempt>>,
    /// A sentence for each record and image that cannot be used.
    damage: Vec<String>,
    notes: Vec<String>,
}

impl Merge<'_> {
    /// Every record of every cell of the plan, that of the run's folder first, then in the order of the attempts.
    fn find_cells(&mut self) -> Result<BTreeMap<String, Vec<Found<CellRecord>>>, StoreError> {
        let mut found: BTreeMap<String, Vec<Found<CellRecord>>> = BTreeMap::new();
        let mut add = |id: &str, store: &Store| -> Result<(), StoreError> {
            if let Some(record) = whole(store.whole_cell(id), &mut self.damage)? {
                let device = (record.device.clone(), record.driver.clone());
                found.entry(id.to_owned()).or_default().push(Found { record, store: store.clone(), device });
            }
            Ok(())
        };
        for cell in &self.plan.cells {
            add(&cell.id, &self.out)?;
        }
        let of_plan: HashSet<&str> = self.plan.cells.iter().map(|cell| cell.id.as_str()).collect();
        let mut strangers = Vec::new();
        for attempt in self.attempts.iter().flatten() {
            for id in attempt.store.ids(CELLS_FOLDER) {
                match of_plan.contains(id.as_str()) {
                    true => add(&id, &attempt.store)?,
                    false => strangers.push(attempt.store.cell_path(&id)),
                }
            }
        }
        self.notes.extend(strangers.first().map(|first| {
            format!(
                "records of cells that the plan does not have, left out: {}, the first {}",
                strangers.len(),
                first.display()
            )
        }));
        Ok(found)
    }

    /// The timings of every block, by the id of its first configuration, once for each attempt that finished it.
    fn find_blocks(&mut self) -> Result<BTreeMap<String, Vec<Found<Block>>>, StoreError> {
        let jobs = timing::jobs(self.plan);
        let mut found: BTreeMap<String, Vec<Found<Block>>> = BTreeMap::new();
        for (chunk, attempts) in self.file.chunks.iter().zip(&self.attempts) {
            for attempt in attempts {
                for block in chunk.blocks(&jobs) {
                    let mut record = Block::new();
                    for id in &block {
                        record.extend(
                            whole(attempt.store.whole_timing(id), &mut self.damage)?.map(|timing| (id.clone(), timing)),
                        );
                    }
                    if record.len() < block.len() {
                        continue;
                    }
                    let device = (record[0].1.device.clone(), record[0].1.driver.clone());
                    let block = Found { record, store: attempt.store.clone(), device };
                    found.entry(block.record[0].0.clone()).or_default().push(block);
                }
            }
        }
        Ok(found)
    }

    /// Finds a whole copy of every file that a chosen record stands for; each that has none is a sentence for `damage`.
    fn belongings(&mut self, chosen: &Chosen<CellRecord>) -> Result<Belongings, StoreError> {
        let (plan, out) = (self.plan, &self.out);
        let others: Vec<&Store> = self.attempts.iter().flatten().map(|attempt| &attempt.store).chain([out]).collect();
        let mut stops = BTreeMap::new();
        // Cells of two devices may share a file's name, and each must find the bytes that its record was made from.
        let mut wanted: BTreeMap<(String, Option<&String>), (&Cell, &Store)> = BTreeMap::new();
        for cell in &plan.cells {
            let Some(found) = chosen.get(cell.id.as_str()) else { continue };
            for name in images::files(plan, cell) {
                let hash = found.record.files.get(&name);
                wanted.entry((name, hash)).or_insert((cell, &found.store));
            }
            if found.record.reference.is_some() && !stops.contains_key(&cell.reference) {
                for store in std::iter::once(&found.store).chain(others.iter().copied()) {
                    if let Some(stop) = whole(store.whole_reference(&cell.reference), &mut self.damage)? {
                        stops.insert(cell.reference.clone(), stop);
                        break;
                    }
                }
            }
        }
        let find = |((name, hash), (cell, own)): (&(String, Option<&String>), &(&Cell, &Store))| {
            // What cells share may stand with another attempt.
            let mut copies = std::iter::once(*own).chain(others.iter().copied()).map(|store| store.image_path(name));
            let is_whole = |path: &PathBuf| match hash {
                Some(hash) => content_hash(path).is_ok_and(|found| found == **hash),
                None => images::is_whole(path),
            };
            copies.find(is_whole).ok_or_else(|| {
                let path = own.image_path(name);
                let what = if path.exists() { "is not the file that its record was made from" } else { "is missing" };
                let (label, record) = (plan.label(cell), own.cell_path(&cell.id));
                format!(
                    "{}: {what}; it belongs to {} {label}; to make it anew remove {}",
                    path.display(),
                    cell.id,
                    record.display()
                )
            })
        };
        let list: Vec<_> = wanted.iter().collect();
        let copies: Vec<Result<PathBuf, String>> = list.par_iter().map(|&entry| find(entry)).collect();
        let mut files = BTreeMap::new();
        for (((name, hash), _), copy) in list.into_iter().zip(copies) {
            match copy {
                Ok(path) => drop(files.entry(name.clone()).or_insert((path, hash.cloned()))),
                Err(sentence) => self.damage.push(sentence),
            }
        }
        Ok(Belongings { files, stops })
    }

    /// Brings the chosen records, with the files that belong to them, into the run's folder: the records last.
    fn import_cells(&self, chosen: &Chosen<CellRecord>, belongings: &Belongings) -> Result<(), StoreError> {
        let out = &self.out;
        for (name, (from, hash)) in &belongings.files {
            out.place(from, &out.image_path(name), hash.as_deref())?;
        }
        for (id, stop) in &belongings.stops {
            out.write_reference(id, stop)?;
        }
        for cell in &self.plan.cells {
            if let Some(found) = chosen.get(cell.id.as_str()).filter(|found| found.store.dir() != out.dir()) {
                out.write_cell(&found.record)?;
            }
        }
        let live = out.dir().join(LIVE_FILE);
        let made = self
            .attempts
            .iter()
            .flatten()
            .find_map(|attempt| Some(attempt.store.dir().join(LIVE_FILE)).filter(|path| path.exists()));
        made.filter(|_| !live.exists()).map_or(Ok(()), |from| out.place(&from, &live, None))
    }

    /// Keeps the last reason of every cell that failed and was not done by another attempt.
    fn import_failures(&self, chosen: &Chosen<CellRecord>) -> Result<(), StoreError> {
        let mut failures: BTreeMap<String, FailureRecord> = BTreeMap::new();
        for attempt in self.attempts.iter().flatten() {
            for id in attempt.store.ids(FAILED_FOLDER) {
                if let Some(failure) = attempt.store.failure(&id)? {
                    failures.insert(id, failure);
                }
            }
        }
        let open = self.plan.cells.iter().filter(|cell| !chosen.contains_key(cell.id.as_str()));
        open.filter_map(|cell| failures.get(&cell.id)).try_for_each(|failure| self.out.write_failure(failure))
    }

    /// The sessions of all attempts, each with its chunk, after those of an ordinary run in the same folder.
    fn write_provenance(&self, options: &RunOptions) -> Result<(), StoreError> {
        let (plan, out) = (self.plan, &self.out);
        let path = out.provenance_path();
        let mut value = provenance::read(out.dir())?.unwrap_or_else(|| provenance::provenance(plan, out.dir()));
        let kept = value["sessions"].as_array().cloned().unwrap_or_default();
        let mut sessions: Vec<Value> = kept.into_iter().filter(|session| session["chunk"].is_null()).collect();
        for attempt in self.attempts.iter().flatten() {
            let own = provenance::read(attempt.store.dir())?;
            for mut session in own.and_then(|value| value["sessions"].as_array().cloned()).unwrap_or_default() {
                session["chunk"] = attempt.record.chunk.into();
                session["attempt"] = attempt.name.as_str().into();
                session["host"]["name"] = attempt.record.host.as_str().into();
                sessions.push(session);
            }
        }
        value["sessions"] = sessions.into();
        value["merge_command_line"] = options.command_line.clone().into();
        out.write_json(&path, &value)?;
        out.write_text(&out.dir().join(EXPERIMENT_FILE), &plan.config.text)
    }

    /// The missing parts of the run, by chunk.
    fn holes(&self) -> Result<Vec<Hole>, StoreError> {
        let (plan, out) = (self.plan, &self.out);
        let by_id: BTreeMap<&str, &Cell> = plan.cells.iter().map(|cell| (cell.id.as_str(), cell)).collect();
        let jobs = timing::jobs(plan);
        let mut holes = Vec::new();
        for (chunk, attempts) in self.file.chunks.iter().zip(&self.attempts) {
            let mut cells = Vec::new();
            for id in &chunk.cells {
                if out.cell(id)?.is_none() && out.failure(id)?.is_none() {
                    cells.push((id.clone(), plan.label(by_id[id.as_str()])));
                }
            }
            let is_open = |block: &&Vec<String>| !block.iter().all(|id| out.has_timing(id));
            let block_count = chunk.blocks(&jobs).iter().filter(is_open).count();
            if !cells.is_empty() || block_count > 0 {
                holes.push(Hole { chunk: chunk.index, cells, block_count, last: last_words(attempts.last()) });
            }
        }
        Ok(holes)
    }
}

/// The value that was read, where it is whole; else a sentence for `damage`.
fn whole<T>(read: Result<Option<T>, StoreError>, damage: &mut Vec<String>) -> Result<Option<T>, StoreError> {
    match read {
        Err(error) if error.is_unusable_record() => {
            damage.push(error.to_string());
            Ok(None)
        }
        read => read,
    }
}

/// One record each: of the device that has most of them, so that as few devices as possible meet in a table, else the first.
fn choose<'f, T>(found: &'f BTreeMap<String, Vec<Found<T>>>, what: &str, notes: &mut Vec<String>) -> Chosen<'f, T> {
    let mut counts: BTreeMap<&Device, usize> = BTreeMap::new();
    for records in found.values() {
        for device in records.iter().map(|record| &record.device).collect::<BTreeSet<_>>() {
            *counts.entry(device).or_default() += 1;
        }
    }
    // Of devices with equally many the first by name.
    let main = counts.iter().rev().max_by_key(|(_, count)| **count).map(|(device, _)| *device);
    let mut chosen = BTreeMap::new();
    let mut devices: BTreeMap<&Device, usize> = BTreeMap::new();
    for (id, records) in found {
        let of_main = records.iter().find(|record| Some(&record.device) == main);
        if let Some(record) = of_main.or(records.first()) {
            *devices.entry(&record.device).or_default() += 1;
            chosen.insert(id.as_str(), record);
        }
    }
    if devices.len() > 1 {
        let list: Vec<String> =
            devices.iter().map(|((name, driver), count)| format!("{count} from {name} ({driver})")).collect();
        notes.push(format!("the {what} come from {} devices: {}", devices.len(), list.join(", ")));
    }
    chosen
}

/// A sentence for each record that contradicts the first one of its cell and device.
fn disagreements(plan: &Plan, found: &BTreeMap<String, Vec<Found<CellRecord>>>) -> Vec<String> {
    let mut sentences = Vec::new();
    for cell in &plan.cells {
        let records = found.get(&cell.id).map_or(&[][..], Vec::as_slice);
        let mut first_of: BTreeMap<&Device, &Found<CellRecord>> = BTreeMap::new();
        for record in records {
            let first = *first_of.entry(&record.device).or_insert(record);
            let facts = differing(&first.record, &record.record);
            if !facts.is_empty() {
                sentences.push(format!(
                    "{} {}: {} and {} differ in {}",
                    cell.id,
                    plan.label(cell),
                    first.store.cell_path(&cell.id).display(),
                    record.store.cell_path(&cell.id).display(),
                    facts.join(", ")
                ));
            }
        }
    }
    sentences
}

/// The facts in which two records differ, with both values. The time that a cell took is none.
fn differing(a: &CellRecord, b: &CellRecord) -> Vec<String> {
    let [a, b] = [a, b].map(|record| {
        let mut facts = BTreeMap::new();
        flatten("", &json!(CellRecord { spent: Spent::default(), ..record.clone() }), &mut facts);
        facts
    });
    let value = |facts: &BTreeMap<String, String>, name| facts.get(name).map_or("none", String::as_str).to_owned();
    let names = a.keys().chain(b.keys()).collect::<BTreeSet<_>>();
    let differ = names.into_iter().filter(|name| a.get(*name) != b.get(*name));
    differ.map(|name| format!("{name} ({} and {})", value(&a, name), value(&b, name))).collect()
}

/// Every number and text of a value by its place: `scores.mae`.
fn flatten(place: &str, value: &Value, facts: &mut BTreeMap<String, String>) {
    let below = |key: &str| if place.is_empty() { key.to_owned() } else { format!("{place}.{key}") };
    match value {
        Value::Object(fields) => fields.iter().for_each(|(key, value)| flatten(&below(key), value, facts)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, value)| flatten(&below(&i.to_string()), value, facts));
        }
        Value::String(text) => drop(facts.insert(place.to_owned(), text.clone())),
        other => drop(facts.insert(place.to_owned(), other.to_string())),
    }
}

/// Files and references of the chosen records.
struct Belongings {
    /// Where a whole copy of each file of `images/` stands, with its content hash where a record tells it.
    files: BTreeMap<String, (PathBuf, Option<String>)>,
    /// Where each reference stopped.
    stops: BTreeMap<String, ReferenceStop>,
}

/// How the last attempt at a chunk ended.
fn last_words(attempt: Option<&Attempt>) -> String {
    let Some(attempt) = attempt else { return "never begun".to_owned() };
    let (host, began) = (&attempt.record.host, &attempt.record.began_utc);
    let Some(end) = &attempt.record.ended else {
        return format!("begun on {host} at {began}, with no end: killed, or still at work");
    };
    match (&end.fault, end.failed.first()) {
        (Some(fault), _) => format!("ended on {host} at {}: {fault}", end.date_utc),
        (None, Some((label, reason))) => format!("ended on {host} at {}: {label}: {reason}", end.date_utc),
        (None, None) => format!("ended on {host} at {}", end.date_utc),
    }
}
