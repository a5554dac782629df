//! What an experiment says: its file, axes and values, and the plan of checked cells.
//!
//! `config` reads the file as written; `plan` expands it into checked cells. `crate::run` renders them.

pub mod axis;
mod checks;
pub mod config;
pub mod fault;
pub mod inputs;
pub mod lights;
mod overrides;
pub mod plan;
mod sections;
mod sweeps;
mod toml_tree;
pub mod value;

pub use config::Config;
pub use fault::{ConfigError, Fault};
pub use plan::{Cell, Plan};
