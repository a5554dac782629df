//! Errors of the folder of a run.

use crate::base::csv;
use crate::base::pixels::PixelsError;
use crate::run::provenance::ProvenanceError;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    #[error("{}: {why}", dir.display())]
    Refused { dir: PathBuf, why: String },
    #[error("{}: {who} is using it; wait until it ends, or choose another --out", dir.display())]
    Busy { dir: PathBuf, who: String },
    #[error("{}: cannot create the folder: {error}; choose another --out", path.display())]
    Folder {
        path: PathBuf,
        error: std::io::Error,
    },
    #[error("{}: {error}; delete the file to regenerate it", path.display())]
    Corrupt {
        path: PathBuf,
        error: serde_json::Error,
    },
    #[error("{}: was edited or damaged: its checksum is wrong; delete it to regenerate it", path.display())]
    Damaged { path: PathBuf },
    #[error("{}: contains the record of {found}; delete it to regenerate it", path.display())]
    Stranger { path: PathBuf, found: String },
    #[error("{}: {error}", path.display())]
    Io {
        path: PathBuf,
        error: std::io::Error,
    },
    #[error(transparent)]
    Provenance(#[from] ProvenanceError),
    #[error(transparent)]
    Write(#[from] PixelsError),
    #[error(transparent)]
    Table(#[from] csv::TableError),
}

impl StoreError {
    /// Whether the user chose the wrong folder.
    pub fn is_misuse(&self) -> bool {
        match self {
            Self::Refused { .. } | Self::Folder { .. } | Self::Provenance(_) => true,
            // A folder, device or pipe in place of a file.
            Self::Io { error, .. } => {
                [ErrorKind::IsADirectory, ErrorKind::InvalidInput].contains(&error.kind())
            }
            _ => false,
        }
    }

    /// Whether a record exists but cannot be used.
    pub fn is_unusable_record(&self) -> bool {
        matches!(
            self,
            Self::Corrupt { .. } | Self::Damaged { .. } | Self::Stranger { .. }
        )
    }

    /// Whether the same command may succeed later.
    pub fn is_passing(&self) -> bool {
        matches!(self, Self::Busy { .. })
    }

    /// Whether the path is not a regular file: then other files can still be written, unlike on a
    /// full disk.
    pub fn is_of_one_place(&self, path: &Path) -> bool {
        let is_of_a_file = matches!(self, Self::Io { .. } | Self::Write(_));
        is_of_a_file && std::fs::metadata(path).is_ok_and(|metadata| !metadata.is_file())
    }
}
