//! What work took beside what is stated, by kind, and the file in the cache folder that keeps it for later runs.

use super::work::{Amount, Table, alike, amount, kind_of, kinds, ladder_amount, score_kind, stated_s, tables, timed};
use crate::experiment::plan::{Cell, Plan};
use crate::files::{RECORD_BYTES_MAX, read_regular};
use crate::pipeline::DeviceInfo;
use crate::pixels::write_atomically;
use crate::run::statistics::median;
use crate::run::store::Spent;
use crate::run::timing::{TimingJob, TimingRecord};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The file in a cache folder.
pub const SPEEDS_FILE: &str = "speeds.json";
/// What earlier runs count beside a new one: older ones count less and less.
const OLD_SHARE: f64 = 0.5;

/// Seconds taken and seconds stated, by kind and by the general kinds that hold it.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Speeds(BTreeMap<String, [f64; 2]>);

impl Speeds {
    /// Adds an item that took `taken` seconds.
    pub fn add(&mut self, kind: &str, taken: f64, stated: f64) {
        if !(taken.is_finite() && stated > 0.0) {
            return;
        }
        for kind in kinds(kind) {
            let sum = self.0.entry(kind.to_owned()).or_default();
            *sum = [sum[0] + taken, sum[1] + stated];
        }
    }

    /// Seconds taken over seconds stated: those of the most special known kind, 1 if nothing is known.
    pub fn ratio(&self, kind: &str) -> f64 {
        alike(kind).find_map(|kind| self.0.get(kind)).map_or(1.0, |[taken, stated]| taken / stated)
    }

    /// Adds those of another run, as far as they count beside this one.
    fn add_older(&mut self, older: &Self) {
        for (kind, sum) in &older.0 {
            let own = self.0.entry(kind.clone()).or_default();
            (0..2).for_each(|i| own[i] += OLD_SHARE * sum[i]);
        }
    }
}

/// An item of work with the seconds that it took and those that are stated.
pub type Measured = (String, f64, f64);

/// The work of a cell.
pub fn of_cell(plan: &Plan, cell: &Cell, spent: &Spent) -> Vec<Measured> {
    let (point, reference) = (&cell.point, plan.reference_point(&cell.point));
    let mut items = Vec::new();
    let mut one = |kind: String, ms: Option<f64>, times: u32, amount| {
        let stated = f64::from(times) * stated_s(&kind, amount);
        items.extend(ms.map(|ms| (kind, ms / 1e3, stated)));
    };
    let repeats = plan.repeats_of(point).unwrap_or(0);
    one(kind_of("image", point), spent.image_ms, 1 + repeats, amount(plan, point));
    one(kind_of("reference", &reference), spent.reference_ms, 1, amount(plan, &reference));
    one("ladder".to_owned(), spent.ladder_ms, 1, ladder_amount(plan, point).unwrap_or_default());
    let of_both: BTreeMap<String, Table> =
        tables(plan, point).into_iter().chain(tables(plan, &reference)).map(|t| (t.key.clone(), t)).collect();
    for Table { kind, samples, .. } in of_both.into_values() {
        let ms = kind.split(' ').nth(1).and_then(|name| spent.tables_ms.get(name)).copied();
        one(kind, ms, 1, Amount { pixels: 0.0, samples });
    }
    let pixels = Amount { samples: 0.0, ..amount(plan, point) };
    one("display".to_owned(), Some(spent.display_ms), 1, pixels);
    one(score_kind(spent.image_ms.is_some()).to_owned(), Some(spent.score_ms), 1, pixels);
    items
}

/// The work of a timed configuration.
pub fn of_timing(plan: &Plan, job: &TimingJob, record: &TimingRecord) -> Vec<Measured> {
    let parts = timed(plan, job);
    let stated: f64 = parts.iter().map(|(_, seconds)| seconds).sum();
    let slowness = median(&record.wall_ms) / 1e3 / stated;
    parts.into_iter().map(|(kind, seconds)| (kind, slowness * seconds, seconds)).collect()
}

/// What runs took on each device.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct SpeedsFile {
    /// The device of the last run.
    latest: String,
    devices: BTreeMap<String, Speeds>,
}

impl SpeedsFile {
    /// Reads the file; nothing is known if it is not there or damaged.
    pub fn read(path: &Path) -> Self {
        let bytes = read_regular(path, RECORD_BYTES_MAX).unwrap_or_default();
        serde_json::from_slice(&bytes).unwrap_or_default()
    }

    /// Name and speeds of a device, or of that of the last run.
    pub fn of(&self, device: Option<&DeviceInfo>) -> Option<(&str, &Speeds)> {
        let name = device.map_or_else(|| self.latest.clone(), name);
        self.devices.get_key_value(&name).map(|(name, speeds)| (name.as_str(), speeds))
    }

    /// Adds a run and writes the file. A folder that takes no file keeps nothing: the run itself is done.
    pub fn keep(path: &Path, device: &DeviceInfo, run: &Speeds) {
        let mut file = Self::read(path);
        let mut speeds = run.clone();
        file.latest = name(device);
        if let Some(older) = file.devices.get(&file.latest) {
            speeds.add_older(older);
        }
        file.devices.insert(file.latest.clone(), speeds);
        let _ = write_atomically(path, |writer| Ok(serde_json::to_writer_pretty(writer, &file)?));
    }
}

/// A device with its driver.
fn name(device: &DeviceInfo) -> String {
    format!("{} ({})", device.name, device.driver)
}
