//! Makes one run of the attempts at all chunks: the folder that `run` would have left on one machine.
//!
//! Every record carries a checksum and the hashes of its images. All are checked before anything is written. Scores and images depend on cell
//! and device alone, so records of one cell from one device must agree to the last bit. Where they do not, a machine is at fault, and nothing
//! is merged. Times do not repeat: of several timings of a block the first is kept whole, and no table compares times of two devices.
//!
//! Of a cell's record only hashes are held: a record takes some 20 KB of memory, and there may be 100,000.
//!
//! Long because finding, checking, choosing and writing are steps of one operation, which has no use apart.

use super::ChunkError;
use super::file::PlanFile;
use super::store::{Attempt, ChunkStore};
use crate::experiment::plan::{Cell, Plan};
use crate::files::content_hash;
use crate::run::execute::{Outcome, RunOptions, tabulate};
use crate::run::frozen::EXPERIMENT_FILE;
use crate::run::images;
use crate::run::live::LIVE_FILE;
use crate::run::provenance;
use crate::run::store::{
    CELLS_FOLDER, CellRecord, FAILED_FOLDER, FailureRecord, ReferenceStop, Spent, Store, StoreError,
};
use crate::run::timing::{self, TimingRecord};
use blake3::Hash;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

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
    store: Arc<Store>,
    device: Arc<Device>,
}

/// What is held of the record of a cell.
struct CellFacts {
    /// Hash of all that records of one device must agree in.
    hash: Hash,
    /// Content hashes of the cell's files, in the order of [`images::files`]; none where the record does not tell.
    files: Box<[Option<Hash>]>,
    has_reference: bool,
}

impl CellFacts {
    fn of(record: &CellRecord, plan: &Plan, cell: &Cell) -> serde_json::Result<Self> {
        let mut hasher = blake3::Hasher::new();
        serde_json::to_writer(&mut hasher, record)?;
        let files = images::hashes(plan, cell, &record.files);
        Ok(Self { hash: hasher.finalize(), files, has_reference: record.reference.is_some() })
    }
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
    let disagreements = disagreements(plan, &cells)?;
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
    let holes = merge.holes(&chosen)?;
    drop((cells, belongings));
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
    fn find_cells(&mut self) -> Result<BTreeMap<String, Vec<Found<CellFacts>>>, StoreError> {
        let plan = self.plan;
        let of_plan: HashMap<&str, &Cell> = plan.cells.iter().map(|cell| (cell.id.as_str(), cell)).collect();
        let mut found: BTreeMap<String, Vec<Found<CellFacts>>> = BTreeMap::new();
        let mut devices: HashSet<Arc<Device>> = HashSet::new();
        let mut add = |cell: &Cell, store: &Arc<Store>| -> Result<(), StoreError> {
            let Some(record) = whole(store.whole_cell(&cell.id), &mut self.damage)? else { return Ok(()) };
            // The time that a cell took is no fact of it.
            let record = CellRecord { spent: Spent::default(), ..record };
            let corrupt = |error| StoreError::Corrupt { path: store.cell_path(&cell.id), error };
            let facts = CellFacts::of(&record, plan, cell).map_err(corrupt)?;
            let device = Arc::new((record.device, record.driver));
            let device = devices.get(&device).cloned().unwrap_or(device);
            devices.insert(device.clone());
            found.entry(cell.id.clone()).or_default().push(Found { record: facts, store: store.clone(), device });
            Ok(())
        };
        let out = Arc::new(self.out.clone());
        for cell in &plan.cells {
            add(cell, &out)?;
        }
        let mut strangers = Vec::new();
        for attempt in self.attempts.iter().flatten() {
            let store = Arc::new(attempt.store.clone());
            for id in store.ids(CELLS_FOLDER) {
                match of_plan.get(id.as_str()) {
                    Some(cell) => add(cell, &store)?,
                    None => strangers.push(store.cell_path(&id)),
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
                    let device = Arc::new((record[0].1.device.clone(), record[0].1.driver.clone()));
                    let block = Found { record, store: Arc::new(attempt.store.clone()), device };
                    found.entry(block.record[0].0.clone()).or_default().push(block);
                }
            }
        }
        Ok(found)
    }

