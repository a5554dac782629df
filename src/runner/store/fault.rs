//! Faults of the folder of a run.

use crate::pixels::PixelsError;
use crate::runner::provenance::ProvenanceError;
use crate::table::csv;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Why a run cannot use its folder.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    #[error("{}: holds a run of another experiment ({found}); give another --out, or remove it", dir.display())]
    OtherExperiment { dir: PathBuf, found: String },
    /// A run that may grow into the plan.
    #[error(
        "{}: holds a run of another plan of {name} ({found}), and each of its {count} cells is in this one; `splitsum run \
         --extend` keeps them and does the others, else give another --out", dir.display()
    )]
    Extensible { dir: PathBuf, name: String, found: String, count: usize },
    /// A run of which something would no longer stand in the tables.
    #[error(
        "{}: holds a run of another plan of {name}, and of its {count} {what} {} would not be in the tables of this one: {}; give another \
         --out, or extend it (`splitsum run --extend`) by a plan with all of them", dir.display(), lost.len(), listed(lost)
    )]
    WouldLose { dir: PathBuf, name: String, what: &'static str, count: usize, lost: Vec<String> },
    /// A run of another plan whose tables name cells that the folder has no records of, as a published one.
    #[error(
        "{}: holds the tables of a run of another plan, but no records of {count} of its cells, as a published run does; give another \
         --out, or extend the run that it was published from", dir.display()
    )]
    TablesAlone { dir: PathBuf, count: usize },
    #[error(
        "{}: holds a run scored by another version of the metric {metric}, whose numbers do not belong beside those of this one; give another \
         --out", dir.display()
    )]
    OtherMetric { dir: PathBuf, metric: String },
    #[error("{}: holds a run made with other shaders, whose images may differ; give another --out, or remove it", dir.display())]
    OtherShaders { dir: PathBuf },
    #[error("{}: another run is at work in it; run the same command again after its end, or give another --out", dir.display())]
    Busy { dir: PathBuf },
    #[error("{}: is not empty and not a run (it has no provenance.json); give another --out", dir.display())]
    NotARun { dir: PathBuf },
    #[error("{}: is a file; expected a folder, or the name of one to make", dir.display())]
    NotAFolder { dir: PathBuf },
    #[error("{}: cannot be made: {error}; expected a place where this user may write", path.display())]
    Folder { path: PathBuf, error: std::io::Error },
    #[error("{}: {error}; expected a file that this program wrote (remove it to make it anew)", path.display())]
    Corrupt { path: PathBuf, error: serde_json::Error },
    /// Noticed by its checksum ([`seal`](crate::runner::seal)).
    #[error("{}: was changed or damaged after it was written: its checksum does not hold (remove it to make it anew)", path.display())]
    Damaged { path: PathBuf },
    /// A record that was copied or renamed.
    #[error("{}: is the record of {found}, under another name (remove it to make it anew)", path.display())]
    Stranger { path: PathBuf, found: String },
    #[error("{}: {error}", path.display())]
    Io { path: PathBuf, error: std::io::Error },
    #[error(transparent)]
    Provenance(#[from] ProvenanceError),
    #[error(transparent)]
    Write(#[from] PixelsError),
    #[error(transparent)]
    Table(#[from] csv::TableError),
}

/// Names that a message lists.
const LISTED: usize = 3;

fn listed(names: &[String]) -> String {
    let more = names.len().saturating_sub(LISTED);
    let first = names[..names.len() - more].join("; ");
    if more > 0 { format!("{first}; {more} more") } else { first }
}

impl StoreError {
    /// Whether the user named the wrong folder, rather than a file failing.
    pub fn is_misuse(&self) -> bool {
        match self {
            Self::OtherExperiment { .. }
            | Self::Extensible { .. }
            | Self::WouldLose { .. }
            | Self::TablesAlone { .. }
            | Self::OtherMetric { .. }
            | Self::OtherShaders { .. }
            | Self::NotARun { .. }
            | Self::NotAFolder { .. }
            | Self::Folder { .. }
            | Self::Provenance(_) => true,
            // A folder, a device or a pipe where a file of the run belongs.
            Self::Io { error, .. } => [ErrorKind::IsADirectory, ErrorKind::InvalidInput].contains(&error.kind()),
            _ => false,
        }
    }

    /// Whether a record is there but cannot be used: whoever can make it anew takes it for none.
    pub fn is_unusable_record(&self) -> bool {
        matches!(self, Self::Corrupt { .. } | Self::Damaged { .. } | Self::Stranger { .. })
    }

    /// Whether the same command may succeed later, as it is.
    pub fn is_passing(&self) -> bool {
        matches!(self, Self::Busy { .. })
    }

    /// Whether something that is no file stands where the file of this path belongs: then others can still be written, other than on a full
    /// disk.
    pub fn is_of_one_place(&self, path: &Path) -> bool {
        let is_of_a_file = matches!(self, Self::Io { .. } | Self::Write(_));
        is_of_a_file && std::fs::metadata(path).is_ok_and(|metadata| !metadata.is_file())
    }
}
