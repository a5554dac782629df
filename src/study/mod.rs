//! What finished runs say: questions with their answers, figures, the page. Needs no device.

pub mod columns;
pub mod cost;
pub mod figure;
pub mod finished;
pub mod frame;
pub mod page;
pub mod publish;
pub mod questions;
pub mod record;
pub mod summary;
pub mod table;
pub mod write;
