//! Which cells of a run are finished, and which failed.

use super::record::FailureRecord;
use crate::experiment::{Cell, Id};
use std::collections::{BTreeMap, BTreeSet};

/// The cells that were tried. Scores stay in the records of the store, since a run may have many
/// thousand cells.
#[derive(Clone, Debug, Default)]
pub struct Results {
    done: BTreeSet<Id>,
    failures: BTreeMap<Id, FailureRecord>,
}

impl Results {
    /// Whether the cell has its record.
    pub fn is_done(&self, cell: &Cell) -> bool {
        self.done.contains(&cell.id)
    }

    /// Why the cell failed.
    pub fn failure(&self, cell: &Cell) -> Option<&FailureRecord> {
        self.failures.get(&cell.id)
    }

    pub fn is_tried(&self, cell: &Cell) -> bool {
        self.is_done(cell) || self.failure(cell).is_some()
    }

    pub fn done_count(&self) -> usize {
        self.done.len()
    }

    pub fn finish(&mut self, cell: Id) {
        self.failures.remove(&cell);
        self.done.insert(cell);
    }

    pub fn fail(&mut self, failure: FailureRecord) {
        self.done.remove(&failure.cell);
        self.failures.insert(failure.cell, failure);
    }

    /// The cell counts as untried.
    pub fn forget(&mut self, cell: &Cell) {
        self.done.remove(&cell.id);
        self.failures.remove(&cell.id);
    }
}
