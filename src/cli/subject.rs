//! The experiment of `run` and `plan`.

use super::shared::InputFlags;
use super::{Failure, log};
use clap::Args;
use splitsum::experiment::{ConfigError, Plan};
use splitsum::run::frozen;
use splitsum::study::questions::check;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub struct Subject {
    /// Read this experiment file.
    pub experiment: PathBuf,
    /// Keep the run in DIR [default: runs/NAME].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace an axis's values (axis=v1,v2).
    #[arg(long = "set", value_name = "AXIS=VALUES")]
    pub overrides: Vec<String>,
    #[command(flatten)]
    pub inputs: InputFlags,
}

impl Subject {
    pub fn plan(&self) -> Result<Plan, Failure> {
        let loaded = frozen::load(&self.experiment, &self.overrides, &self.inputs.options());
        let (plan, note) = loaded.map_err(|error| Failure::input(self.with_asks(error)))?;
        check(&plan.config).map_err(Failure::input)?;
        note.iter().for_each(|note| log(note));
        Ok(plan)
    }

    /// Adds faults of the questions, so that one check does not hide the other.
    fn with_asks(&self, error: ConfigError) -> ConfigError {
        let Some(config) = frozen::config(&self.experiment, &self.overrides) else { return error };
        match check(&config) {
            Err(asks) if error.faults.iter().all(|fault| !asks.faults.contains(fault)) => error.and(asks),
            _ => error,
        }
    }

    pub fn dir(&self, plan: &Plan) -> PathBuf {
        self.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(&plan.config.name))
    }

    pub fn nothing_to_do(&self) -> Failure {
        Failure::nothing_to_do(format!("{}: no cell is left", self.experiment.display()))
    }
}
