//! Access to a scene's files.

use crate::base::files::read_regular;
use std::io;
use std::path::{Path, PathBuf};

const MAX_FILE_BYTES: u64 = 1 << 30;

/// Files by path, on disk or in memory.
pub trait SceneFiles {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;
    fn has(&self, path: &Path) -> bool;
}

pub struct Disk;

impl SceneFiles for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        read_regular(path, MAX_FILE_BYTES)
    }

    fn has(&self, path: &Path) -> bool {
        path.is_file()
    }
}

/// Resolves `file` beside `from`, with `/` for `\` if only that exists.
pub(super) fn existing(files: &dyn SceneFiles, from: &Path, file: &str) -> PathBuf {
    let folder = from.parent().unwrap_or(Path::new(""));
    let slashes = folder.join(file.replace('\\', "/"));
    if files.has(&slashes) {
        slashes
    } else {
        folder.join(file)
    }
}
