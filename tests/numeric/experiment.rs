//! Experiment files, plans and runs. No test needs a device: runs use a renderer made of formulas.

mod answers;
mod answers_asked;
mod answers_shown;
mod answers_soundness;
mod chunk;
mod config;
mod estimate;
mod extend;
pub mod fake;
mod frozen;
mod host;
mod limits;
mod plan;
mod resume;
mod run;
pub mod runs;
mod statistics;
mod strangers;
mod timed;
mod timed_tables;
mod under_way;
mod zips;
