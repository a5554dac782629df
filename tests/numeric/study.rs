//! Answers from finished runs. No test needs a device: runs use a synthetic renderer.

mod asked;
mod break_even;
pub mod estimate;
mod experiments;
mod figure;
mod finished;
mod frame;
mod lights;
mod naming;
pub mod page;
mod page_intermediates;
mod page_live;
mod paper;
mod pictures;
mod published;
mod questions;
mod readable;
mod sentences;
mod steps;
mod tables;
mod times;
mod weights;
