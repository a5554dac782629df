//! Merges the work of shards into one run: checks it, then writes tables and provenance.

use super::{Outcome, Run, RunError, RunOptions};
use crate::experiment::{Cell, Id, Plan};
use crate::run::provenance::{self, Provenance, device_words};
use crate::run::shard::Shard;
use crate::run::split::split;
use crate::run::store::{REFERENCES_FOLDER, SHARDS_FOLDER, Store, StoreError, TIMINGS_FOLDER};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

#[derive(Debug)]
pub struct Merged {
    pub outcome: Outcome,
    pub missing: Missing,
    /// Warnings, one sentence each.
    pub notes: Vec<String>,
}

/// Work without a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Missing {
    pub cells: Vec<String>,
    pub timings: usize,
    /// The incomplete shards and how each ended.
    pub shards: Vec<(Shard, String)>,
}

/// Merges the folder of the options. Nothing is written if a record or an image is damaged.
pub fn merge(plan: &Plan, options: &RunOptions) -> Result<Merged, RunError> {
    let Some(found) = provenance::read(&options.dir)? else {
        let why = "contains no run; expected the --out of `splitsum run --shard`".to_owned();
        return Err(StoreError::Refused {
            dir: options.dir.clone(),
            why,
        }
        .into());
    };
    let store = Store::open(&options.dir, plan)?;
    store.check_nothing_is_lost(&found, plan)?;
    let mut run = Run::load(plan, store, options)?;
    let damage = run.damage()?;
    if !damage.is_empty() {
        return Err(RunError::Damaged(damage));
    }
    let cell_note = mixed("cells", &run.devices);
    let missing = run.missing()?;
    run.write_identity()?;
    let outcome = Outcome {
        is_stopped: missing != Missing::default(),
        ..run.finish(true)?
    };
    let mut timed = BTreeMap::new();
    for record in &outcome.timings {
        let words = device_words(&record.device, &record.driver, record.target.as_deref());
        *timed.entry(words).or_default() += 1;
    }
    let notes = cell_note
        .into_iter()
        .chain(mixed("timed configurations", &timed))
        .collect();
    Ok(Merged {
        outcome,
        missing,
        notes,
    })
}

/// A sentence if records come from several devices.
fn mixed(what: &str, counts: &BTreeMap<String, usize>) -> Option<String> {
    let list: Vec<String> = counts
        .iter()
        .map(|(device, count)| format!("{count} from {device}"))
        .collect();
    (counts.len() > 1).then(|| {
        format!(
            "the {what} come from {} devices: {}",
            counts.len(),
            list.join(", ")
        )
    })
}

impl Run<'_> {
    /// One sentence for each unusable record and image.
    fn damage(&mut self) -> Result<Vec<String>, StoreError> {
        let plan = self.plan;
        let store = &self.store;
        let mut damage: Vec<String> = std::mem::take(&mut self.unusable);
        let references: BTreeSet<Id> = plan
            .cells
            .iter()
            .filter_map(|cell| cell.reference)
            .collect();
        let references = references
            .into_iter()
            .map(|id| store.record::<Value>(REFERENCES_FOLDER, id).map(drop));
        let timings = self
            .jobs
            .iter()
            .map(|job| store.record::<Value>(TIMINGS_FOLDER, job.id).map(drop));
        for read in references.chain(timings) {
            match read {
                Err(error) if error.is_unusable_record() => damage.push(error.to_string()),
                read => read?,
            }
        }
        damage.extend(std::mem::take(&mut self.damaged).iter().map(|name| {
            let path = store.image_path(name);
            let what = if path.exists() {
                "differs from its record"
            } else {
                "is missing"
            };
            format!("{}: {what}", path.display())
        }));
        Ok(damage)
    }

    /// Work that has neither a record nor a failure.
    fn missing(&self) -> Result<Missing, StoreError> {
        let mut cells: Vec<&Cell> = Vec::new();
        for cell in self
            .plan
            .cells
            .iter()
            .filter(|cell| !self.results.is_tried(cell))
        {
            if self.store.failure(cell.id)?.is_none() {
                cells.push(cell);
            }
        }
        let open = self.open_jobs();
        let mut shards = Vec::new();
        let known = self
            .store
            .stems(SHARDS_FOLDER)
            .iter()
            .filter_map(|stem| Shard::by_stem(stem))
            .collect::<Vec<_>>();
        for count in known
            .iter()
            .map(|shard| shard.count)
            .collect::<BTreeSet<_>>()
        {
            for (index, share) in (1..).zip(split(self.plan, count)) {
                let has_cell = cells.iter().any(|cell| share.cells.contains(&cell.id));
                if has_cell || open.iter().any(|job| share.timings.contains(&job.id)) {
                    let shard = Shard { index, count };
                    shards.push((shard, self.end_of(shard)?));
                }
            }
        }
        let cells = cells
            .into_iter()
            .map(|cell| self.plan.label(cell))
            .collect();
        Ok(Missing {
            cells,
            timings: open.len(),
            shards,
        })
    }

    /// How the last process of a shard ended, in words.
    fn end_of(&self, shard: Shard) -> Result<String, StoreError> {
        let provenance = provenance::read_file(&self.store.shard_path(shard))?;
        let Some(last) = provenance.as_ref().and_then(Provenance::last_session) else {
            return Ok("never started".to_owned());
        };
        let ended = if last.wall_s.is_some() {
            "ended early"
        } else {
            "killed"
        };
        Ok(format!(
            "started on {} at {}, {ended}",
            last.host.name.as_deref().unwrap_or_default(),
            last.date_utc
        ))
    }
}
