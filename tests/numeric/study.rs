//! What finished runs say. No test needs a device: runs use a renderer made of formulas.

mod answers;
mod answers_asked;
mod answers_shown;
mod answers_soundness;
mod asked;
mod estimate;
mod finished;
mod frame;
mod lights;
mod made;
mod paper;
mod figure;
mod published;
mod questions;
pub mod report;
mod report_joined;
mod report_live;
mod scratch;
mod sizes;
mod times;
mod told;
mod under_way;
