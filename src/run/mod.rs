//! Renders and scores the cells of a plan into a folder of records, images and tables.
//! `crate::study` answers questions from the tables.

mod cell_fault;
pub mod columns;
pub mod companion;
pub mod environments;
pub mod estimate;
pub mod execute;
pub mod frozen;
pub mod images;
pub mod provenance;
pub mod record;
pub mod recovery;
mod reference_image;
pub mod renderer;
pub mod results;
pub mod rows;
pub mod run_table;
mod scoring;
pub mod seal;
pub mod shard;
pub mod split;
pub mod store;
pub mod tables;
pub mod timing;
pub mod timing_ratios;

pub use companion::Companions;
pub use execute::{MakeRenderer, Merged, Outcome, Progress, RunError, RunOptions, merge, run};
pub use images::{STANDARD_ERROR_LAYER, file_words, write_radiance};
pub use renderer::{RenderFault, Renderer, Served};
