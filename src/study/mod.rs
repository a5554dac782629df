//! Answers questions from finished runs. Needs no device.

pub mod columns;
pub mod finding;
pub mod finished;
pub mod frame;
pub mod names;
pub mod questions;
pub mod table;
