//! One experiment on several machines: a plan file cuts it into chunks, each runs by itself, and a merge makes one run of them.
//!
//! `prices` say how long work takes without asking a device, `split` cuts by them, `file` is the plan file, `store` the folder that all
//! chunks write to, `work` one chunk, `merge` the end. Nothing relies on locks between machines: every process writes into a folder of
//! its own and only reads those of others. Scheduling is left to an engine that exists.

pub mod file;
pub mod merge;
pub mod prices;
pub mod split;
pub mod store;
pub mod work;

use super::execute::RunError;
use super::store::StoreError;
use std::path::PathBuf;

pub use file::PlanFile;
pub use merge::{Hole, Merged, merge};
pub use prices::Prices;
pub use split::Chunk;
pub use work::run_chunk;

/// Why a chunk or a merge ended early.
#[derive(Debug, thiserror::Error)]
pub enum ChunkError {
    /// The plan file cannot be used here: what is wrong and what to do.
    #[error("{}: {what}", path.display())]
    PlanFile { path: PathBuf, what: String },
    #[error("--chunk: the plan file has no chunk {chunk}; expected 0 to {last}")]
    NoSuchChunk { chunk: usize, last: usize },
    #[error("{}: holds chunks of another plan file; give another --store, or remove it", dir.display())]
    OtherPlan { dir: PathBuf },
    #[error("{}: holds no chunk of this plan; expected the --store that `splitsum run --plan` was given", dir.display())]
    NoStore { dir: PathBuf },
    /// One sentence for each pair of records.
    #[error("cells that were done twice on one device do not agree; nothing was merged:\n{}", .0.join("\n"))]
    Disagreement(Vec<String>),
    /// One sentence for each file.
    #[error(
        "records or images are damaged or missing; nothing was merged. Remove the records that are named, run their chunks again, and \
         merge again:\n{}", .0.join("\n")
    )]
    Damaged(Vec<String>),
    #[error(transparent)]
    Run(#[from] RunError),
}

impl ChunkError {
    /// Whether the user gave a wrong file or folder, rather than the work failing.
    pub fn is_misuse(&self) -> bool {
        match self {
            Self::PlanFile { .. } | Self::NoSuchChunk { .. } | Self::OtherPlan { .. } | Self::NoStore { .. } => true,
            Self::Disagreement(_) | Self::Damaged(_) | Self::Run(_) => false,
        }
    }
}

impl From<StoreError> for ChunkError {
    fn from(error: StoreError) -> Self {
        Self::Run(error.into())
    }
}
