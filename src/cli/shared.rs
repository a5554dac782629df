//! Flags and checks of several commands.

use super::{Failure, warn_all};
use clap::Args;
use splitsum::environment::{Environment, LoadOptions};
use splitsum::pipeline::{DeviceChoice, Options, Pipeline};
use splitsum::run::RenderFault;
use std::path::Path;

#[derive(Args, Clone, Copy, Debug)]
pub struct InputFlags {
    /// Set NaN, infinite and negative texels of environments to 0, with a warning.
    #[arg(long)]
    pub clamp_invalid: bool,
}

impl InputFlags {
    pub fn options(self) -> LoadOptions {
        LoadOptions { clamp_invalid: self.clamp_invalid, ..LoadOptions::default() }
    }

    /// Loads an environment relative to the current folder and prints its warnings.
    pub fn environment(self, name: &str) -> Result<Environment, Failure> {
        let environment = Environment::load(name, Path::new(""), &self.options()).map_err(Failure::input)?;
        warn_all(&environment.name, &environment.warnings);
        Ok(environment)
    }
}

#[derive(Args, Clone, Copy, Debug)]
pub struct DeviceFlag {
    /// Use this device (an index of `splitsum devices`).
    #[arg(long, value_name = "N")]
    pub device: Option<usize>,
}

impl DeviceFlag {
    pub fn choice(self) -> DeviceChoice {
        self.device.map_or(DeviceChoice::Default, DeviceChoice::Index)
    }

    pub fn open(self) -> Result<Pipeline, RenderFault> {
        Ok(Pipeline::new(Options { device: self.choice(), ..Options::default() })?)
    }
}

/// Returns the folder of a file to write, which must exist.
pub fn folder_of<'p>(flag: &str, path: &'p Path) -> Result<&'p Path, Failure> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(Failure::input(format!("{flag}: there is no folder {}", folder.display())));
    }
    Ok(folder)
}
