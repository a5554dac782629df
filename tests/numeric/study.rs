//! What finished runs say. No test needs a device: runs use a renderer made of formulas.

mod answers;
mod answers_asked;
mod answers_shown;
mod answers_soundness;
mod asked;
mod estimate;
mod figure;
mod finished;
mod frame;
mod lights;
mod made;
pub mod page;
mod page_live;
mod paper;
mod published;
mod questions;
mod scratch;
mod sizes;
mod slope;
mod times;
mod told;
mod under_way;
