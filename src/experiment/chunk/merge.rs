//! Makes one run of the attempts at all chunks: the folder that `run` would have left on one machine.
//!
//! Scores are a function of cell and device, so records of one cell from one device must agree to the last bit; where they do not,
//! something is wrong with a machine, and nothing is merged. Times are no such function: of several timings of a block the first is kept
//! whole, and no table compares times of two devices.

use super::ChunkError;
use super::file::PlanFile;
use super::store::{Attempt, ChunkStore};
use crate::experiment::images;
use crate::experiment::live::LIVE_FILE;
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::provenance;
use crate::experiment::run::{Outcome, RunOptions, tabulate};
use crate::experiment::store::{CellRecord, Exact, FailureRecord, Store, StoreError};
use crate::experiment::timing::{self, TimingRecord};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// How to merge.
#[derive(Debug)]
pub struct MergeOptions {
    /// The folder that the chunks share.
    pub store: PathBuf,
    /// The folder of the run to make; it may be the same.
    pub out: PathBuf,
    pub command_line: Vec<String>,
    /// Writes the timed passes as a Chrome trace.
    pub trace: bool,
}

/// What a merge left.
#[derive(Debug)]
pub struct Merged {
    pub outcome: Outcome,
    /// Chunks of which something is missing; empty when the run is whole.
    pub holes: Vec<Hole>,
    /// What a reader of the tables should know, one sentence each.
    pub notes: Vec<String>,
}

/// What is missing of one chunk.
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

/// A record and where it stands.
struct Found<T> {
    record: T,
    store: Store,
    device: Device,
}

/// Merges what there is. Nothing is written when records contradict each other.
pub fn merge(file: &PlanFile, plan: &Plan, options: &MergeOptions) -> Result<Merged, ChunkError> {
    let chunks = ChunkStore::existing(&options.store, file)?;
    let attempts: Vec<Vec<Attempt>> =
        file.chunks.iter().map(|chunk| chunks.attempts(chunk.index)).collect::<Result<_, _>>()?;
    if attempts.iter().all(Vec::is_empty) {
        return Err(ChunkError::NoStore { dir: options.store.clone() });
    }
    let out = Store::open(&options.out, plan)?;
    let cells = find_cells(&out, plan, &attempts)?;
    let disagreements = disagreements(plan, &cells);
    if !disagreements.is_empty() {
        return Err(ChunkError::Disagreement(disagreements));
    }
    let blocks = find_blocks(file, plan, &attempts)?;
    let mut notes = Vec::new();
    let chosen = choose(&cells, "cells", &mut notes);
    let chosen_blocks = choose(&blocks, "blocks of timings", &mut notes);

    import_cells(&out, plan, &chosen, attempts.iter().flatten())?;
    import_failures(&out, plan, &chosen, attempts.iter().flatten())?;
    for block in chosen_blocks.values() {
        for (id, record) in &block.record {
            out.write_timing(id, record)?;
        }
    }
    write_provenance(&out, plan, attempts.iter().flatten(), options)?;
    let holes = holes(file, plan, &out, &attempts)?;
    let stop = AtomicBool::new(false);
    let run_options = RunOptions {
        dir: options.out.clone(),
        stop: &stop,
        command_line: options.command_line.clone(),
        fail_fast: false,
        trace: options.trace,
    };
    Ok(Merged { outcome: tabulate(plan, out, &run_options)?, holes, notes })
}

/// Every record of every cell, that of the run's folder first, then in the order of the attempts.
fn find_cells(
    out: &Store,
    plan: &Plan,
    attempts: &[Vec<Attempt>],
) -> Result<BTreeMap<String, Vec<Found<CellRecord>>>, StoreError> {
    let mut found: BTreeMap<String, Vec<Found<CellRecord>>> = BTreeMap::new();
    let mut add = |id: &str, store: &Store| -> Result<(), StoreError> {
        if let Some(record) = store.cell(id)? {
            let device = (record.device.clone(), record.driver.clone());
            found.entry(id.to_owned()).or_default().push(Found { record, store: store.clone(), device });
        }
        Ok(())
    };
    for cell in &plan.cells {
        add(&cell.id, out)?;
    }
    for attempt in attempts.iter().flatten() {
        attempt.ids("cells")?.iter().try_for_each(|id| add(id, &attempt.store))?;
    }
    Ok(found)
}

