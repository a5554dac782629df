//! What finished runs say. No test needs a device: runs use a renderer made of formulas.

mod answers;
mod answers_asked;
mod answers_shown;
mod answers_soundness;
mod lights;
mod paper;
mod published;
pub mod report;
mod report_joined;
mod report_live;
mod scratch;
mod timed_tables;
mod under_way;
