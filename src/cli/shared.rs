//! Flags and checks of several commands.

use super::{Failure, warn_all};
use clap::Args;
use splitsum::bake::convention::Preset;
use splitsum::base::files::{RECORD_BYTES_MAX, read_text};
use splitsum::base::names::Listed;
use splitsum::instrument::environment::{Environment, LoadOptions};
use splitsum::instrument::pipeline::{DeviceChoice, Options, Pipeline};
use splitsum::instrument::scene::Scene;
use splitsum::instrument::shade::{FILE_PREFIX, from_file};
use splitsum::run::RenderFault;
use std::path::{Path, PathBuf};

#[derive(Args, Clone, Copy, Debug)]
pub struct InputFlags {
    /// Set NaN and negative texels of environments to 0, and infinite ones to the largest finite
    /// value, with a warning.
    #[arg(long)]
    pub clamp_invalid: bool,
}

impl InputFlags {
    pub fn options(self) -> LoadOptions {
        LoadOptions {
            clamp_invalid: self.clamp_invalid,
            ..LoadOptions::default()
        }
    }

    /// Loads an environment relative to the current folder and prints its warnings.
    pub fn environment(self, name: &str) -> Result<Environment, Failure> {
        let environment =
            Environment::load(name, Path::new(""), &self.options()).map_err(Failure::input)?;
        warn_all(&environment.name, &environment.warnings);
        Ok(environment)
    }
}

/// Compiles a method in a file, `file:PATH`; does nothing for a listed one.
pub fn own_method(name: &str) -> Result<(), Failure> {
    let Some(path) = name.strip_prefix(FILE_PREFIX) else {
        return Ok(());
    };
    from_file::load(name, Path::new(""))
        .map(drop)
        .map_err(|why| {
            if Path::new(path).exists() {
                Failure::input(why)
            } else {
                Failure::input(format!(
                    "--method: {why}; expected file:PATH of your shader"
                ))
            }
        })
}

/// Finds a preset by its name, or reads it from a TOML file relative to the current folder.
pub fn preset(text: &str) -> Result<&'static Preset, String> {
    let Some(name) = text.strip_suffix(".toml") else {
        return Preset::parse(text);
    };
    let toml = read_text(Path::new(text), RECORD_BYTES_MAX)
        .map_err(|error| format!("{error}; expected a TOML file"))?;
    let mut table: toml::Table = toml::from_str(&toml).map_err(|error| error.to_string())?;
    table.entry("name").or_insert_with(|| name.into());
    Preset::from_json(serde_json::to_string(&table).map_err(|error| error.to_string())?)
}

/// Loads a scene: a name or a file relative to the current folder.
pub fn scene(name: &str) -> Result<Scene, String> {
    let is_missing = Path::new(name).extension().is_some() && !Path::new(name).exists();
    Scene::load(name, Path::new("")).map_err(|why| {
        if is_missing {
            format!("--scene: {why}; expected a file, or a name of `splitsum list scenes`")
        } else {
            why.to_string()
        }
    })
}

#[derive(Args, Clone, Copy, Debug)]
pub struct DeviceFlag {
    /// Use this device (an index of `splitsum devices`).
    #[arg(long, value_name = "N")]
    pub device: Option<usize>,
}

impl DeviceFlag {
    pub fn choice(self) -> DeviceChoice {
        self.device
            .map_or(DeviceChoice::Default, DeviceChoice::Index)
    }

    pub fn open(self) -> Result<Pipeline, RenderFault> {
        Ok(Pipeline::new(Options {
            device: self.choice(),
            ..Options::default()
        })?)
    }
}

/// Checks a file to write before the work: its extension, that its folder can be written, and that
/// it is not an input.
pub fn check_out(
    flag: &str,
    path: &Path,
    extensions: &[&str],
    inputs: impl IntoIterator<Item = PathBuf>,
) -> Result<(), Failure> {
    let fault = |text: String| Err(Failure::input(format!("{flag}: {text}")));
    let shown = path.display();
    let extension = path
        .extension()
        .map(|extension| extension.to_string_lossy().to_lowercase());
    if !extension.is_some_and(|extension| extensions.contains(&&*extension)) {
        let extensions: Vec<String> = extensions
            .iter()
            .map(|extension| format!(".{extension}"))
            .collect();
        return fault(format!(
            "{shown}: expected a name that ends in {}",
            extensions.join(" or ")
        ));
    }
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return fault(format!("there is no folder {}", folder.display()));
    }
    let Ok(file) = path.canonicalize() else {
        // Permission bits do not reveal read-only file systems.
        return match tempfile::tempfile_in(folder) {
            Ok(_) => Ok(()),
            Err(error) => fault(format!(
                "cannot write to the folder {}: {error}",
                folder.display()
            )),
        };
    };
    if inputs
        .into_iter()
        .any(|input| input.canonicalize().is_ok_and(|input| input == file))
    {
        return fault(format!(
            "{shown} is an input of this command; give another name"
        ));
    }
    if file.is_dir() {
        return fault(format!("{shown} is a folder; expected a file"));
    }
    if !file.is_file() {
        return fault(format!(
            "{shown} is a device or a pipe; expected a regular file"
        ));
    }
    match std::fs::OpenOptions::new().write(true).open(&file) {
        Ok(_) => Ok(()),
        Err(error) => fault(format!("cannot write {shown}: {error}")),
    }
}
