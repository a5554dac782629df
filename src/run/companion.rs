//! Files that a caller adds to the folder of a run, such as pictures of the finished cells.
//!
//! `run` renders and scores. `report` makes these files, and comes later in the order of imports,
//! so `run` calls them through traits.

use super::renderer::{RenderFault, Renderer};
use super::results::Results;
use super::store::{Store, StoreError};
use crate::experiment::plan::Plan;
use std::fmt::Debug;

/// A file made from the plan while the run has its device, before the first cell. A run that
/// continues keeps it, unless new cells are added to its plan.
pub trait PlanFile: Debug + Sync {
    /// Name in the folder of the run.
    fn name(&self) -> &'static str;

    /// Tells the user what is missing if the file cannot be made.
    fn loss(&self) -> &'static str;

    /// Makes the content. It may render.
    fn text(&self, plan: &Plan, renderer: &mut dyn Renderer) -> Result<String, RenderFault>;
}

/// Files made from the finished cells, after the tables.
pub trait ResultFiles: Debug + Sync {
    /// Writes the files, and removes files of an earlier invocation that are not written again.
    fn write(&self, store: &Store, plan: &Plan, results: &Results) -> Result<(), StoreError>;
}

/// The companions of a run; `report::COMPANIONS` has all.
#[derive(Clone, Copy, Debug, Default)]
pub struct Companions<'a> {
    pub plan_files: &'a [&'a dyn PlanFile],
    pub result_files: &'a [&'a dyn ResultFiles],
}
