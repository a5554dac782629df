//! The state of the machine that can disturb times: load and clocks. It is read, never set.

use serde::{Deserialize, Serialize};
use std::path::Path;

/// In tables, for a value that the system does not report.
pub const UNKNOWN: &str = "unknown";

/// One observation. Unreported values are `None`.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct HostState {
    /// Runnable tasks over the last 1, 5 and 15 minutes.
    pub load_average: Option<Vec<f64>>,
    /// Mean clock of the processors, MHz.
    pub cpu_mhz: Option<f64>,
}

impl HostState {
    pub fn observe() -> Self {
        Self {
            load_average: std::fs::read_to_string("/proc/loadavg").ok().and_then(|text| load_average(&text)),
            cpu_mhz: cpu_mhz(Path::new("/sys/devices/system/cpu")),
        }
    }
}

/// The first three numbers of `/proc/loadavg`.
pub fn load_average(text: &str) -> Option<Vec<f64>> {
    let numbers: Vec<f64> = text.split_whitespace().take(3).filter_map(|word| word.parse().ok()).collect();
    (numbers.len() == 3).then_some(numbers)
}

/// Mean of `cpu*/cpufreq/scaling_cur_freq` (kHz) below `root`, in MHz; `None` without such files (virtual machines).
pub fn cpu_mhz(root: &Path) -> Option<f64> {
    let cpus = std::fs::read_dir(root).ok()?.flatten();
    let clock = |cpu: std::fs::DirEntry| -> Option<f64> {
        let text = std::fs::read_to_string(cpu.path().join("cpufreq/scaling_cur_freq")).ok()?;
        text.trim().parse::<f64>().ok().map(|khz| khz / 1e3)
    };
    let clocks: Vec<f64> = cpus.filter_map(clock).collect();
    (!clocks.is_empty()).then(|| clocks.iter().sum::<f64>() / clocks.len() as f64)
}

/// A device with its driver, for people.
pub fn device_words(name: &str, driver: &str) -> String {
    format!("{name} ({driver})")
}