/// The timings of every block, by the id of its first configuration, once for each attempt that finished it.
fn find_blocks(
    file: &PlanFile,
    plan: &Plan,
    attempts: &[Vec<Attempt>],
) -> Result<BTreeMap<String, Vec<Found<Block>>>, ChunkError> {
    let jobs = timing::jobs(plan);
    let mut found: BTreeMap<String, Vec<Found<Block>>> = BTreeMap::new();
    for (chunk, attempts) in file.chunks.iter().zip(attempts) {
        for attempt in attempts {
            for block in chunk.blocks(&jobs) {
                let records = block.iter().map(|id| Ok(attempt.store.timing(id)?.map(|record| (id.clone(), record))));
                let records: Option<Block> = records.collect::<Result<_, StoreError>>()?;
                let Some(record) = records else { continue };
                let device = (record[0].1.device.clone(), record[0].1.driver.clone());
                let block = Found { record, store: attempt.store.clone(), device };
                found.entry(block.record[0].0.clone()).or_default().push(block);
            }
        }
    }
    Ok(found)
}

/// One record each: of the device that has most of them, so that as few devices as possible meet in a table, else the first.
fn choose<'f, T>(
    found: &'f BTreeMap<String, Vec<Found<T>>>,
    what: &str,
    notes: &mut Vec<String>,
) -> BTreeMap<&'f str, &'f Found<T>> {
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
            let columns = differing_columns(&first.record, &record.record);
            if !columns.is_empty() {
                sentences.push(format!(
                    "{} {}: {} and {} differ in {}",
                    cell.id,
                    plan.label(cell),
                    first.store.cell_path(&cell.id).display(),
                    record.store.cell_path(&cell.id).display(),
                    columns.join(", ")
                ));
            }
        }
    }
    sentences
}

/// The columns of the tables in which two records differ, with both values. The time that a cell took is in none.
fn differing_columns(a: &CellRecord, b: &CellRecord) -> Vec<String> {
    let (a, b) = (columns(a), columns(b));
    let names: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
    let value = |map: &BTreeMap<String, String>, name: &String| map.get(name).cloned().unwrap_or("none".to_owned());
    let differing = names.into_iter().filter(|name| a.get(*name) != b.get(*name));
    differing.map(|name| format!("{name} ({} and {})", value(&a, name), value(&b, name))).collect()
}

/// Everything of a record that stands in a table, by column.
fn columns(record: &CellRecord) -> BTreeMap<String, String> {
    let exact = |name: String, score: &Exact| (name, String::from(*score));
    let mut columns: BTreeMap<String, String> = record.axes.clone();
    columns.extend(record.scores.iter().map(|(name, score)| exact(name.to_owned(), score)));
    columns.extend(record.bias_variance.iter().map(|(name, score)| exact(name.to_owned(), score)));
    columns.extend(record.noise_floors.iter().map(|(name, score)| exact(format!("{name}_noise_floor"), score)));
    if let Some(stop) = &record.reference {
        columns.insert("reference_samples".to_owned(), stop.samples.to_string());
        columns.extend([exact("reference_relative_error".to_owned(), &stop.relative_error)]);
        columns.insert("reference_stopped_by".to_owned(), stop.stopped_by.name().to_owned());
    }
    columns.insert("verdict".to_owned(), record.verdict.clone());
    for bin in &record.bins {
        let place = |name: &str| format!("{name} at n_dot_v {} to {}", bin.lo, bin.hi);
        columns.insert(place("pixel_count"), bin.pixel_count.to_string());
        columns.extend(bin.scores.iter().map(|(name, score)| exact(place(name), score)));
    }
    columns
}

