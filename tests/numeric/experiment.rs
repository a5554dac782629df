//! Experiment files and plans.

mod config;
mod lights;
mod limits;
mod names;
mod plan;
mod zips;

use splitsum::experiment::{ConfigError, Plan};
use std::path::Path;

/// The plan of an experiment `e.toml` with these `--set`s, or its faults.
fn planned(text: &str, set: &[&str]) -> Result<Plan, ConfigError> {
    let set: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
    Plan::from_text(Path::new("e.toml"), text, &set)
}
