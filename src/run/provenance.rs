//! `provenance.json`: everything that is needed to repeat a run.

use crate::base::files::{read_regular, relative};
use crate::base::names::Listed;
use crate::experiment::plan::{Plan, SCHEMA_VERSION};
use crate::instrument::pipeline::DeviceInfo;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

pub const PROVENANCE_FILE: &str = "provenance.json";
/// Key of the folder that paths in the frozen experiment are relative to, relative to the run's
/// folder; null if it names no file.
pub const EXPERIMENT_FOLDER: &str = "experiment_folder";
/// Key of the same for paths in its overrides.
pub const SET_FOLDER: &str = "set_folder";
/// Largest file, bytes; every session adds a few thousand.
const MAX_FILE_BYTES: u64 = 1 << 28;

#[derive(Debug, thiserror::Error)]
pub enum ProvenanceError {
    #[error("{}: cannot be read: {error}", path.display())]
    Io {
        path: PathBuf,
        error: std::io::Error,
    },
    #[error(
        "{}: is not a provenance file of splitsum: {what}; restore it from a copy, or choose \
         another folder",
        path.display()
    )]
    Strange { path: PathBuf, what: String },
    #[error(
        "{}: holds a run in format {found}, but this program knows formats up to {SCHEMA_VERSION}; \
         use the newer program that wrote it, or \
         choose another folder", dir.display()
    )]
    Newer { dir: PathBuf, found: u64 },
}

/// Reads the provenance of the run in a folder, an object with its format; `None` if there is no
/// file.
pub fn read(dir: &Path) -> Result<Option<Value>, ProvenanceError> {
    read_file(&dir.join(PROVENANCE_FILE))
}

/// As [`read`], for a file.
pub(super) fn read_file(path: &Path) -> Result<Option<Value>, ProvenanceError> {
    let path = path.to_owned();
    let bytes = match read_regular(&path, MAX_FILE_BYTES) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(ProvenanceError::Io { path, error }),
    };
    let value: Value = match serde_json::from_slice(&bytes) {
        Ok(value) => value,
        Err(error) => {
            return Err(ProvenanceError::Strange {
                path,
                what: error.to_string(),
            });
        }
    };
    let strange = |what: &str| {
        Err(ProvenanceError::Strange {
            path: path.clone(),
            what: what.to_owned(),
        })
    };
    match value.get("schema_version").map(Value::as_u64) {
        _ if !value.is_object() => strange("it is not an object"),
        None => strange("it has no schema_version"),
        Some(None) => strange("its schema_version is not a whole number"),
        Some(Some(found)) if found > SCHEMA_VERSION.into() => Err(ProvenanceError::Newer {
            dir: path.parent().unwrap_or(&path).to_owned(),
            found,
        }),
        Some(Some(_)) if !value.get("sessions").is_some_and(Value::is_array) => {
            strange("it has no list of sessions")
        }
        Some(Some(_)) => Ok(Some(value)),
    }
}

pub fn experiment_hash(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().to_string()
}

/// Keys of user input: the same experiment may be named differently.
const AS_TYPED: [&str; 2] = ["experiment_file", "overrides"];

/// Rewrites the provenance `found` in `dir` for `plan`, with its sessions; `None` if nothing
/// changes.
pub(super) fn of_now(found: &Value, plan: &Plan, dir: &Path) -> Option<Value> {
    let mut new = provenance(plan, dir);
    new["sessions"] = found["sessions"].clone();
    let is_same = |(key, value): (&String, &Value)| {
        AS_TYPED.contains(&key.as_str()) || found.get(key).unwrap_or(&Value::Null) == value
    };
    let is_same = new.as_object().is_some_and(|keys| keys.iter().all(is_same));
    (!is_same).then_some(new)
}

