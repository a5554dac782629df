//! Reading whole files of anyone's making: nothing without an end, nothing above a limit. Hashes of what they hold.

use std::fs::File;
use std::io::{Error, Read, Result};
use std::path::Path;

/// The bytes of a regular file of at most `most_bytes`. A file may name others: a device or pipe among them may never end, and
/// opening a pipe blocks until somebody writes, so the type is asked for first.
pub fn read_regular(path: &Path, most_bytes: u64) -> Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(Error::other("not a regular file"));
    }
    read_stream(path, most_bytes)
}

/// As [`read_regular`], but of anything that can be opened: what the user names on the command line may be a pipe.
pub fn read_stream(path: &Path, most_bytes: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(most_bytes + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most_bytes {
        return Err(Error::other(format!("larger than {} MiB", most_bytes >> 20)));
    }
    Ok(bytes)
}

/// Hash of a file's bytes, in hexadecimal.
pub fn content_hash(path: &Path) -> Result<String> {
    let mut hasher = blake3::Hasher::new();
    Ok(hasher.update_reader(File::open(path)?)?.finalize().to_hex().to_string())
}
