//! Prices of work. A plan file holds its prices, so that its chunks follow from it alone.

use crate::runner::estimate::{Host, Item, Line, Part, Source, Speeds, constants_at, items, line_of};
use crate::runner::plan::{Cell, Plan};
use crate::runner::timing;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Seconds of each kind of work in a plan.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Prices {
    /// Where they come from, for people.
    pub basis: String,
    /// By the kind of an [`Item`].
    pub lines: BTreeMap<String, Line>,
}

impl Prices {
    /// Prices of a device that draws this many samples in a second. They are the same on every machine.
    pub fn stated(plan: &Plan, samples_per_second: f64) -> Self {
        let sources = [(Source::Constants, constants_at(samples_per_second))];
        let basis = format!("stated, for {samples_per_second:e} samples a second");
        Self { basis, ..Self::of_sources(plan, &sources, Host::STATED) }
    }

    /// Prices of an estimate: those of the first source that knows a kind; the last one knows all.
    pub fn of_sources(plan: &Plan, sources: &[(Source, Speeds)], host: Host) -> Self {
        let cells: Vec<&Cell> = plan.cells.iter().collect();
        let (mut used, mut lines) = (BTreeSet::new(), BTreeMap::new());
        for item in items(plan, &cells, &timing::jobs(plan), &BTreeSet::new()) {
            let (source, mut line) = line_of(sources, &item.kind);
            if item.part == Part::Scores {
                line = line.times(1.0 / host.threads as f64);
            }
            used.insert(source);
            lines.insert(item.kind, line);
        }
        let basis: Vec<&str> = used.iter().map(|source| source.name()).collect();
        Self { basis: basis.join(", "), lines }
    }

    /// Seconds of an item. One of a kind that has no price costs nothing; a plan's own prices know all its kinds.
    pub fn seconds(&self, item: &Item) -> f64 {
        self.lines.get(&item.kind).map_or(0.0, |line| item.seconds(line))
    }
}
