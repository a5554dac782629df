//! Runs of experiments. No test needs a device: runs use a synthetic renderer.

pub mod fake;
mod forecast;
mod frozen;
mod grow;
mod references;
mod resume;
pub mod runs;
mod shards;
mod sheets;
mod timed;
pub mod timing_ratios;
mod unscored;
pub mod whole;
