//! The state of the machine that can disturb times: load, clocks, throttling. It is read, never set.

use crate::pipeline::DeviceInfo;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::process::{Command, Stdio};

/// In tables, for a value that neither the driver nor the system reports.
pub const UNKNOWN: &str = "unknown";

/// One observation. Unreported values are `None`.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct HostState {
    /// Runnable tasks over the last 1, 5 and 15 minutes.
    pub load_average: Option<Vec<f64>>,
    /// Mean clock of the processors, MHz.
    pub cpu_mhz: Option<f64>,
    pub gpu: Option<GpuState>,
}

#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct GpuState {
    pub name: String,
    pub sm_mhz: Option<f64>,
    /// Reasons for a clock below its maximum, by name; empty for none.
    pub throttle: Option<Vec<String>>,
}

/// NVML's clock event reasons, named as in its documentation.
const REASONS: &[(u64, &str)] = &[
    (0x001, "gpu-idle"),
    (0x002, "applications-clocks-setting"),
    (0x004, "sw-power-cap"),
    (0x008, "hw-slowdown"),
    (0x010, "sync-boost"),
    (0x020, "sw-thermal-slowdown"),
    (0x040, "hw-thermal-slowdown"),
    (0x080, "hw-power-brake-slowdown"),
    (0x100, "display-clock-setting"),
];
/// Harmless reasons: an idle device, or a clock that its user chose.
const HARMLESS: &[&str] = &["gpu-idle", "applications-clocks-setting", "display-clock-setting"];

/// The reasons' field of `nvidia-smi`, which driver 535 renamed.
const QUERIES: [&str; 2] = ["clocks_event_reasons.active", "clocks_throttle_reasons.active"];

impl HostState {
    /// Observes the machine, and the clocks of `device` if `nvidia-smi` reports them.
    pub fn observe(device: &DeviceInfo) -> Self {
        Self {
            load_average: std::fs::read_to_string("/proc/loadavg").ok().and_then(|text| load_average(&text)),
            cpu_mhz: cpu_mhz(Path::new("/sys/devices/system/cpu")),
            gpu: if device.device_type == "cpu" { None } else { nvidia(&device.name) },
        }
    }

    /// Clock that times depend on, MHz: the GPU's, or the processors' for a CPU driver.
    pub fn clock_mhz(&self, device_type: &str) -> Option<f64> {
        if device_type == "cpu" { self.cpu_mhz } else { self.gpu.as_ref()?.sm_mhz }
    }

    /// Reasons for a slow GPU, separated by spaces; [`UNKNOWN`] if unreported.
    pub fn slowdown(&self) -> String {
        match self.gpu.as_ref().and_then(|gpu| gpu.throttle.as_ref()) {
            Some(reasons) => {
                let slow = reasons.iter().map(String::as_str).filter(|reason| !HARMLESS.contains(reason));
                slow.collect::<Vec<_>>().join(" ")
            }
            None => UNKNOWN.to_owned(),
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

/// Queries NVIDIA's own tool, if it is installed.
fn nvidia(name: &str) -> Option<GpuState> {
    QUERIES.iter().find_map(|reasons| {
        let fields = format!("name,clocks.sm,{reasons}");
        let mut command = Command::new("nvidia-smi");
        command.arg(format!("--query-gpu={fields}")).arg("--format=csv,noheader,nounits").stderr(Stdio::null());
        let output = command.output().ok().filter(|output| output.status.success())?;
        parse_nvidia(&String::from_utf8_lossy(&output.stdout), name)
    })
}

/// Finds the GPU `name` in the lines of `nvidia-smi --format=csv,noheader,nounits`: name, SM clock (MHz), reasons (hexadecimal). `None` if
/// not exactly one line fits.
pub fn parse_nvidia(text: &str, name: &str) -> Option<GpuState> {
    let gpus = text.lines().filter_map(|line| {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let [found, sm_mhz, reasons] = fields[..] else { return None };
        // An unreported field reads [N/A] or [Not Supported].
        let sm_mhz = sm_mhz.parse().ok();
        let bits = reasons.strip_prefix("0x").and_then(|digits| u64::from_str_radix(digits, 16).ok());
        let words = |bits: u64| {
            let set = REASONS.iter().filter(|(bit, _)| bits & bit != 0);
            set.map(|(_, reason)| (*reason).to_owned()).collect()
        };
        Some(GpuState { name: found.to_owned(), sm_mhz, throttle: bits.map(words) })
    });
    let mut named = gpus.filter(|gpu| gpu.name == name);
    named.next().filter(|_| named.next().is_none())
}

/// A device with its driver, for people.
pub fn device_words(name: &str, driver: &str) -> String {
    format!("{name} ({driver})")
}
