//! What finished runs say: questions with their answers. Needs no device.

pub mod columns;
pub mod finished;
pub mod frame;
pub mod names;
pub mod questions;
pub mod table;
