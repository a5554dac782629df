//! Measured over stated seconds by kind of work, kept in the cache folder for later runs.

use super::work::TIMED;
use crate::files::{RECORD_BYTES_MAX, read_regular};
use crate::pipeline::DeviceInfo;
use crate::pixels::write_atomically;
use crate::run::provenance::device_words;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The file in a cache folder.
pub const SPEEDS_FILE: &str = "speeds.json";
/// Weight of earlier runs relative to a new one.
const OLD_SHARE: f64 = 0.5;

/// Measured and stated seconds by kind.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Speeds(BTreeMap<String, [f64; 2]>);

impl Speeds {
    pub fn add(&mut self, kind: &str, taken: f64, stated: f64) {
        if !(taken.is_finite() && stated > 0.0) {
            return;
        }
        let sum = self.0.entry(kind.to_owned()).or_default();
        *sum = [sum[0] + taken, sum[1] + stated];
    }

    fn append(&mut self, other: &Self) {
        other.0.iter().for_each(|(kind, [taken, stated])| self.add(kind, *taken, *stated));
    }

    /// Measured over stated seconds of a kind, else of the same work untimed, of all kinds with its first word, or of all
    /// work; 1 if nothing is known.
    pub fn ratio(&self, kind: &str) -> f64 {
        let untimed = kind.strip_prefix(TIMED).unwrap_or(kind);
        let word = untimed.split(' ').next().unwrap_or_default();
        let likenesses: [&dyn Fn(&str) -> bool; 4] =
            [&|own| own == kind, &|own| own == untimed, &|own| own.starts_with(word), &|_| true];
        let sum = |is_alike: &&dyn Fn(&str) -> bool| {
            let own = self.0.iter().filter(|(own, _)| is_alike(own)).map(|(_, sum)| *sum);
            own.reduce(|a, b| [a[0] + b[0], a[1] + b[1]])
        };
        likenesses.iter().find_map(sum).map_or(1.0, |[taken, stated]| taken / stated)
    }
}

/// The speeds of runs by device.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct SpeedsFile {
    /// The device of the last run.
    latest: String,
    devices: BTreeMap<String, Speeds>,
}

impl SpeedsFile {
    /// Reads the file; empty if it does not exist or is damaged.
    pub fn read(path: &Path) -> Self {
        let bytes = read_regular(path, RECORD_BYTES_MAX).unwrap_or_default();
        serde_json::from_slice(&bytes).unwrap_or_default()
    }

    /// Name and speeds of `device`; by default of the last run's device.
    pub fn of(&self, device: Option<&DeviceInfo>) -> Option<(&str, &Speeds)> {
        let name = device.map_or_else(|| self.latest.clone(), name);
        self.devices.get_key_value(&name).map(|(name, speeds)| (name.as_str(), speeds))
    }

    /// Adds a run and writes the file. Errors are ignored: the run itself is done.
    pub fn keep(path: &Path, device: &DeviceInfo, run: &Speeds) {
        let mut file = Self::read(path);
        file.latest = name(device);
        let speeds = file.devices.entry(file.latest.clone()).or_default();
        speeds.0.values_mut().for_each(|sum| *sum = sum.map(|seconds| OLD_SHARE * seconds));
        speeds.append(run);
        let _ = write_atomically(path, |writer| Ok(serde_json::to_writer_pretty(writer, &file)?));
    }
}

fn name(device: &DeviceInfo) -> String {
    device_words(&device.name, &device.driver)
}
