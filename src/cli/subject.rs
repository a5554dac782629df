//! The experiment of `run` and `plan`.

use super::shared::InputFlags;
use super::{Failure, log};
use clap::Args;
use splitsum::experiment::Plan;
use splitsum::experiment::config::EXACT_REFERENCES;
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
    /// Give every reference all its samples, and leave its noise in the scores (--set
    /// noise_share=0).
    #[arg(long)]
    pub exact_references: bool,
    #[command(flatten)]
    pub inputs: InputFlags,
}

impl Subject {
    pub fn plan(&self) -> Result<Plan, Failure> {
        let mut overrides = self.overrides.clone();
        if self.exact_references {
            overrides.push(EXACT_REFERENCES.to_owned());
        }
        let loaded = frozen::load(&self.experiment, &overrides, &self.inputs.options(), check);
        let (plan, note) = loaded.map_err(Failure::input)?;
        note.iter().for_each(|note| log(note));
        Ok(plan)
    }

    pub fn dir(&self, plan: &Plan) -> PathBuf {
        self.out
            .clone()
            .unwrap_or_else(|| PathBuf::from("runs").join(&plan.config.name))
    }

    pub fn nothing_to_do(&self) -> Failure {
        Failure::nothing_to_do(format!("{}: no cell is left", self.experiment.display()))
    }
}
