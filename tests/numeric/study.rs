//! What finished runs say. No test needs a device: runs use a renderer made of formulas.

mod figure;
mod finished;
mod published;
mod under_way;
