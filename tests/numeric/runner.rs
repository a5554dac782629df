//! Experiment files, plans and runs. No test needs a device: runs use a renderer made of formulas.

mod chunk;
mod config;
mod environments;
mod estimate;
mod extend;
pub mod fake;
mod frozen;
mod host;
mod limits;
mod plan;
pub mod resume;
pub mod run;
pub mod runs;
mod statistics;
mod strangers;
mod timed;
pub mod timing_ratios;
mod zips;
