//! Keeps a full disk from killing the process inside the driver.
//!
//! Mesa maps the index of its shader cache as a sparse file. On a full disk the first write to a
//! hole raises SIGBUS. So the cache is turned off if its folder has no room for the index.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Once;

/// Mesa's switch, and its variable for the cache folder (default: in `$XDG_CACHE_HOME` or
/// `~/.cache`).
const DISABLE: &str = "MESA_SHADER_CACHE_DISABLE";
const FOLDER: &str = "MESA_SHADER_CACHE_DIR";
/// The index holds 2^16 keys of 20 bytes; as much again for the first shaders.
const ROOM_BYTES: usize = 1 << 22;

/// Turns Mesa's shader cache off if the disk has no room for it. Must be called before the Vulkan
/// loader is opened. Only the first call checks; other threads wait for it, since later the drivers
/// may read the environment.
pub(super) fn disable_without_room() {
    static FIRST: Once = Once::new();
    FIRST.call_once(|| {
        if std::env::var_os(DISABLE).is_none() && folder().is_some_and(|folder| !has_room(&folder))
        {
            // SAFETY: nothing else in the program changes the environment. Readers through the C
            // library are the loader and the drivers, which are not open yet; other threads of the
            // program read it under the standard library's lock.
            unsafe { std::env::set_var(DISABLE, "true") };
        }
    });
}

fn folder() -> Option<PathBuf> {
    let set = |name| {
        std::env::var_os(name)
            .filter(|value| !value.is_empty())
            .map(PathBuf::from)
    };
    set(FOLDER)
        .or_else(|| set("XDG_CACHE_HOME"))
        .or_else(|| set("HOME").map(|home| home.join(".cache")))
}

/// Returns whether the folder has room for [`ROOM_BYTES`]. Mesa handles all other failures.
fn has_room(folder: &Path) -> bool {
    let written =
        tempfile::tempfile_in(folder).and_then(|mut file| file.write_all(&vec![0; ROOM_BYTES]));
    !written.is_err_and(|error| {
        matches!(
            error.kind(),
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded
        )
    })
}
