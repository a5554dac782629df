//! What finished runs say. No test needs a device: runs use a renderer made of formulas.

mod answers;
mod answers_asked;
mod answers_shown;
mod answers_soundness;
pub mod page;
mod page_live;
mod published;
mod scratch;
mod slope;
mod timed_tables;
mod under_way;
