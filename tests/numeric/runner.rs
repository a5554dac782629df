//! Experiment files, plans and runs. No test needs a device: runs use a renderer made of formulas.

mod asks;
mod chunk;
mod config;
mod environments;
mod estimate;
mod extend;
pub mod fake;
mod frozen;
mod host;
mod limits;
mod names;
mod plan;
mod resume;
pub mod run;
pub mod runs;
mod statistics;
mod timed;
pub mod timing_ratios;
mod written;
mod zips;
