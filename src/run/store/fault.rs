//! Faults of the folder of a run.

use crate::pixels::PixelsError;
use crate::run::provenance::ProvenanceError;
use crate::table::csv;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Why a run cannot use its folder.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// A folder that is none for this run: why, and what to do.
    #[error("{}: {why}", dir.display())]
    Refused { dir: PathBuf, why: String },
    #[error("{}: {who} is at work in it; run the same command again after its end, or choose another --out", dir.display())]
    Busy { dir: PathBuf, who: String },
    #[error("{}: cannot be made: {error}; expected a place where this user may write", path.display())]
    Folder { path: PathBuf, error: std::io::Error },
    #[error("{}: {error}; expected a file that this program wrote (remove it to make it anew)", path.display())]
    Corrupt { path: PathBuf, error: serde_json::Error },
    /// Noticed by its checksum ([`seal`](crate::run::seal)).
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

impl StoreError {
    /// Whether the user named the wrong folder, rather than a file failing.
    pub fn is_misuse(&self) -> bool {
        match self {
            Self::Refused { .. } | Self::Folder { .. } | Self::Provenance(_) => true,
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
