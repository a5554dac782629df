//! Experiments: file, axes and values (`config`), and the plan of checked cells (`plan`).

pub mod axis;
mod checks;
pub mod config;
pub mod fault;
pub mod id;
pub mod inputs;
pub mod lights;
mod number;
mod overrides;
pub mod plan;
mod ranges;
mod sections;
mod sweeps;
mod toml_tree;
pub mod value;

pub use config::Config;
pub use fault::{ConfigError, Fault};
pub use id::Id;
pub use plan::{Cell, Plan};
