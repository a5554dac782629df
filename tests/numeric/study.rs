//! What finished runs say. No test needs a device: runs use a renderer made of formulas.

mod asked;
mod estimate;
mod figure;
mod finished;
mod frame;
mod made;
pub mod page;
mod page_live;
mod published;
mod questions;
mod sources;
mod told;
mod under_way;
