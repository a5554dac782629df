//! Reading whole files of anyone's making: nothing without an end, nothing above a limit. Hashes of what they hold.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Largest text that a person gives, an experiment or a table of queries: a million rows.
pub const TEXT_BYTES_MAX: u64 = 1 << 26;
/// Largest record of one cell, answer or attempt; they take kilobytes.
pub const RECORD_BYTES_MAX: u64 = 1 << 24;
/// Largest file about a whole plan: its chunks, its provenance. The largest plan takes some 100 MiB.
pub const PLAN_BYTES_MAX: u64 = 1 << 28;

/// Opens a regular file. A file may name others: a device or pipe among them may never end, and opening a pipe blocks until somebody
/// writes, so the type is asked for first.
pub fn open_regular(path: &Path) -> Result<File> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(Error::new(ErrorKind::InvalidInput, "not a regular file"));
    }
    File::open(path)
}

/// The bytes of a regular file of at most `most_bytes`.
pub fn read_regular(path: &Path, most_bytes: u64) -> Result<Vec<u8>> {
    read_at_most(open_regular(path)?, most_bytes)
}

/// As [`read_regular`], of a file of UTF-8.
pub fn read_text(path: &Path, most_bytes: u64) -> Result<String> {
    String::from_utf8(read_regular(path, most_bytes)?).map_err(|_| Error::other("not UTF-8 text"))
}

/// As [`read_regular`], but also of what the shell opened for us: standard input, or the end of a pipe as in `<(command)`. Somebody
/// holds the other end of those, unlike that of a pipe that is found by its name.
pub fn read_given(path: &Path, most_bytes: u64) -> Result<Vec<u8>> {
    let is_open = ["/dev/stdin", "/dev/fd", "/proc/self/fd"].iter().any(|place| path.starts_with(place));
    if is_open { read_at_most(File::open(path)?, most_bytes) } else { read_regular(path, most_bytes) }
}

fn read_at_most(file: File, most_bytes: u64) -> Result<Vec<u8>> {
    let too_large = || Error::other(format!("larger than {} MiB", most_bytes >> 20));
    // Known before anything is read; what has no length is counted as it comes.
    let length = file.metadata().map_or(0, |metadata| metadata.len());
    if length > most_bytes {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length as usize).map_err(|_| {
        Error::new(ErrorKind::OutOfMemory, format!("no memory for its {} MiB", length.div_ceil(1 << 20)))
    })?;
    file.take(most_bytes + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most_bytes { Err(too_large()) } else { Ok(bytes) }
}

/// The names in a folder, in order; none where it cannot be read.
pub fn names_in(dir: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(dir).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Whether `path` is a regular file of this content.
pub fn holds(path: &Path, content: &[u8]) -> bool {
    let length = content.len() as u64;
    std::fs::metadata(path).is_ok_and(|metadata| metadata.is_file() && metadata.len() == length)
        && read_regular(path, length).is_ok_and(|found| found == content)
}

/// Hash of a regular file's bytes, in hexadecimal.
pub fn content_hash(path: &Path) -> Result<String> {
    let mut hasher = blake3::Hasher::new();
    Ok(hasher.update_reader(open_regular(path)?)?.finalize().to_hex().to_string())
}

/// The path `to` from the folder `from`, with `/` on every machine; whole where no path leads there.
pub fn relative(from: &Path, to: &Path) -> String {
    let whole = |path: &Path| {
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        // What does not exist is reported when it is opened.
        std::fs::canonicalize(path).or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_owned())
    };
    // A link to a file is followed when it is opened; its own place is what was named.
    let to = match (to.is_file(), to.parent(), to.file_name()) {
        (true, Some(parent), Some(name)) => whole(parent).join(name),
        _ => whole(to),
    };
    let from = whole(from);
    let common = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return to.display().to_string();
    }
    let up = from.components().skip(common).map(|_| "..".to_owned());
    let down = to.components().skip(common).map(|part| part.as_os_str().to_string_lossy().into_owned());
    let parts: Vec<String> = up.chain(down).collect();
    if parts.is_empty() { ".".to_owned() } else { parts.join("/") }
}