    /// Finds a whole copy of every file that a chosen record stands for; each that has none is a sentence for `damage`.
    fn belongings(&mut self, chosen: &Chosen<CellFacts>) -> Result<Belongings, StoreError> {
        let (plan, out) = (self.plan, &self.out);
        let others: Vec<&Store> = self.attempts.iter().flatten().map(|attempt| &attempt.store).chain([out]).collect();
        let mut belongings = Belongings::default();
        // Cells of two devices may share a file's name, and each must find the bytes that its record was made from.
        let mut seen = HashSet::new();
        let find = |(cell, own, (name, hash)): (&Cell, &Store, (String, Option<Hash>))| {
            // What cells share may stand with another attempt.
            let path = own.image_path(&name);
            let is_whole = |path: &PathBuf| match hash {
                Some(hash) => content_hash(path).is_ok_and(|found| found == *hash.to_hex()),
                None => images::is_whole(path),
            };
            let mut copies = others.iter().map(|store| store.image_path(&name));
            if is_whole(&path) {
                return Ok(None);
            }
            copies.find(is_whole).map(|copy| Some((file_key(&name, hash), copy))).ok_or_else(|| {
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
        for cells in plan.cells.chunks(CELLS_AT_ONCE) {
            let mut wanted = Vec::new();
            for (cell, found) in cells.iter().filter_map(|cell| Some((cell, *chosen.get(cell.id.as_str())?))) {
                let files = files(plan, cell, found).filter(|(name, hash)| seen.insert(file_key(name, *hash)));
                wanted.extend(files.map(|file| (cell, &*found.store, file)));
                if !found.record.has_reference || belongings.stops.contains_key(&cell.reference) {
                    continue;
                }
                for store in std::iter::once(&*found.store).chain(others.iter().copied()) {
                    if let Some(stop) = whole(store.whole_reference(&cell.reference), &mut self.damage)? {
                        belongings.stops.insert(cell.reference.clone(), stop);
                        break;
                    }
                }
            }
            for copy in wanted.into_par_iter().map(find).collect::<Vec<_>>() {
                match copy {
                    Ok(elsewhere) => belongings.elsewhere.extend(elsewhere),
                    Err(sentence) => self.damage.push(sentence),
                }
            }
        }
        Ok(belongings)
    }

    /// Brings the chosen records, with the files that belong to them, into the run's folder: the records last.
    fn import_cells(&self, chosen: &Chosen<CellFacts>, belongings: &Belongings) -> Result<(), StoreError> {
        let (plan, out) = (self.plan, &self.out);
        let done = || plan.cells.iter().filter_map(|cell| Some((cell, *chosen.get(cell.id.as_str())?)));
        let mut placed = HashSet::new();
        for (cell, found) in done() {
            for (name, hash) in files(plan, cell, found).filter(|(name, _)| placed.insert(file_key(name, None))) {
                let own = || found.store.image_path(&name);
                let from = belongings.elsewhere.get(&file_key(&name, hash)).cloned().unwrap_or_else(own);
                out.place(&from, &out.image_path(&name), hash.map(|hash| hash.to_hex()).as_deref())?;
            }
        }
        for (id, stop) in &belongings.stops {
            out.write_reference(id, stop)?;
        }
        for (cell, found) in done().filter(|(_, found)| found.store.dir() != out.dir()) {
            out.take_cell(&found.store, &cell.id)?;
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
    fn import_failures(&self, chosen: &Chosen<CellFacts>) -> Result<(), StoreError> {
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
    fn holes(&self, chosen: &Chosen<CellFacts>) -> Result<Vec<Hole>, StoreError> {
        let (plan, out) = (self.plan, &self.out);
        let by_id: BTreeMap<&str, &Cell> = plan.cells.iter().map(|cell| (cell.id.as_str(), cell)).collect();
        let jobs = timing::jobs(plan);
        let mut holes = Vec::new();
        for (chunk, attempts) in self.file.chunks.iter().zip(&self.attempts) {
            let mut cells = Vec::new();
            for id in &chunk.cells {
                if !chosen.contains_key(id.as_str()) && out.failure(id)?.is_none() {
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
        for device in records.iter().map(|record| &*record.device).collect::<BTreeSet<_>>() {
            *counts.entry(device).or_default() += 1;
        }
    }
    // Of devices with equally many the first by name.
    let main = counts.iter().rev().max_by_key(|(_, count)| **count).map(|(device, _)| *device);
    let mut chosen = BTreeMap::new();
    let mut devices: BTreeMap<&Device, usize> = BTreeMap::new();
    for (id, records) in found {
        let of_main = records.iter().find(|record| Some(&*record.device) == main);
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
fn disagreements(plan: &Plan, found: &BTreeMap<String, Vec<Found<CellFacts>>>) -> Result<Vec<String>, StoreError> {
    let mut sentences = Vec::new();
    for cell in &plan.cells {
        let mut first_of: BTreeMap<&Device, &Found<CellFacts>> = BTreeMap::new();
        for record in found.get(&cell.id).into_iter().flatten() {
            let first = *first_of.entry(&record.device).or_insert(record);
            if first.record.hash == record.record.hash {
                continue;
            }
            let read = |found: &Found<CellFacts>| found.store.whole_cell(&cell.id);
            let differing = read(first)?.zip(read(record)?).map_or_else(Vec::new, |(a, b)| differing(&a, &b));
            sentences.push(format!(
                "{} {}: {} and {} differ in {}",
                cell.id,
                plan.label(cell),
                first.store.cell_path(&cell.id).display(),
                record.store.cell_path(&cell.id).display(),
                differing.join(", ")
            ));
        }
    }
    Ok(sentences)
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
#[derive(Default)]
struct Belongings {
    /// Whole copies of files that do not stand with the record they were asked for by.
    elsewhere: HashMap<u128, PathBuf>,
    /// Where each reference stopped.
    stops: BTreeMap<String, ReferenceStop>,
}

/// Cells whose files are checked together.
const CELLS_AT_ONCE: usize = 1024;

/// The files of a cell, each with its content hash where the record tells it.
fn files(plan: &Plan, cell: &Cell, found: &Found<CellFacts>) -> impl Iterator<Item = (String, Option<Hash>)> {
    images::files(plan, cell).into_iter().zip(found.record.files.iter().copied())
}

/// Stands for a file's name and content: names alone would take 100 MB of 100,000 cells.
fn file_key(name: &str, hash: Option<Hash>) -> u128 {
    let mut hasher = blake3::Hasher::new();
    hasher.update(hash.as_ref().map_or(&[], |hash| hash.as_bytes().as_slice())).update(name.as_bytes());
    hasher.finalize().as_bytes()[..16].iter().fold(0, |key, byte| key << 8 | u128::from(*byte))
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
