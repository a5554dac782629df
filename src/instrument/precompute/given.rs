//! Prefiltered maps and DFG tables that other programs made, in our axes and channels.
//!
//! `bakes::given` reads them from files; the pipeline uploads them in place of the tables that it
//! would make.

use super::prefilter::LevelMapping;
use crate::instrument::environment::layout::MapLayout;
use std::sync::Arc;

/// Selects the tables that the program makes.
pub const OWN: &str = "own";
/// Selects our DFG table sampled at texel centres, as engines do.
pub const CENTRES: &str = "centres";

#[derive(Debug)]
pub struct GivenMap {
    pub name: String,
    /// Hash of the texels and the mapping.
    pub hash: String,
    pub layout: &'static MapLayout,
    /// Side of a face of level 0, texels.
    pub side: u32,
    pub mapping: &'static LevelMapping,
    /// Levels, each with its faces one after the other.
    pub levels: Vec<Vec<[f32; 4]>>,
}

#[derive(Debug)]
pub struct GivenTable {
    pub name: String,
    pub hash: String,
    pub side: u32,
    /// (A, B, 0, 1), row by row.
    pub texels: Vec<[f32; 4]>,
}

#[derive(Clone, Debug, Default)]
pub struct Given {
    pub prefiltered: Option<Arc<GivenMap>>,
    pub dfg: Option<Arc<GivenTable>>,
}
