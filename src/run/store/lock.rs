//! Who may work in a folder at a time: one run, or any number of shards, each of them once.

use super::{SHARDS_FOLDER, Store, StoreError};
use crate::files::{names_in, open_regular};
use crate::run::shard::Shard;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

/// The file that a run locks for itself, and shards for each other.
pub(super) const LOCK_FILE: &str = ".lock";
/// The end of the name of a file that a shard locks for itself.
const SHARD_LOCK: &str = ".lock";

/// A locked file. The system unlocks it when the process ends, however it ends.
#[derive(Debug)]
pub(super) struct Lock(File);

impl Drop for Lock {
    /// Closing alone would not do: a child process that is just being started may hold a copy of the handle for a
    /// moment.
    fn drop(&mut self) {
        // A lock that cannot be given back goes with the process.
        let _ = self.0.unlock();
    }
}

/// Locks a file. `None` on a file system that has no locks, as some shared ones.
fn lock(path: PathBuf, is_shared: bool, busy: impl FnOnce() -> StoreError) -> Result<Option<Lock>, StoreError> {
    let file = File::options().create(true).truncate(false).read(true).write(true).open(&path);
    let file = file.map_err(|error| StoreError::Io { path: path.clone(), error })?;
    match if is_shared { file.try_lock_shared() } else { file.try_lock() } {
        Ok(()) => Ok(Some(Lock(file))),
        Err(TryLockError::Error(error)) if error.kind() == std::io::ErrorKind::Unsupported => Ok(None),
        Err(TryLockError::WouldBlock) => Err(busy()),
        Err(TryLockError::Error(error)) => Err(StoreError::Io { path, error }),
    }
}

/// Whether another process has locked a file for itself. Not known, and taken for no, on a file system without locks.
fn is_locked(path: &Path) -> bool {
    // Shared, so that two readers do not take each other for an owner; given back with the file.
    open_regular(path).is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

impl Store {
    /// Takes the locks of a run, or of a shard. Shards of other counts have cells in common with it, so they may not
    /// work meanwhile.
    pub(super) fn locks(&self) -> Result<Vec<Lock>, StoreError> {
        let busy = |who: String| StoreError::Busy { dir: self.dir.clone(), who };
        let whole = lock(self.dir.join(LOCK_FILE), self.shard.is_some(), || busy("another run".to_owned()))?;
        let Some(shard) = self.shard else { return Ok(whole.into_iter().collect()) };
        let folder = self.dir.join(SHARDS_FOLDER);
        let own = lock(folder.join(shard.stem() + SHARD_LOCK), false, || busy(format!("shard {shard}")))?;
        let others = names_in(&folder).into_iter().filter_map(|name| Shard::by_stem(name.strip_suffix(SHARD_LOCK)?));
        let mut rivals = others.filter(|other| other.count != shard.count);
        match rivals.find(|other| is_locked(&folder.join(other.stem() + SHARD_LOCK))) {
            Some(rival) => Err(busy(format!("shard {rival}"))),
            None => Ok(whole.into_iter().chain(own).collect()),
        }
    }

    /// Whether a run is at work in the folder.
    pub fn is_under_way(&self) -> bool {
        is_locked(&self.dir.join(LOCK_FILE))
    }
}
