//! What finished runs say. No test needs a device: runs use a renderer made of formulas.

mod answers;
mod answers_asked;
mod answers_shown;
mod answers_soundness;
mod asked;
mod estimate;
mod finished;
mod frame;
mod made;
mod published;
mod questions;
pub mod report;
mod report_joined;
mod report_live;
mod timed_tables;
mod told;
mod under_way;
