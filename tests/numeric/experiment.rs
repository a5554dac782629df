//! Experiment files, plans and runs. No test needs a device: runs use a renderer made of formulas.

mod answers;
mod answers_soundness;
mod chunk;
mod config;
pub mod fake;
mod host;
mod plan;
mod run;
mod statistics;
