//! One run at a time in a folder.

use super::{Store, StoreError};
use crate::files::open_regular;
use std::fs::{File, TryLockError};
use std::path::Path;

/// The file that a run locks.
pub(super) const LOCK_FILE: &str = ".lock";

/// A locked file. The system unlocks it when the process ends, however it ends.
#[derive(Debug)]
pub(super) struct Lock(File);

impl Drop for Lock {
    /// Closing alone would not do: a child process that is just being started may hold a copy of the handle for a moment.
    fn drop(&mut self) {
        // A lock that cannot be given back goes with the process.
        let _ = self.0.unlock();
    }
}

/// Takes the folder's lock, or says that another run has it. `None` on a file system that has no locks, as some shared ones.
pub(super) fn lock(dir: &Path) -> Result<Option<Lock>, StoreError> {
    let path = dir.join(LOCK_FILE);
    let file = File::options().create(true).truncate(false).write(true).open(&path);
    let file = file.map_err(|error| StoreError::Io { path: path.clone(), error })?;
    match file.try_lock() {
        Ok(()) => Ok(Some(Lock(file))),
        Err(TryLockError::Error(error)) if error.kind() == std::io::ErrorKind::Unsupported => Ok(None),
        Err(TryLockError::WouldBlock) => Err(StoreError::Busy { dir: dir.to_owned() }),
        Err(TryLockError::Error(error)) => Err(StoreError::Io { path, error }),
    }
}

impl Store {
    /// Whether a run is at work in the folder. Not known, and taken for no, on a file system without locks.
    pub fn is_under_way(&self) -> bool {
        let file = open_regular(&self.dir.join(LOCK_FILE));
        // Shared, so that two readers do not take each other for a run; given back with the file.
        file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }
}
