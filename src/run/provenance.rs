//! `provenance.json`: everything that is needed to repeat a run.

use super::columns::UNSCORED;
use crate::base::files::{read_regular, relative};
use crate::base::names::Listed;
use crate::experiment::config::Config;
use crate::experiment::plan::{Plan, SCHEMA_VERSION};
use crate::instrument::gpu::{build_hash, has_edited_shaders};
use crate::instrument::metrics::{METRICS, Metric, NoiseUse};
use crate::instrument::pipeline::DeviceInfo;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use std::collections::BTreeMap;
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

/// A JSON object of keys that this program does not know.
type UnknownKeys = serde_json::Map<String, Value>;

/// The whole file. Keys that an older program did not write have their defaults.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Provenance {
    /// Format of the run's folder, [`SCHEMA_VERSION`].
    pub schema_version: u64,
    pub name: String,
    pub question: String,
    /// Names of the questions to answer, the leading one first.
    pub asks: Vec<String>,
    /// Name of the metric of the answers.
    pub metric: String,
    /// As the user typed it.
    pub experiment_file: String,
    /// Of the text of the experiment: [`experiment_hash`].
    pub experiment_hash: String,
    /// The texts of `--set`, as the user typed them.
    pub overrides: Vec<String>,
    /// Folder that paths in the frozen experiment are relative to, relative to the run's folder;
    /// `None` if it names no file.
    pub experiment_folder: Option<String>,
    /// The same for paths in `overrides`.
    pub set_folder: Option<String>,
    pub plan_hash: String,
    pub shader_hash: String,
    /// Planned cells.
    pub cell_count: u64,
    pub excluded: Vec<ExclusionRecord>,
    pub reference: ReferenceSettings,
    pub seed: u64,
    /// Hash of the content by the name of each environment, scene and method file.
    pub inputs: BTreeMap<String, String>,
    /// File of each environment by its name in tables, where they differ.
    pub environment_files: BTreeMap<String, String>,
    pub input_warnings: Vec<String>,
    pub metrics: Vec<MetricRecord>,
    /// Invocations that did work, by date.
    pub sessions: Vec<Session>,
    #[serde(flatten)]
    pub unknown: UnknownKeys,
}

/// An `[[exclude]]` of the experiment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExclusionRecord {
    pub why: String,
    /// Combinations that it left out.
    pub count: u64,
}

/// `[reference]` of the experiment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ReferenceSettings {
    /// [`UNSCORED`] without references.
    pub method: String,
    /// Largest noise over the error of each image, both as mean squares; 0 for exact references.
    /// `None` in runs of older programs, whose references are exact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_share: Option<f64>,
    /// Requested relative standard error.
    pub relative_error: Option<f64>,
    /// Samples per pixel, at most.
    pub samples: u64,
}

impl ReferenceSettings {
    fn new(config: &Config) -> Self {
        if !config.is_scored {
            return Self {
                method: UNSCORED.to_owned(),
                ..Self::default()
            };
        }
        Self {
            method: config.reference.method.clone(),
            noise_share: Some(config.reference.noise_share().unwrap_or(0.0)),
            relative_error: config.reference.relative_error,
            samples: config.reference.samples.into(),
        }
    }

    /// The largest noise over the error of each image; `None` for exact references.
    pub fn largest_share(&self) -> Option<f64> {
        self.noise_share.filter(|share| *share > 0.0)
    }

    /// Whether a program that had exact references alone made the run.
    pub fn is_older(&self) -> bool {
        self.noise_share.is_none() && self.method != UNSCORED
    }

    /// What answers do with the noise floors.
    pub fn noise_use(&self) -> NoiseUse {
        NoiseUse::of_share(self.largest_share())
    }
}

/// A metric as the program defined it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MetricRecord {
    pub name: String,
    pub version: u64,
    pub better: String,
    pub space: String,
    /// Constants of the formula.
    pub parameters: BTreeMap<String, f64>,
    pub formula: String,
}

impl MetricRecord {
    fn new(metric: &Metric) -> Self {
        Self {
            name: metric.name.to_owned(),
            version: metric.version.into(),
            better: metric.better.name().to_owned(),
            space: metric.space.name().to_owned(),
            parameters: metric
                .parameters
                .iter()
                .map(|(name, value)| (name.to_string(), *value))
                .collect(),
            formula: metric.formula.to_owned(),
        }
    }
}