/// Brings the chosen records, with the files that belong to them, into the run's folder.
fn import_cells<'a>(
    out: &Store,
    plan: &Plan,
    chosen: &BTreeMap<&str, &Found<CellRecord>>,
    attempts: impl Iterator<Item = &'a Attempt> + Clone,
) -> Result<(), StoreError> {
    let mut placed: BTreeSet<String> = BTreeSet::new();
    for cell in &plan.cells {
        let Some(found) = chosen.get(cell.id.as_str()).filter(|found| found.store.dir() != out.dir()) else { continue };
        // What cells share may stand with an earlier attempt only.
        let stores = std::iter::once(&found.store).chain(attempts.clone().map(|attempt| &attempt.store));
        for name in images::files(plan, cell) {
            if placed.insert(name.clone()) {
                let from = stores.clone().map(|store| store.image_path(&name)).find(|path| path.exists());
                place(&from.unwrap_or_else(|| found.store.image_path(&name)), &out.image_path(&name))?;
            }
        }
        if placed.insert(cell.reference.clone()) {
            let stop = stores.map(|store| store.reference(&cell.reference).transpose()).find_map(|stop| stop);
            stop.transpose()?.map_or(Ok(()), |stop| out.write_reference(&cell.reference, &stop))?;
        }
        out.write_cell(&found.record)?;
    }
    let live = out.dir().join(LIVE_FILE);
    let made = attempts.map(|attempt| attempt.store.dir().join(LIVE_FILE)).find(|path| path.exists());
    made.filter(|_| !live.exists()).map_or(Ok(()), |from| place(&from, &live))
}

/// Makes `to` the file `from`: by a link, since images never change, or by a copy where links do not reach.
fn place(from: &Path, to: &Path) -> Result<(), StoreError> {
    let io = |error| StoreError::Io { path: from.to_owned(), error };
    match std::fs::remove_file(to) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(StoreError::Io { path: to.to_owned(), error });
        }
        _ => {}
    }
    match std::fs::hard_link(from, to) {
        Ok(()) => Ok(()),
        Err(_) => std::fs::copy(from, to).map(|_| ()).map_err(io),
    }
}

/// Keeps the last reason of every cell that failed and was not done by another attempt.
fn import_failures<'a>(
    out: &Store,
    plan: &Plan,
    chosen: &BTreeMap<&str, &Found<CellRecord>>,
    attempts: impl Iterator<Item = &'a Attempt>,
) -> Result<(), StoreError> {
    let mut failures: BTreeMap<String, FailureRecord> = BTreeMap::new();
    for attempt in attempts {
        for id in attempt.ids("failed")? {
            if let Some(failure) = attempt.store.failure(&id)? {
                failures.insert(id, failure);
            }
        }
    }
    let open = plan.cells.iter().filter(|cell| !chosen.contains_key(cell.id.as_str()));
    open.filter_map(|cell| failures.get(&cell.id)).try_for_each(|failure| out.write_failure(failure))
}

/// The sessions of all attempts, each with its chunk, after those of an ordinary run in the same folder.
fn write_provenance<'a>(
    out: &Store,
    plan: &Plan,
    attempts: impl Iterator<Item = &'a Attempt>,
    options: &MergeOptions,
) -> Result<(), StoreError> {
    let path = out.provenance_path();
    let mut value = out.read(&path)?.unwrap_or_else(|| provenance::provenance(plan));
    let kept = value["sessions"].as_array().cloned().unwrap_or_default();
    let mut sessions: Vec<serde_json::Value> = kept.into_iter().filter(|session| session["chunk"].is_null()).collect();
    for attempt in attempts {
        let own: Option<serde_json::Value> = attempt.store.read(&attempt.store.provenance_path())?;
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
    out.write_text(&out.dir().join("experiment.toml"), &plan.config.text)
}

/// What the run's folder lacks, by chunk.
fn holes(file: &PlanFile, plan: &Plan, out: &Store, attempts: &[Vec<Attempt>]) -> Result<Vec<Hole>, StoreError> {
    let by_id: BTreeMap<&str, &Cell> = plan.cells.iter().map(|cell| (cell.id.as_str(), cell)).collect();
    let jobs = timing::jobs(plan);
    let mut holes = Vec::new();
    for (chunk, attempts) in file.chunks.iter().zip(attempts) {
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
