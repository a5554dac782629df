//! The experiment that a run froze: its text, byte for byte, beside a provenance that says in which folder the files it names are and which
//! `--set` texts took part. So the file in a run's folder can be run again as it stands.

use super::provenance::{self, experiment_hash};
use crate::environment::LoadOptions;
use crate::experiment::axis::AXES;
use crate::experiment::config::Config;
use crate::experiment::fault::{ConfigError, Faults, Place};
use crate::experiment::plan::{Plan, Source};
use crate::experiment::value::Kind;
use crate::files::read_given;
use crate::shade::FILE_PREFIX;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Largest experiment file, bytes.
const FILE_BYTES_MAX: u64 = 1 << 22;
/// The frozen experiment in the folder of a run.
pub const EXPERIMENT_FILE: &str = "experiment.toml";

/// Facts in the provenance about the experiment file beside it.
#[derive(Debug)]
struct Frozen {
    /// The folder that paths in the file are relative to; `None` where it names no file.
    file_dir: Option<PathBuf>,
    /// The folder that paths of `overrides` are relative to; `None` where they name no file.
    set_dir: Option<PathBuf>,
    overrides: Vec<String>,
    is_unchanged: bool,
}

impl Frozen {
    /// Of the file at `path`, where that stands in the folder of a run.
    fn beside(path: &Path, text: &str) -> Option<Self> {
        if path.file_name().is_none_or(|name| name != EXPERIMENT_FILE) {
            return None;
        }
        let dir = path.parent()?;
        // What is no provenance says nothing of the file: it is one like any other.
        let value = provenance::read(dir).ok()??;
        let folder = |key: &str| value[key].as_str().map(|folder| dir.join(folder));
        Some(Self {
            file_dir: folder(provenance::EXPERIMENT_FOLDER),
            set_dir: folder(provenance::SET_FOLDER),
            overrides: texts(&value["overrides"]),
            is_unchanged: value["experiment_hash"] == experiment_hash(text),
        })
    }
}

fn texts(list: &Value) -> Vec<String> {
    list.as_array().into_iter().flatten().filter_map(|text| Some(text.as_str()?.to_owned())).collect()
}

impl Plan {
    /// Reads, checks and expands the experiment at `path`; `overrides` are the texts of `--set`.
    pub fn load(path: &Path, overrides: &[String]) -> Result<Self, ConfigError> {
        Ok(load(path, overrides, &LoadOptions::default())?.0)
    }
}

fn text_of(bytes: Vec<u8>) -> std::io::Result<String> {
    String::from_utf8(bytes).map_err(|error| std::io::Error::new(std::io::ErrorKind::InvalidData, error))
}

/// The experiment at `path` as written, where every value of it can be read.
pub fn config(path: &Path, overrides: &[String]) -> Option<Config> {
    let text = read_given(path, FILE_BYTES_MAX).and_then(text_of).ok()?;
    let mut faults = Faults::new(path, &text);
    let config = Config::parse(path, &text, overrides, &mut faults);
    faults.is_empty().then_some(config)
}

/// Reads, checks and expands the experiment at `path`; `overrides` are the texts of `--set`. One that a run froze is run as it was then: its
/// files are found where they were, and its own `--set` texts hold for every axis that `overrides` do not name. The sentence says so.
pub fn load(path: &Path, overrides: &[String], options: &LoadOptions) -> Result<(Plan, Option<String>), ConfigError> {
    let fault = |text: &str, what: String| {
        let mut faults = Faults::new(path, text);
        faults.add(&Place::Default, what);
        faults.into_result().expect_err("one fault was added")
    };
    let text = read_given(path, FILE_BYTES_MAX)
        .and_then(text_of)
        .map_err(|error| fault("", format!("cannot be read: {error}; expected an experiment file (TOML)")))?;
    let Some(frozen) = Frozen::beside(path, &text) else {
        let source = Source { path, text: &text, overrides, file_dir: None, set_dir: Path::new("") };
        return Ok((Plan::from_source(&source, options)?, None));
    };
    if !frozen.is_unchanged {
        let what = "is the frozen experiment of a run, and was changed since (its hash in provenance.json is another); to make an experiment of \
                    it copy it to another folder";
        return Err(fault(&text, what.to_owned()));
    }
    let axis_of = |text: &String| text.split('=').next().unwrap_or_default().trim().to_owned();
    let given: Vec<String> = overrides.iter().map(axis_of).collect();
    let kept: Vec<String> = frozen.overrides.iter().filter(|text| !given.contains(&axis_of(text))).cloned().collect();
    let names_input = |texts: &[String]| {
        let may_name = |kind: &Kind, text: &str| match kind {
            Kind::Input => true,
            Kind::NameOrFile { .. } => text.contains(FILE_PREFIX),
            _ => false,
        };
        texts.iter().any(|text| AXES.iter().any(|axis| axis.name == axis_of(text) && may_name(&axis.kind, text)))
    };
    let set_dir = frozen.set_dir.filter(|_| names_input(&kept));
    if set_dir.is_some() && names_input(overrides) {
        let kept = kept.join(", ");
        let what = format!(
            "was run with --set {kept}, whose files are in another folder; expected --set of all of them, or none"
        );
        return Err(fault(&text, what));
    }
    let all: Vec<String> = kept.iter().chain(overrides).cloned().collect();
    let (file_dir, set_dir) = (frozen.file_dir.as_deref(), set_dir.as_deref());
    let source = Source { path, text: &text, overrides: &all, file_dir, set_dir: set_dir.unwrap_or(Path::new("")) };
    let plan = Plan::from_source(&source, options)?;
    let mut words: Vec<String> =
        file_dir.iter().map(|dir| format!("the files it names are in {}", dir.display())).collect();
    words.extend((!kept.is_empty()).then(|| format!("with --set {}", kept.join(" --set "))));
    words.extend(set_dir.map(|dir| format!("whose files are in {}", dir.display())));
    let path = path.display();
    let note = (!words.is_empty()).then(|| format!("{path}: taken as its run froze it: {}", words.join(", ")));
    Ok((plan, note))
}