/// The provenance of a new run in the folder `dir`, without sessions.
pub fn provenance(plan: &Plan, dir: &Path) -> Value {
    let from_here = |folder: Option<&Path>| folder.map(|folder| relative(dir, folder));
    let inputs: serde_json::Map<String, Value> = plan
        .inputs
        .hashes()
        .into_iter()
        .map(|(name, hash)| (name, Value::String(hash)))
        .collect();
    json!({
        "schema_version": SCHEMA_VERSION,
        "name": plan.config.name,
        "question": plan.config.question,
        "asks": plan.config.asks.iter().map(|ask| &ask.question).collect::<Vec<_>>(),
        "metric": plan.config.metric,
        "experiment_file": plan.config.path.display().to_string(),
        "experiment_hash": experiment_hash(&plan.config.text),
        "overrides": plan.config.overrides,
        EXPERIMENT_FOLDER: from_here(plan.config.files_dir()),
        SET_FOLDER: from_here(plan.config.set_files_dir()),
        "plan_hash": plan.hash,
        "shader_hash": crate::instrument::gpu::build_hash(),
        "cell_count": plan.cells.len(),
        "excluded": plan.config.exclusions.iter().zip(&plan.excluded)
            .map(|(exclusion, count)| json!({ "why": exclusion.why, "count": count })).collect::<Vec<_>>(),
        "reference": { "method": plan.config.reference.method, "samples": plan.config.reference.samples,
            "relative_error": plan.config.reference.relative_error },
        "seed": plan.config.seed,
        "inputs": inputs,
        "environment_files": plan.environment_names.iter().map(|(file, name)| (name.clone(), json!(file)))
            .filter(|(name, file)| file != name).collect::<serde_json::Map<_, _>>(),
        "input_warnings": plan.inputs.warnings(),
        "metrics": crate::instrument::metrics::METRICS.iter().map(|metric| {
            let parameters: serde_json::Map<String, Value> =
                metric.parameters.iter().map(|(name, x)| (name.to_string(), json!(x))).collect();
            json!({ "name": metric.name, "version": metric.version, "better": metric.better.name(),
                "space": metric.space.name(), "parameters": parameters, "formula": metric.formula })
        }).collect::<Vec<_>>(),
        "sessions": [],
    })
}

/// An entry for one invocation that did work: program, device, host, time.
pub fn session(device: &DeviceInfo, command_line: &[String]) -> Value {
    json!({
        "date_utc": now_utc(),
        "command_line": command_line,
        "program_version": env!("CARGO_PKG_VERSION"),
        "program_hash": crate::instrument::pipeline::program_hash(),
        "commit": commit(),
        "device": {
            "name": device.name,
            "type": device.device_type,
            "driver": device.driver,
            "api_version": device.api_version,
            "timestamp_period_ns": device.timestamp_period_ns,
            "memory_bytes": device.memory_bytes,
        },
        "host": {
            "os": std::env::consts::OS,
            "cpu": host_cpu(),
            "cpu_count": std::thread::available_parallelism().map_or(0, usize::from),
        },
        // Replaced at the end of the run.
        "wall_s": "unknown",
    })
}

/// Commit and state of the working tree that contains the program; null if there is none.
fn commit() -> Value {
    let folder: Option<PathBuf> = std::env::current_exe()
        .ok()
        .and_then(|exe| exe.parent().map(PathBuf::from));
    let git = |arguments: &[&str]| -> Option<String> {
        let output = Command::new("git")
            .arg("-C")
            .arg(folder.as_ref()?)
            .args(arguments)
            .output()
            .ok()?;
        output
            .status
            .success()
            .then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    match git(&["rev-parse", "HEAD"]) {
        Some(hash) => {
            let changed = git(&["status", "--porcelain", "--untracked-files=no"])
                .map(|text| !text.is_empty());
            json!({ "hash": hash, "dirty": changed })
        }
        None => Value::Null,
    }
}

fn host_cpu() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// A device with its driver, for people.
pub fn device_words(name: &str, driver: &str) -> String {
    format!("{name} ({driver})")
}

/// Name of the machine; `host` if it has none.
pub fn host_name() -> String {
    let text = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let name = text
        .or_else(|| std::env::var("HOSTNAME").ok())
        .or_else(|| std::env::var("COMPUTERNAME").ok());
    name.map(|name| name.trim().to_owned())
        .filter(|name| !name.is_empty())
        .unwrap_or_else(|| "host".to_owned())
}

/// The time now: `2026-01-31T23:59:59Z`.
pub fn now_utc() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}
