//! The plan file: the chunks of an experiment and everything that must be the same where they run.
//!
//! It is made once and then only read. The same experiment, inputs, length, prices and program give the same bytes on every machine. Paths
//! in it start at its own folder, so that commands may run anywhere.

use super::ChunkError;
use super::prices::Prices;
use super::split::{Chunk, split};
use crate::environment::LoadOptions;
use crate::experiment::plan::{Plan, SCHEMA_VERSION, Source};
use crate::files::{PLAN_BYTES_MAX, TEXT_BYTES_MAX, read_regular, read_text, relative};
use crate::metrics::METRICS;
use crate::run::frozen;
use crate::run::provenance::experiment_hash;
use crate::run::store::Store;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The file's own word for its format.
const FORMAT: &str = "splitsum-plan";
/// Counts up when the file or the way of cutting changes.
const FORMAT_VERSION: u32 = 3;
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
    /// Relative to the folder of the plan file.
    experiment_file: String,
    experiment_hash: String,
    overrides: Vec<String>,
    /// The folder that files named by `--set` are relative to, itself relative to that of the plan file; none where no override names a file.
    set_folder: Option<String>,
    /// Content hash of every environment and scene.
    inputs: BTreeMap<String, String>,
    plan_hash: String,
    pub chunk_seconds: f64,
    /// Prices of the work.
    pub prices: Prices,
    pub chunks: Vec<Chunk>,
}

/// The part that is read first: another version may hold anything else.
#[derive(Deserialize)]
struct Head {
    format: Option<String>,
    format_version: Option<u32>,
}

impl PlanFile {
    /// Cuts a plan into chunks of about `chunk_seconds` at `prices`, for a plan file in the folder `dir`.
    pub fn new(plan: &Plan, dir: &Path, chunk_seconds: f64, prices: Prices) -> Self {
        let experiment_file = relative(dir, &plan.config.path);
        let set_folder = plan.config.set_files_dir().map(|folder| relative(dir, folder));
        Self::with_paths(plan, experiment_file, set_folder, chunk_seconds, prices)
    }

    fn with_paths(
        plan: &Plan,
        experiment_file: String,
        set_folder: Option<String>,
        chunk_seconds: f64,
        prices: Prices,
    ) -> Self {
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
            experiment_file,
            experiment_hash: experiment_hash(&plan.config.text),
            overrides: plan.config.overrides.clone(),
            set_folder,
            inputs: plan.inputs.hashes().into_iter().collect(),
            plan_hash: plan.hash.clone(),
            chunk_seconds,
            chunks: split(plan, chunk_seconds, &prices),
            prices,
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

    /// Writes the file in one step; one that has this content already is left untouched. A plan file is made once: one of another plan is
    /// not replaced, because chunks that are under way belong to it and would be left without.
    pub fn write(&self, path: &Path) -> Result<(), ChunkError> {
        let old = read_regular(path, PLAN_BYTES_MAX).unwrap_or_default();
        let head = serde_json::from_slice::<Head>(&old);
        if head.is_ok_and(|head| head.format.as_deref() == Some(FORMAT)) && old != self.text().as_bytes() {
            let what = "holds another plan; remove it, or give another name with --out".to_owned();
            return Err(ChunkError::PlanFile { path: path.to_owned(), what });
        }
        Ok(Store::at(Path::new("")).write_text(path, &self.text())?)
    }

    /// Reads a plan file and the experiment it was made from, and checks that program, experiment and inputs are still those.
    pub fn load(path: &Path) -> Result<(Self, Plan), ChunkError> {
        let fault = |what: String| ChunkError::PlanFile { path: path.to_owned(), what };
        let again = "make the plan again (splitsum plan EXPERIMENT --chunk-seconds S --out FILE)";
        let expected = "expected a file that `splitsum plan --chunk-seconds` wrote";
        let text =
            read_text(path, PLAN_BYTES_MAX).map_err(|error| fault(format!("cannot be read ({error}); {expected}")))?;
        let head = serde_json::from_str::<Head>(&text).ok();
        let Some(head) = head.filter(|head| head.format.as_deref() == Some(FORMAT)) else {
            return Err(fault(format!("is not a plan file; {expected}")));
        };
        if head.format_version != Some(FORMAT_VERSION) {
            let found = head.format_version.map_or("none".to_owned(), |version| version.to_string());
            return Err(fault(format!("has format version {found}, this program reads {FORMAT_VERSION}; {again}")));
        }
        let file: Self = serde_json::from_str(&text).map_err(|error| fault(format!("{error}; {expected}")))?;
        let stale = |what: String| fault(format!("{what}; {again}"));
        if (&*file.program_version, file.schema_version) != (env!("CARGO_PKG_VERSION"), SCHEMA_VERSION) {
            return Err(stale(format!(
                "was made by splitsum {}, this is {}",
                file.program_version,
                env!("CARGO_PKG_VERSION")
            )));
        }
        if file.shader_hash != crate::gpu::build_hash() {
            return Err(stale("was made by a build with other shaders, whose images may differ".to_owned()));
        }
        let dir = path.parent().unwrap_or(Path::new(""));
        let experiment = &dir.join(&file.experiment_file);
        let name = experiment.display();
        let written = read_text(experiment, TEXT_BYTES_MAX).map_err(|error| {
            fault(format!(
                "its experiment {name} cannot be read ({error}); expected it there, since paths in a plan file start at its own folder: use the \
                 file where it was made, or {again}"
            ))
        })?;
        if experiment_hash(&written) != file.experiment_hash {
            return Err(stale(format!("{name} has changed since the plan was made")));
        }
        let set_dir = file.set_folder.as_ref().map_or_else(PathBuf::new, |folder| dir.join(folder));
        let file_dir = frozen::file_dir(experiment, &written);
        let (text, overrides, file_dir, set_dir) = (&written, &file.overrides, file_dir.as_deref(), &set_dir);
        let plan = Plan::from_source(
            &Source { path: experiment, text, overrides, file_dir, set_dir },
            &LoadOptions::default(),
        )
        .map_err(|error| fault(format!("its experiment is no longer valid: {error}")))?;
        let (experiment_file, set_folder) = (file.experiment_file.clone(), file.set_folder.clone());
        let here = Self::with_paths(&plan, experiment_file, set_folder, file.chunk_seconds, file.prices.clone());
        let input = differing(&file.inputs, &here.inputs)
            .map(|name| format!("the input {name} has changed since the plan was made"));
        let metric = || {
            differing(&file.metrics, &here.metrics)
                .map(|name| format!("was made by a build with another version of the metric {name}"))
        };
        let other = || {
            (here != file)
                .then(|| "its cells or chunks are not those that this program makes of its experiment".to_owned())
        };
        if let Some(what) = input.or_else(metric).or_else(other) {
            return Err(stale(what));
        }
        Ok((file, plan))
    }
}

/// The first name that is in one map only, or has another value there.
fn differing<T: PartialEq>(a: &BTreeMap<String, T>, b: &BTreeMap<String, T>) -> Option<String> {
    a.keys().chain(b.keys()).find(|name| a.get(*name) != b.get(*name)).cloned()
}
