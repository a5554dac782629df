//! Experiments: a file, its plan, its run.
//!
//! `config` reads what is written, `plan` makes it into checked cells, `run` renders and scores them.

pub mod axis;
pub mod config;
pub mod fault;
pub mod inputs;
pub mod plan;
pub mod value;

pub use config::Config;
pub use fault::{ConfigError, Fault};
pub use plan::{Cell, Plan};
