//! What earlier invocations left in the folder of a run.

use super::is_in_share;
use crate::experiment::plan::{Cell, Plan};
use crate::instrument::metrics::METRICS;
use crate::run::images;
use crate::run::provenance::device_words;
use crate::run::results::Results;
use crate::run::split::Share;
use crate::run::store::{CELLS_FOLDER, CellRecord, Store, StoreError};
use std::collections::{BTreeMap, BTreeSet};

/// The finished cells of a share, and what cannot be used.
#[derive(Default)]
pub(super) struct Found {
    pub(super) results: Results,
    /// Images of finished cells that are missing or differ from their records, by name.
    pub(super) damaged: BTreeSet<String>,
    /// A sentence for each record that cannot be used.
    pub(super) unusable: Vec<String>,
    /// Finished cells by device.
    pub(super) devices: BTreeMap<String, usize>,
}

impl Found {
    /// Reads the records of a share and checks their images, group by group: cells of a group have
    /// images in common, which are read once, and the names of all groups would need more memory
    /// than all else.
    pub(super) fn read(
        plan: &Plan,
        store: &Store,
        share: &Option<Share>,
    ) -> Result<Self, StoreError> {
        let mut found = Self::default();
        for group in plan.groups() {
            let mut recorded = images::Recorded::new();
            for cell in group.cells().filter(|cell| is_in_share(share, cell)) {
                if let Some(record) = found.record(plan, store, cell)? {
                    images::note(&mut recorded, plan, cell, &record.files);
                }
            }
            found.damaged.extend(images::damaged(store, recorded));
        }
        Ok(found)
    }

    /// Reads and notes the record of a cell; `None` without a usable one.
    fn record(
        &mut self,
        plan: &Plan,
        store: &Store,
        cell: &Cell,
    ) -> Result<Option<CellRecord>, StoreError> {
        let record = match store.record::<CellRecord>(CELLS_FOLDER, cell.id) {
            Ok(Some(record)) => record,
            Ok(None) => return Ok(None),
            Err(error) if error.is_unusable_record() => {
                self.unusable.push(error.to_string());
                return Ok(None);
            }
            Err(error) => return Err(error),
        };
        let is_complete = || {
            let mut metrics = METRICS.iter();
            metrics.all(|metric| record.scores.contains_key(metric.name))
        };
        // A record of another program may lack some.
        if plan.config.is_scored && !is_complete() {
            let path = store.cell_path(cell.id);
            self.unusable
                .push(format!("{}: lacks a score of some metric", path.display()));
            return Ok(None);
        }
        self.results.finish(cell.id);
        let words = device_words(&record.device, &record.driver, record.target.as_deref());
        *self.devices.entry(words).or_default() += 1;
        Ok(Some(record))
    }
}