/// An invocation that did work: program, device, host, time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Session {
    /// Start: `2026-01-31T23:59:59Z`.
    pub date_utc: String,
    pub command_line: Vec<String>,
    pub plan_hash: String,
    /// `I/N` of `--shard`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shard: Option<String>,
    pub program_version: String,
    /// `None` if the program's file cannot be read.
    pub program_hash: Option<String>,
    /// `None` if no repository contains the program.
    pub commit: Option<Commit>,
    /// Whether shaders of a folder were in use that are not the program's.
    #[serde(rename = "edited_shaders", skip_serializing_if = "std::ops::Not::not")]
    pub has_edited_shaders: bool,
    pub device: SessionDevice,
    pub host: Host,
    /// Time from start to end, s; `None`, written as `unknown`, until it ends.
    #[serde(serialize_with = "write_wall", deserialize_with = "read_wall")]
    pub wall_s: Option<f64>,
    #[serde(flatten)]
    pub unknown: UnknownKeys,
}

/// The state of the repository that contains the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Commit {
    pub hash: String,
    /// Whether tracked files were changed; `None` if git did not say.
    #[serde(rename = "dirty")]
    pub is_dirty: Option<bool>,
}

/// As in [`DeviceInfo`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SessionDevice {
    pub name: String,
    #[serde(rename = "type")]
    pub device_type: String,
    pub driver: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<String>,
    pub api_version: String,
    pub timestamp_period_ns: f64,
    pub memory_bytes: u64,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Host {
    /// Of shards only: several machines may share the work.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    pub os: String,
    /// Name of the processor, on Linux.
    pub cpu: Option<String>,
    pub cpu_count: u64,
}

/// The word of the file for a session that has not ended.
const UNKNOWN_WALL: &str = "unknown";

fn write_wall<S: Serializer>(wall_s: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    match wall_s {
        Some(seconds) => serializer.serialize_f64(*seconds),
        None => serializer.serialize_str(UNKNOWN_WALL),
    }
}

fn read_wall<'d, D: Deserializer<'d>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    Ok(Value::deserialize(deserializer)?.as_f64())
}

/// Reads the provenance of the run in a folder; `None` if there is no file.
pub fn read(dir: &Path) -> Result<Option<Provenance>, ProvenanceError> {
    read_file(&dir.join(PROVENANCE_FILE))
}

/// As [`read`], for a file.
pub(super) fn read_file(path: &Path) -> Result<Option<Provenance>, ProvenanceError> {
    let bytes = match read_regular(path, MAX_FILE_BYTES) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => {
            return Err(ProvenanceError::Io {
                path: path.to_owned(),
                error,
            });
        }
    };
    let strange = |what: String| ProvenanceError::Strange {
        path: path.to_owned(),
        what,
    };
    let value: Value =
        serde_json::from_slice(&bytes).map_err(|error| strange(error.to_string()))?;
    let version = checked_version(&value).map_err(|what| strange(what.to_owned()))?;
    if version > SCHEMA_VERSION.into() {
        return Err(ProvenanceError::Newer {
            dir: path.parent().unwrap_or(path).to_owned(),
            found: version,
        });
    }
    if !value.get("sessions").is_some_and(Value::is_array) {
        return Err(strange("it has no list of sessions".to_owned()));
    }
    serde_json::from_value(value)
        .map(Some)
        .map_err(|error| strange(error.to_string()))
}

/// The format of a provenance file, or what is wrong with it.
fn checked_version(value: &Value) -> Result<u64, &'static str> {
    if !value.is_object() {
        return Err("it is not an object");
    }
    let version = value
        .get("schema_version")
        .ok_or("it has no schema_version")?;
    version
        .as_u64()
        .ok_or("its schema_version is not a whole number")
}

pub fn experiment_hash(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().to_string()
}

