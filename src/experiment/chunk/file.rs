//! The plan file: the chunks of an experiment and everything that must be the same where they run.
//!
//! It is made once and then only read. The same experiment, inputs, length and program give the same bytes on every machine.

use super::ChunkError;
use super::cost::Rates;
use super::split::{Chunk, split};
use crate::experiment::plan::{Plan, SCHEMA_VERSION};
use crate::experiment::store::{Store, StoreError};
use crate::files::{PLAN_BYTES_MAX, TEXT_BYTES_MAX, read_text};
use crate::metrics::METRICS;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// What the file says it is.
const FORMAT: &str = "splitsum-plan";
/// Counts up when the file or the way of cutting changes.
const FORMAT_VERSION: u32 = 1;
/// Hex digits of [`PlanFile::id`].
const ID_LENGTH: usize = 16;

/// The content of a plan file.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PlanFile {
    format: String,
    format_version: u32,
    program_version: String,
    schema_version: u32,
    shader_hash: String,
    /// Version of each metric.
    metrics: BTreeMap<String, u32>,
    pub name: String,
    /// As it was given: relative to the folder in which the commands run.
    experiment_file: String,
    experiment_hash: String,
    overrides: Vec<String>,
    /// Content hash of every environment and scene.
    inputs: BTreeMap<String, String>,
    plan_hash: String,
    pub chunk_seconds: f64,
    /// What the costs were reckoned with.
    pub rates: Rates,
    pub chunks: Vec<Chunk>,
}

/// The part that is read first: another version may hold anything else.
#[derive(Deserialize)]
struct Head {
    format: Option<String>,
    format_version: Option<u32>,
}

impl PlanFile {
    /// Cuts a plan into chunks of about `chunk_seconds` at `rates`.
    pub fn new(plan: &Plan, chunk_seconds: f64, rates: Rates) -> Self {
        // `./x.toml` and `x.toml` are one file.
        let path: PathBuf = plan.config.path.components().filter(|part| *part != Component::CurDir).collect();
        Self {
            format: FORMAT.to_owned(),
            format_version: FORMAT_VERSION,
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            schema_version: SCHEMA_VERSION,
            shader_hash: crate::gpu::build_hash().to_owned(),
            metrics: METRICS
                .iter()
                .map(|metric| metric.description())
                .map(|d| (d.name.to_owned(), d.version))
                .collect(),
            name: plan.config.name.clone(),
            experiment_file: path.display().to_string(),
            experiment_hash: experiment_hash(&plan.config.text),
            overrides: plan.config.overrides.clone(),
            inputs: plan.inputs.hashes().into_iter().collect(),
            plan_hash: plan.hash.clone(),
            chunk_seconds,
            rates,
            chunks: split(plan, chunk_seconds, &rates),
        }
    }

    /// The file's text.
    pub fn text(&self) -> String {
        // Every field has a text form and every key is a string.
        serde_json::to_string_pretty(self).expect("a plan file can be written") + "\n"
    }

    /// Names this plan file, chunks included.
    pub fn id(&self) -> String {
        blake3::hash(self.text().as_bytes()).to_hex()[..ID_LENGTH].to_owned()
    }

    /// Writes the file in one step; one that has this content already is left untouched.
    pub fn write(&self, path: &Path) -> Result<(), StoreError> {
        Store::at(Path::new("")).write_text(path, &self.text())
    }

    /// Reads a plan file and the experiment it was made from, and checks that program, experiment and inputs are still those.
    pub fn load(path: &Path) -> Result<(Self, Plan), ChunkError> {
        let fault = |what: String| ChunkError::PlanFile { path: path.to_owned(), what };
        let again = "make the plan again (splitsum plan EXPERIMENT --chunk-seconds S --out FILE)";
        let expected = "expected a file that `splitsum plan --chunk-seconds` wrote";
        let text =
            read_text(path, PLAN_BYTES_MAX).map_err(|error| fault(format!("cannot be read ({error}); {expected}")))?;
        let head: Head = serde_json::from_str(&text).map_err(|error| fault(format!("{error}; {expected}")))?;
        if head.format.as_deref() != Some(FORMAT) {
            return Err(fault(format!("is not a plan file; {expected}")));
        }
        if head.format_version != Some(FORMAT_VERSION) {
            let found = head.format_version.map_or("none".to_owned(), |version| version.to_string());
            return Err(fault(format!("has format version {found}, this program reads {FORMAT_VERSION}; {again}")));
        }
        let file: Self = serde_json::from_str(&text).map_err(|error| fault(format!("{error}; {expected}")))?;
        let changed = |what: String| fault(format!("{what}; {again}"));
        if file.program_version != env!("CARGO_PKG_VERSION") || file.schema_version != SCHEMA_VERSION {
            let (planned, here) = (&file.program_version, env!("CARGO_PKG_VERSION"));
            return Err(changed(format!(
                "was made by splitsum {planned} (schema {}), this is {here} (schema {SCHEMA_VERSION})",
                file.schema_version
            )));
        }
        if file.shader_hash != crate::gpu::build_hash() {
            return Err(changed("was made by a build with other shaders, whose images may differ".to_owned()));
        }
        let experiment = Path::new(&file.experiment_file);
        let written = read_text(experiment, TEXT_BYTES_MAX).map_err(|error| {
            let name = experiment.display();
            fault(format!(
                "its experiment {name} cannot be read ({error}); run this in the folder where the plan was made"
            ))
        })?;
        if experiment_hash(&written) != file.experiment_hash {
            return Err(changed(format!("{} has changed since the plan was made", experiment.display())));
        }
        let plan = Plan::from_text(experiment, &written, &file.overrides)
            .map_err(|error| fault(format!("its experiment is no longer valid: {error}")))?;
        let here = Self::new(&plan, file.chunk_seconds, file.rates);
        if let Some(name) = differing(&file.inputs, &here.inputs) {
            return Err(changed(format!("the input {name} has changed since the plan was made")));
        }
        if let Some(name) = differing(&file.metrics, &here.metrics) {
            return Err(changed(format!("was made by a build with another version of the metric {name}")));
        }
        if here != file {
            return Err(changed(
                "its cells or chunks are not those that this program makes of its experiment".to_owned(),
            ));
        }
        Ok((file, plan))
    }
}

fn experiment_hash(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().to_string()
}

/// The first name that is in one map only, or has another value there.
fn differing<T: PartialEq>(a: &BTreeMap<String, T>, b: &BTreeMap<String, T>) -> Option<String> {
    a.keys().chain(b.keys()).find(|name| a.get(*name) != b.get(*name)).cloned()
}
