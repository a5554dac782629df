//! The experiment that `run` and `plan` are given.

use super::{Failure, tell};
use clap::Args;
use splitsum::environment::LoadOptions;
use splitsum::experiment::{ConfigError, Plan};
use splitsum::run::frozen;
use splitsum::study::questions::check;
use std::path::PathBuf;

/// An experiment, narrowed or not, and the folder of its run.
#[derive(Args, Debug)]
pub struct Subject {
    /// The experiment file.
    pub experiment: PathBuf,
    /// Folder of the run; runs/NAME when left out.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replaces the values of an axis, as axis=v1,v2; of zipped axes, keeps the rows with these values. Paths are relative to the current
    /// folder.
    #[arg(long = "set", value_name = "AXIS=VALUES")]
    pub overrides: Vec<String>,
    /// Sets NaN, infinite and negative texels of environments to 0, with a warning, instead of refusing them.
    #[arg(long)]
    pub clamp_invalid: bool,
}

impl Subject {
    /// The checked experiment.
    pub fn plan(&self) -> Result<Plan, Failure> {
        let options = LoadOptions { clamp_invalid: self.clamp_invalid, ..LoadOptions::default() };
        let loaded = frozen::load(&self.experiment, &self.overrides, &options);
        let (plan, note) = loaded.map_err(|error| Failure::input(self.with_asks(error)))?;
        check(&plan.config).map_err(Failure::input)?;
        note.iter().for_each(|note| tell(note));
        Ok(plan)
    }

    /// Faults of values together, and of what such an experiment asks: one does not hide the other. Of a file that cannot be read as a
    /// whole nobody knows what it could answer.
    fn with_asks(&self, error: ConfigError) -> ConfigError {
        let Some(config) = frozen::config(&self.experiment, &self.overrides) else { return error };
        match check(&config) {
            Err(asks) if error.faults.iter().all(|fault| !asks.faults.contains(fault)) => error.and(asks),
            _ => error,
        }
    }

    /// The folder of its run.
    pub fn dir(&self, plan: &Plan) -> PathBuf {
        self.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(&plan.config.name))
    }

    /// The failure of an experiment without cells.
    pub fn nothing_to_do(&self) -> Failure {
        Failure::nothing_to_do(format!("{}: no cell is left", self.experiment.display()))
    }
}
