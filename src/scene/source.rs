//! Where a scene's file and the files that it names come from.

use crate::files::read_regular;
use std::io;
use std::path::{Path, PathBuf};

/// Largest file that is read, bytes.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// Files by path: those of the disk, or ones in memory.
pub trait SceneFiles {
    /// The bytes of a file.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;
    /// Whether there is such a file.
    fn has(&self, path: &Path) -> bool;
}

/// The files of the disk.
pub struct Disk;

impl SceneFiles for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        read_regular(path, MAX_FILE_BYTES)
    }

    fn has(&self, path: &Path) -> bool {
        path.is_file()
    }
}

/// `file` relative to the folder of `from`; with `/` for `\` if only that exists.
pub(super) fn existing(files: &dyn SceneFiles, from: &Path, file: &str) -> PathBuf {
    let folder = from.parent().unwrap_or(Path::new(""));
    let slashes = folder.join(file.replace('\\', "/"));
    if files.has(&slashes) { slashes } else { folder.join(file) }
}
