//! Bounded reading of whole files, and hashes.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::{Component, Path, PathBuf};

/// Largest text from a user, an experiment or table of queries: a million rows.
pub const TEXT_BYTES_MAX: u64 = 1 << 26;
/// Largest record of one cell, answer or attempt; they take kilobytes.
pub const RECORD_BYTES_MAX: u64 = 1 << 24;
/// Largest file about a whole plan; the largest plan takes 100 MiB.
pub const PLAN_BYTES_MAX: u64 = 1 << 28;

/// Opens a regular file. Devices and pipes may block or never end.
pub fn open_regular(path: &Path) -> Result<File> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(Error::new(ErrorKind::InvalidInput, "not a regular file"));
    }
    File::open(path)
}

pub fn read_regular(path: &Path, most_bytes: u64) -> Result<Vec<u8>> {
    read_at_most(open_regular(path)?, most_bytes)
}

/// Reads a regular UTF-8 file.
pub fn read_text(path: &Path, most_bytes: u64) -> Result<String> {
    String::from_utf8(read_regular(path, most_bytes)?).map_err(|_| Error::other("not UTF-8 text"))
}

/// Reads a regular file, or a pipe that the shell opened: standard input or `<(command)`.
pub fn read_given(path: &Path, most_bytes: u64) -> Result<Vec<u8>> {
    let is_open = ["/dev/stdin", "/dev/fd", "/proc/self/fd"]
        .iter()
        .any(|folder| path.starts_with(folder));
    if is_open {
        read_at_most(File::open(path)?, most_bytes)
    } else {
        read_regular(path, most_bytes)
    }
}

fn read_at_most(file: File, most_bytes: u64) -> Result<Vec<u8>> {
    let too_large = || Error::other(format!("larger than {} MiB", most_bytes >> 20));
    // Checked before reading; pipes have no length.
    let length = file.metadata().map_or(0, |metadata| metadata.len());
    if length > most_bytes {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length as usize).map_err(|_| {
        Error::new(
            ErrorKind::OutOfMemory,
            format!("no memory for its {} MiB", length.div_ceil(1 << 20)),
        )
    })?;
    file.take(most_bytes + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most_bytes {
        Err(too_large())
    } else {
        Ok(bytes)
    }
}

/// Resolves a name that a file gives for another in its folder; a downloaded file must not reach
/// files elsewhere.
pub fn inside(folder: &Path, name: &str) -> std::result::Result<PathBuf, String> {
    let slashes = name.replace('\\', "/");
    let is_inside = Path::new(&slashes)
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if is_inside {
        Ok(folder.join(name))
    } else {
        Err(format!(
            "{name:?} lies outside the file's folder; move it there"
        ))
    }
}

/// Lists the names in a folder, sorted; empty if it cannot be read.
pub fn names_in(dir: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(dir).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

pub fn holds(path: &Path, content: &[u8]) -> bool {
    let length = content.len() as u64;
    std::fs::metadata(path).is_ok_and(|metadata| metadata.is_file() && metadata.len() == length)
        && read_regular(path, length).is_ok_and(|found| found == content)
}

/// Hashes a regular file, in hexadecimal.
pub fn content_hash(path: &Path) -> Result<String> {
    let mut hasher = blake3::Hasher::new();
    Ok(hasher
        .update_reader(open_regular(path)?)?
        .finalize()
        .to_hex()
        .to_string())
}

/// Returns the path `to` from the folder `from`, with `/` on every system; absolute if there is no
/// relative path.
pub fn relative(from: &Path, to: &Path) -> String {
    let whole = |path: &Path| {
        let path = if path.as_os_str().is_empty() {
            Path::new(".")
        } else {
            path
        };
        // Missing files are reported when opened.
        std::fs::canonicalize(path)
            .or_else(|_| std::path::absolute(path))
            .unwrap_or_else(|_| path.to_owned())
    };
    // A link keeps its own place.
    let to = match (to.is_file(), to.parent(), to.file_name()) {
        (true, Some(parent), Some(name)) => whole(parent).join(name),
        _ => whole(to),
    };
    let Some(path) = pathdiff::diff_paths(&to, whole(from)) else {
        return to.display().to_string();
    };
    if path.as_os_str().is_empty() {
        return ".".to_owned();
    }
    let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}
