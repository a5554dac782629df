//! Makes one run of what shards left in a folder: checks that all of it is there and whole, then writes tables and
//! provenance.

use super::{Outcome, Run, RunError, RunOptions};
use crate::experiment::plan::{Cell, Plan};
use crate::run::images;
use crate::run::provenance;
use crate::run::shard::Shard;
use crate::run::split::split;
use crate::run::store::{SHARDS_FOLDER, Store, StoreError};
use crate::run::timing::TimingRecord;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// The outcome of a merge.
#[derive(Debug)]
pub struct Merged {
    pub outcome: Outcome,
    /// What no shard has done.
    pub missing: Missing,
    /// Notes for a reader of the tables, one sentence each.
    pub notes: Vec<String>,
}

/// Work without a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Missing {
    /// Label of each cell that was not tried.
    pub cells: Vec<String>,
    /// Timed configurations.
    pub timings: usize,
    /// The shards of which something is missing, each with how it ended.
    pub shards: Vec<(Shard, String)>,
}

/// Merges what there is in the folder of the options. Nothing is written if a record or an image is damaged.
pub fn merge(plan: &Plan, options: &RunOptions) -> Result<Merged, RunError> {
    let Some(found) = provenance::read(&options.dir)? else {
        let why = "holds no run; expected the --out of `splitsum run --shard`".to_owned();
        return Err(StoreError::Refused { dir: options.dir.clone(), why }.into());
    };
    let store = Store::open(&options.dir, plan)?;
    store.check_nothing_is_lost(&found, plan)?;
    let mut run = Run::load(plan, store, options)?;
    let damage = run.damage()?;
    if !damage.is_empty() {
        return Err(RunError::Damaged(damage));
    }
    let mut notes = Vec::new();
    notes.extend(mixed("cells", &run.devices));
    let missing = run.missing()?;
    run.write_own()?;
    let outcome = Outcome { is_stopped: missing != Missing::default(), ..run.finish(true)? };
    notes.extend(mixed("timed configurations", &counted(outcome.timings.iter().map(device_of))));
    Ok(Merged { outcome, missing, notes })
}

fn device_of(record: &TimingRecord) -> String {
    format!("{} ({})", record.device, record.driver)
}

fn counted(names: impl Iterator<Item = String>) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    names.for_each(|name| *counts.entry(name).or_default() += 1);
    counts
}

/// A sentence if records come from several devices.
fn mixed(what: &str, counts: &BTreeMap<String, usize>) -> Option<String> {
    let list: Vec<String> = counts.iter().map(|(device, count)| format!("{count} from {device}")).collect();
    (counts.len() > 1).then(|| format!("the {what} come from {} devices: {}", counts.len(), list.join(", ")))
}

impl Run<'_> {
    /// A sentence for each record and image that cannot be used.
    fn damage(&mut self) -> Result<Vec<String>, StoreError> {
        let (plan, store) = (self.plan, &self.store);
        let mut damage: Vec<String> = std::mem::take(&mut self.unusable);
        let references: BTreeSet<&str> = plan.cells.iter().map(|cell| cell.reference.as_str()).collect();
        let references = references.into_iter().map(|id| store.whole_reference(id).map(drop));
        let timings = self.jobs.iter().map(|job| store.whole_timing::<Value>(&job.id).map(drop));
        for read in references.chain(timings) {
            match read {
                Err(error) if error.is_unusable_record() => damage.push(error.to_string()),
                read => read?,
            }
        }
        let hashes = std::mem::take(&mut self.recorded_hashes);
        let done = plan.cells.iter().filter_map(|cell| Some((cell, &**hashes.get(cell.id.as_str())?)));
        damage.extend(images::damaged(plan, store, done).iter().map(|name| {
            let path = store.image_path(name);
            let what = if path.exists() { "is not the file that its record was made from" } else { "is missing" };
            format!("{}: {what}", path.display())
        }));
        Ok(damage)
    }

    /// What has no record, nor a reason why it failed.
    fn missing(&self) -> Result<Missing, StoreError> {
        let mut cells: Vec<&Cell> = Vec::new();
        for cell in self.plan.cells.iter().filter(|cell| !self.results.contains_key(&cell.id)) {
            if self.store.failure(&cell.id)?.is_none() {
                cells.push(cell);
            }
        }
        let open = self.open_jobs();
        let mut shards = Vec::new();
        let known = self.store.ids(SHARDS_FOLDER).iter().filter_map(|stem| Shard::by_stem(stem)).collect::<Vec<_>>();
        for count in known.iter().map(|shard| shard.count).collect::<BTreeSet<_>>() {
            for (index, share) in (1..).zip(split(self.plan, count)) {
                let has_cell = cells.iter().any(|cell| share.cells.contains(&cell.id));
                if has_cell || open.iter().any(|job| share.timings.contains(&job.id)) {
                    let shard = Shard { index, count };
                    shards.push((shard, self.end_of(shard)?));
                }
            }
        }
        let cells = cells.into_iter().map(|cell| self.plan.label(cell)).collect();
        Ok(Missing { cells, timings: open.len(), shards })
    }

    /// How the last process at a shard ended, for people.
    fn end_of(&self, shard: Shard) -> Result<String, StoreError> {
        let value = provenance::read_file(&self.store.shard_path(shard))?;
        let sessions = value.as_ref().and_then(|value| value["sessions"].as_array());
        let Some(last) = sessions.and_then(|sessions| sessions.last()) else { return Ok("never begun".to_owned()) };
        let text = |pointer: &str| last.pointer(pointer).and_then(Value::as_str).unwrap_or_default();
        let ended = if last["wall_s"].is_number() { "ended early" } else { "killed" };
        Ok(format!("begun on {} at {}, {ended}", text("/host/name"), text("/date_utc")))
    }
}
