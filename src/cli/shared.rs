//! Flags and checks of several commands.

use super::{Failure, warn_of_input};
use clap::{Args, ValueEnum};
use splitsum::bake::ENVIRONMENT_FORMATS;
use splitsum::bake::convention::Preset;
use splitsum::base::pixels::TexelPosition;
use splitsum::instrument::environment::{Environment, LoadOptions};
use splitsum::instrument::pipeline::{DeviceChoice, Options, Pipeline};
use splitsum::instrument::scene::Scene;
use splitsum::instrument::shade::{FILE_PREFIX, from_file};
use splitsum::run::RenderFault;
use std::path::{Path, PathBuf};

#[derive(Args, Clone, Copy, Debug)]
pub struct InputFlags {
    /// Set NaN and negative texels of environments to 0, and infinite ones to the largest finite
    /// value, with a warning. docs/bringing-maps.md names the programs that write such texels.
    #[arg(long)]
    pub clamp_invalid: bool,
    /// Say where the outermost texel centres of environment files lie: half a texel inside the map
    /// (centres), or on its edges, as in files of exrenvmap (docs/bringing-maps.md) [default: by the
    /// format].
    #[arg(long, value_name = "WHERE", value_enum)]
    pub texels: Option<Texels>,
}

/// Names of texel positions.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Texels {
    Centres,
    Edges,
}

impl From<Texels> for TexelPosition {
    fn from(texels: Texels) -> Self {
        match texels {
            Texels::Centres => Self::Centres,
            Texels::Edges => Self::Edges,
        }
    }
}

impl InputFlags {
    pub fn options(self) -> LoadOptions {
        LoadOptions {
            clamp_invalid: self.clamp_invalid,
            texels: self.texels.map(Into::into),
            more_formats: ENVIRONMENT_FORMATS,
            ..LoadOptions::default()
        }
    }

    /// Writes the flags as typed, each after a space.
    pub fn text(self) -> String {
        let clamp = if self.clamp_invalid {
            " --clamp-invalid"
        } else {
            ""
        };
        let texels = match self.texels {
            None => "",
            Some(Texels::Centres) => " --texels centres",
            Some(Texels::Edges) => " --texels edges",
        };
        format!("{clamp}{texels}")
    }

    /// Loads an environment relative to the current folder and prints its warnings.
    pub fn environment(self, name: &str) -> Result<Environment, Failure> {
        let environment =
            Environment::load(name, Path::new(""), &self.options()).map_err(Failure::input)?;
        warn_of_input(&environment.name, &environment.warnings);
        Ok(environment)
    }
}

/// Compiles a method in a file, `file:PATH`; does nothing for a listed one.
pub fn load_file_method(name: &str) -> Result<(), Failure> {
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
    Preset::open(text, Path::new(""))
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
