//! Locks a folder for one run, or for any number of different shards.

use super::{SHARDS_FOLDER, Store, StoreError};
use crate::base::files::{names_in, open_regular};
use crate::run::shard::Shard;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

/// Locked by a run exclusively, by shards shared.
pub(super) const LOCK_FILE: &str = ".lock";
/// Ending of the file that a shard locks.
const SHARD_LOCK: &str = ".lock";

/// A locked file. The system unlocks it when the process ends.
#[derive(Debug)]
pub(super) struct Lock(File);

impl Drop for Lock {
    /// Unlocks before closing: a child process that is just starting may hold a copy of the handle.
    fn drop(&mut self) {
        let _ = self.0.unlock();
    }
}

/// Locks a file; `None` on a file system without locks.
fn lock(
    path: PathBuf,
    is_shared: bool,
    busy: impl FnOnce() -> StoreError,
) -> Result<Option<Lock>, StoreError> {
    let file = File::options()
        .create(true)
        .truncate(false)
        .read(true)
        .write(true)
        .open(&path);
    let file = file.map_err(|error| StoreError::Io {
        path: path.clone(),
        error,
    })?;
    match if is_shared {
        file.try_lock_shared()
    } else {
        file.try_lock()
    } {
        Ok(()) => Ok(Some(Lock(file))),
        Err(TryLockError::Error(error)) if error.kind() == std::io::ErrorKind::Unsupported => {
            Ok(None)
        }
        Err(TryLockError::WouldBlock) => Err(busy()),
        Err(TryLockError::Error(error)) => Err(StoreError::Io { path, error }),
    }
}

/// Whether another process has an exclusive lock; false on a file system without locks.
fn is_locked(path: &Path) -> bool {
    // Shared, so that two readers do not mistake each other for an owner.
    open_regular(path)
        .is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

impl Store {
    /// Locks the folder for a run or a shard. Shards of another count, which share cells with it,
    /// must not run.
    pub(super) fn locks(&self) -> Result<Vec<Lock>, StoreError> {
        let busy = |who: String| StoreError::Busy {
            dir: self.dir.clone(),
            who,
        };
        let whole = lock(self.dir.join(LOCK_FILE), self.shard.is_some(), || {
            busy("another run".to_owned())
        })?;
        let Some(shard) = self.shard else {
            return Ok(whole.into_iter().collect());
        };
        let folder = self.dir.join(SHARDS_FOLDER);
        let shard_lock = lock(folder.join(shard.stem() + SHARD_LOCK), false, || {
            busy(format!("shard {shard}"))
        })?;
        let others = names_in(&folder)
            .into_iter()
            .filter_map(|name| Shard::by_stem(name.strip_suffix(SHARD_LOCK)?));
        let mut rivals = others.filter(|other| other.count != shard.count);
        match rivals.find(|other| is_locked(&folder.join(other.stem() + SHARD_LOCK))) {
            Some(rival) => Err(busy(format!("shard {rival}"))),
            None => Ok(whole.into_iter().chain(shard_lock).collect()),
        }
    }

    /// Whether a run is using the folder.
    pub fn is_under_way(&self) -> bool {
        is_locked(&self.dir.join(LOCK_FILE))
    }
}
