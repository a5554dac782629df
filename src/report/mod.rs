//! Writes answers: files in the run's folder, the summary, the page, `results/` and the blocks in `README.md`. Needs no device.

pub mod page;
pub mod publish;
pub mod record;
pub mod summary;
pub mod write;
