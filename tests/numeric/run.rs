//! Runs of experiments. No test needs a device: runs use a renderer made of formulas.

mod chunk;
mod environments;
mod estimate;
pub mod fake;
mod frozen;
mod grow;
mod host;
mod resume;
pub mod runs;
mod sheets;
mod statistics;
mod timed;
pub mod timing_ratios;
pub mod whole;
