//! Loads experiments. The copy in a run's folder can be run again: the provenance beside it names
//! the folder of its files and its `--set` texts.

use super::provenance::{self, experiment_hash};
use crate::base::files::read_given;
use crate::experiment::config::{EXACT_REFERENCES, NOISE_SHARE_KEY};
use crate::experiment::fault::{ConfigError, Faults, Location};
use crate::experiment::plan::{Check, Plan, Source};
use crate::instrument::environment::LoadOptions;
use std::path::{Path, PathBuf};

const FILE_BYTES_MAX: u64 = 1 << 22;
/// The copy of the experiment in the folder of a run.
pub const EXPERIMENT_FILE: &str = "experiment.toml";

/// Facts about the experiment file in the provenance of its folder.
#[derive(Debug)]
struct Frozen {
    /// Base folder of paths in the file; `None` if it names no file.
    file_dir: Option<PathBuf>,
    /// Base folder of paths in `overrides`; `None` if they name no file.
    set_dir: Option<PathBuf>,
    overrides: Vec<String>,
    /// Whether its references are exact because the program had no others.
    is_older: bool,
    is_unchanged: bool,
}

impl Frozen {
    /// Facts about the file at `path`, if it is in the folder of a run.
    fn read(path: &Path, text: &str) -> Option<Self> {
        if path.file_name().is_none_or(|name| name != EXPERIMENT_FILE) {
            return None;
        }
        let dir = path.parent()?;
        // Without a valid provenance it is an ordinary file.
        let provenance = provenance::read(dir).ok()??;
        let folder = |folder: Option<String>| folder.map(|folder| dir.join(folder));
        Some(Self {
            file_dir: folder(provenance.experiment_folder),
            set_dir: folder(provenance.set_folder),
            is_older: provenance.reference.is_older(),
            overrides: provenance.overrides,
            is_unchanged: provenance.experiment_hash == experiment_hash(text),
        })
    }

    /// Fails if the copy was edited, or if both the run and the user give `--set` texts.
    fn check(&self, path: &Path, text: &str, overrides: &[String]) -> Result<(), ConfigError> {
        if !self.is_unchanged {
            let what = "is the experiment of a finished run but was edited (its hash differs from \
                        provenance.json); copy it to another folder to run it";
            return Err(fault(path, text, what.to_owned()));
        }
        if !overrides.is_empty() && !self.overrides.is_empty() {
            let what = format!(
                "was run with --set {}; give no other --set, or run the experiment that it is a \
                 copy of",
                self.overrides.join(" --set ")
            );
            return Err(fault(path, text, what));
        }
        Ok(())
    }

    /// Says what a repetition takes from its run; `None` if nothing.
    fn note(&self, path: &Path) -> Option<String> {
        let mut parts: Vec<String> = Vec::new();
        if let Some(dir) = &self.file_dir {
            parts.push(format!("the files it names are in {}", dir.display()));
        }
        if !self.overrides.is_empty() {
            parts.push(format!("with --set {}", self.overrides.join(" --set ")));
        }
        if let Some(dir) = &self.set_dir {
            parts.push(format!("whose files are in {}", dir.display()));
        }
        if self.is_older {
            parts.push("with exact references".to_owned());
        }
        let path = path.display();
        (!parts.is_empty()).then(|| format!("{path}: repeats its run: {}", parts.join(", ")))
    }
}

fn read_text(path: &Path) -> std::io::Result<String> {
    let bytes = read_given(path, FILE_BYTES_MAX)?;
    String::from_utf8(bytes)
        .map_err(|error| std::io::Error::new(std::io::ErrorKind::InvalidData, error))
}

/// A fault of a whole file.
fn fault(path: &Path, text: &str, what: String) -> ConfigError {
    let mut faults = Faults::new(path, text);
    faults.add(&Location::Default, what);
    faults.into_result().expect_err("one fault was added")
}

/// Reads, checks and expands the experiment at `path`; `overrides` are the texts of `--set`. The
/// copy of a run uses the files of that run and its `--set` texts; then there is a note for the
/// user.
pub fn load(
    path: &Path,
    overrides: &[String],
    options: &LoadOptions,
    check: Check,
) -> Result<(Plan, Option<String>), ConfigError> {
    let text = read_text(path).map_err(|error| {
        fault(
            path,
            "",
            format!("cannot be read: {error}; expected an experiment file (TOML)"),
        )
    })?;
    let Some(frozen) = Frozen::read(path, &text) else {
        let source = Source {
            check,
            ..Source::new(path, &text, overrides)
        };
        return Ok((Plan::from_source(&source, options)?, None));
    };
    frozen.check(path, &text, overrides)?;
    let mut all_overrides = if frozen.overrides.is_empty() {
        overrides.to_vec()
    } else {
        frozen.overrides.clone()
    };
    let is_share = |text: &String| {
        let key = text.split_once('=').map(|(key, _)| key.trim());
        key == Some(NOISE_SHARE_KEY)
    };
    if frozen.is_older && !all_overrides.iter().any(is_share) {
        all_overrides.push(EXACT_REFERENCES.to_owned());
    }
    let source = Source::new(path, &text, &all_overrides);
    let source = Source {
        file_dir: frozen.file_dir.as_deref(),
        set_dir: frozen.set_dir.as_deref().unwrap_or(source.set_dir),
        check,
        ..source
    };
    let plan = Plan::from_source(&source, options)?;
    Ok((plan, frozen.note(path)))
}
