//! Experiments: a file, its plan, its run.
//!
//! `config` reads what is written, `plan` makes it into checked cells, `run` renders and scores them. It ends with tables; what they say is `study`'s.

pub mod axis;
mod checks;
pub mod chunk;
pub mod columns;
pub mod config;
pub mod environments;
pub mod estimate;
pub mod fault;
pub mod frozen;
pub mod host;
pub mod images;
pub mod inputs;
pub mod lights;
pub mod live;
pub mod live_model;
mod overrides;
pub mod plan;
pub mod provenance;
pub mod record;
pub mod renderer;
pub mod rows;
pub mod run;
mod scoring;
pub mod seal;
mod sections;
pub mod sheets;
pub mod statistics;
pub mod store;
mod sweeps;
pub mod tables;
pub mod timing;
pub mod timing_ratios;
mod toml_tree;
pub mod trace;
pub mod value;

pub use config::Config;
pub use fault::{ConfigError, Fault};
pub use images::{STANDARD_ERROR_LAYER, file_words, write_radiance};
pub use plan::{Cell, Plan};
pub use renderer::{RenderFault, Renderer};
pub use run::{MakeRenderer, Outcome, Progress, RunError, RunOptions, Work, run};
