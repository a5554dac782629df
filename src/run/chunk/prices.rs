//! Prices of work. A plan file holds its prices, so that its chunks follow from it alone.

use crate::run::estimate::{Host, Item, Speeds, constants_at};
use serde::{Deserialize, Serialize};

/// Seconds of each kind of work.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Prices {
    /// Where they come from, for people.
    pub basis: String,
    pub lines: Speeds,
}

impl Prices {
    /// Prices of a device that draws this many samples in a second. They are the same on every machine.
    pub fn stated(samples_per_second: f64) -> Self {
        let mut lines = constants_at(samples_per_second);
        lines.0.retain(|kind, _| !kind.starts_with("bytes"));
        lines.0.entry("score".to_owned()).and_modify(|line| *line = line.times(1.0 / Host::STATED.threads as f64));
        Self { basis: format!("stated, for {samples_per_second:e} samples a second"), lines }
    }

    /// Seconds of an item. One of a kind that has no price costs nothing.
    pub fn seconds(&self, item: &Item) -> f64 {
        self.lines.line(&item.kind).map_or(0.0, |line| item.seconds(line))
    }
}