impl Provenance {
    /// The provenance of a new run in the folder `dir`, without sessions.
    pub fn new(plan: &Plan, dir: &Path) -> Self {
        let config = &plan.config;
        let excluded = config.exclusions.iter().zip(&plan.excluded);
        let environment_files = plan
            .environment_names
            .iter()
            .filter(|(file, name)| file != name)
            .map(|(file, name)| (name.clone(), file.clone()));
        Self {
            schema_version: SCHEMA_VERSION.into(),
            name: config.name.clone(),
            question: config.question.clone(),
            asks: config.asks.iter().map(|ask| ask.question.clone()).collect(),
            metric: config.metric.to_owned(),
            experiment_file: config.path.display().to_string(),
            experiment_hash: experiment_hash(&config.text),
            overrides: config.overrides.clone(),
            experiment_folder: config.files_dir().map(|folder| relative(dir, folder)),
            set_folder: config.set_files_dir().map(|folder| relative(dir, folder)),
            plan_hash: plan.hash.clone(),
            shader_hash: build_hash().to_owned(),
            cell_count: plan.cells.len() as u64,
            excluded: excluded
                .map(|(exclusion, count)| ExclusionRecord {
                    why: exclusion.why.clone(),
                    count: *count as u64,
                })
                .collect(),
            reference: ReferenceSettings::new(config),
            seed: config.seed.into(),
            inputs: plan.inputs.hashes().into_iter().collect(),
            environment_files: environment_files.collect(),
            input_warnings: plan.inputs.warnings(),
            metrics: METRICS.iter().copied().map(MetricRecord::new).collect(),
            sessions: Vec::new(),
            unknown: UnknownKeys::new(),
        }
    }

    /// The provenance of the same folder `dir` for `plan`, with the sessions of this one; `None` if
    /// only user input differs, since the same experiment may be named differently.
    pub(super) fn updated(&self, plan: &Plan, dir: &Path) -> Option<Self> {
        let new = Self {
            sessions: self.sessions.clone(),
            ..Self::new(plan, dir)
        };
        let as_named_before = Self {
            experiment_file: self.experiment_file.clone(),
            overrides: self.overrides.clone(),
            unknown: self.unknown.clone(),
            ..new.clone()
        };
        (as_named_before != *self).then_some(new)
    }

    /// As in the file, which sorts the keys of objects.
    pub fn to_json(&self) -> Value {
        serde_json::to_value(self).expect("JSON can hold text, numbers and lists")
    }

    pub fn last_session(&self) -> Option<&Session> {
        self.sessions.last()
    }
}

impl Session {
    /// A session that starts now, for a plan with this hash.
    pub(super) fn new(device: &DeviceInfo, command_line: &[String], plan_hash: &str) -> Self {
        Self {
            date_utc: now_utc(),
            command_line: command_line.to_vec(),
            plan_hash: plan_hash.to_owned(),
            shard: None,
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            program_hash: crate::instrument::pipeline::program_hash().map(str::to_owned),
            commit: Commit::of_program(),
            has_edited_shaders: has_edited_shaders(),
            device: SessionDevice {
                name: device.name.clone(),
                device_type: device.device_type.to_owned(),
                driver: device.driver.clone(),
                target: device.target.clone(),
                api_version: device.api_version.clone(),
                timestamp_period_ns: device.timestamp_period_ns.into(),
                memory_bytes: device.memory_bytes,
            },
            host: Host {
                name: None,
                os: std::env::consts::OS.to_owned(),
                cpu: host_cpu(),
                cpu_count: std::thread::available_parallelism().map_or(0, usize::from) as u64,
            },
            wall_s: None,
            unknown: UnknownKeys::new(),
        }
    }
}

impl Session {
    /// Whether the code that ran is not the commit's.
    pub fn has_changes(&self) -> bool {
        let commit = self.commit.as_ref();
        self.has_edited_shaders || commit.is_some_and(|commit| commit.is_dirty == Some(true))
    }
}

impl Commit {
    /// The checked-out commit of the working tree that contains the program.
    fn of_program() -> Option<Self> {
        let program = std::env::current_exe().ok()?;
        let folder = program.parent()?;
        let hash = git(folder, &["rev-parse", "HEAD"])?;
        let changes = git(folder, &["status", "--porcelain", "--untracked-files=no"]);
        Some(Self {
            hash,
            is_dirty: changes.map(|text| !text.is_empty()),
        })
    }
}

/// What git prints in `folder`; `None` if it fails.
fn git(folder: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new("git")
        .arg("-C")
        .arg(folder)
        .args(arguments)
        .output()
        .ok()?;
    output
        .status
        .success()
        .then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

fn host_cpu() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// A device with its driver, and the processor that the driver compiles for, for people.
pub fn device_words(name: &str, driver: &str, target: Option<&str>) -> String {
    match target {
        Some(target) => format!("{name} ({driver}; {target})"),
        None => format!("{name} ({driver})"),
    }
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
