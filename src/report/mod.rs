//! Writes answers: files in the run's folder, the summary, the page, `results/` and blocks in
//! Markdown pages. Needs no device, except for the [`COMPANIONS`] of a run.

pub mod blocks;
pub mod gallery;
pub mod intermediates;
pub mod live;
pub mod page;
pub mod publish;
pub mod record;
pub mod sheets;
pub mod summary;
pub mod write;

use crate::run::Companions;

/// The files that a run makes for its report: tables and scenes of the Live view, pictures of what
/// its images are made of, contact sheets.
pub const COMPANIONS: Companions = Companions {
    plan_files: &[&live::LiveFile, &intermediates::IntermediatesFile],
    result_files: &[&sheets::ContactSheets],
};
