//! Writes answers: files in the run's folder, the summary, the page, `results/` and blocks in
//! Markdown pages. Needs no device.

pub mod blocks;
pub mod gallery;
pub mod page;
pub mod publish;
pub mod record;
pub mod summary;
pub mod write;
