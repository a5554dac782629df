//! Files as a whole: bounded reading, atomic replacement, and the error of all image formats.

use crate::base::files::read_regular;
use crate::base::names::printable;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Most texels of an environment (8192 x 4096): below 2 GiB at [`ENVIRONMENT_TEXEL_BYTES`].
pub(crate) const ENVIRONMENT_TEXELS_MAX: u64 = 1 << 25;
/// Most bytes per texel of an environment: radiance, a copy for exact integrals and its quadtree,
/// or radiance and device copies.
const ENVIRONMENT_TEXEL_BYTES: u64 = 58;
/// Most pixels of an 8-bit picture (8192 x 8192).
pub(super) const PICTURE_TEXELS_MAX: u64 = 1 << 26;
const DECODED_TEXEL_BYTES: u64 = 16;
/// Largest file, bytes. Readers hold it in memory.
const MAX_FILE_BYTES: u64 = 1 << 30;

#[derive(Debug, thiserror::Error)]
#[error("{}: {what}; expected {expected}", path.display())]
pub struct PixelsError {
    pub path: PathBuf,
    /// The fault, with place and value.
    pub what: String,
    pub expected: String,
}

/// A [`PixelsError`] without its path.
#[derive(Debug)]
pub(crate) struct Fault {
    pub what: String,
    pub expected: String,
}

impl Fault {
    pub fn new(what: impl Into<String>, expected: impl Into<String>) -> Self {
        Self {
            what: printable(&what.into()),
            expected: expected.into(),
        }
    }

    /// Puts words before what is wrong.
    pub fn preceded_by(self, words: impl Into<String>) -> Self {
        Self {
            what: words.into() + &self.what,
            ..self
        }
    }

    pub fn in_file(self, path: &Path) -> PixelsError {
        PixelsError {
            path: path.to_owned(),
            what: self.what,
            expected: self.expected,
        }
    }
}

pub(crate) fn read_bounded(path: &Path) -> Result<Vec<u8>, PixelsError> {
    read_regular(path, MAX_FILE_BYTES).map_err(|error| {
        Fault::new(format!("cannot be read ({error})"), "a readable image file").in_file(path)
    })
}

/// Checks a header's size; the file cannot hold more than `file_bytes * texels_per_byte`.
pub(super) fn check_claim(
    width: u64,
    height: u64,
    most_texels: u64,
    file_bytes: usize,
    texels_per_byte: u64,
) -> Result<(), Fault> {
    if width == 0 || height == 0 {
        return Err(Fault::new(
            format!("the header claims {width}x{height} pixels"),
            "at least one pixel",
        ));
    }
    let texels = width.saturating_mul(height);
    if texels > most_texels {
        let is_map = most_texels == ENVIRONMENT_TEXELS_MAX;
        let texel_bytes = if is_map {
            ENVIRONMENT_TEXEL_BYTES
        } else {
            DECODED_TEXEL_BYTES
        };
        let mebibytes = texels.saturating_mul(texel_bytes) >> 20;
        // Each limit is a power of 2.
        let power = most_texels.ilog2();
        let size = format!("{}x{}", 1u64 << power.div_ceil(2), 1u64 << (power / 2));
        return Err(Fault::new(
            format!(
                "the header claims {width}x{height} pixels, which take {mebibytes} MiB of memory"
            ),
            format!("at most {most_texels} pixels; resample the image to {size} or less"),
        ));
    }
    if texels > (file_bytes as u64).saturating_mul(texels_per_byte) {
        return Err(Fault::new(
            format!(
                "the header claims {width}x{height} pixels, but the file has {file_bytes} bytes"
            ),
            "pixels that fit in the file; it is probably truncated",
        ));
    }
    Ok(())
}

/// Reserves room for `count` values; fails if memory is short.
pub(crate) fn reserved<T>(count: usize) -> Result<Vec<T>, Fault> {
    let mut data = Vec::new();
    data.try_reserve_exact(count).map_err(|_| {
        let mebibytes = count.saturating_mul(size_of::<T>()) >> 20;
        Fault::new(
            format!("not enough memory for its {count} pixels ({mebibytes} MiB)"),
            "a machine with more",
        )
    })?;
    Ok(data)
}

pub(super) fn filled<T: Clone>(count: usize, value: T) -> Result<Vec<T>, Fault> {
    let mut data = reserved(count)?;
    data.resize(count, value);
    Ok(data)
}

/// Prefix of unfinished files, which end in `.part`.
pub const PART_PREFIX: &str = ".splitsum-";

/// Writes through `fill` to a temporary file, then renames it: `path` never holds a part, and
/// failure leaves nothing.
pub(crate) fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut File>) -> std::io::Result<()>,
) -> Result<(), PixelsError> {
    Staged::filled(path, fill)?.put()
}

/// A temporary file beside its target, which [`Staged::put`] replaces. Dropping it removes the
/// file.
pub struct Staged {
    path: PathBuf,
    /// `None` once renamed.
    part: Option<PathBuf>,
}

impl Staged {
    pub fn new(path: &Path, bytes: &[u8]) -> Result<Self, PixelsError> {
        Self::filled(path, |writer| writer.write_all(bytes))
    }

    fn filled(
        path: &Path,
        fill: impl FnOnce(&mut BufWriter<&mut File>) -> std::io::Result<()>,
    ) -> Result<Self, PixelsError> {
        let path = target_of(path)?;
        let io = |error| write_fault(&path, error);
        let (mut file, part) = new_part(path.parent().unwrap_or(Path::new(""))).map_err(io)?;
        let staged = Self {
            path: path.clone(),
            part: Some(part),
        };
        let mut writer = BufWriter::new(&mut file);
        fill(&mut writer)
            .and_then(|()| writer.flush())
            .map_err(io)?;
        Ok(staged)
    }

    /// Replaces the target in one step.
    pub fn put(mut self) -> Result<(), PixelsError> {
        let Some(part) = &self.part else {
            return Ok(());
        };
        std::fs::rename(part, &self.path).map_err(|error| write_fault(&self.path, error))?;
        self.part = None;
        Ok(())
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        if let Some(part) = &self.part {
            // The folder may be gone.
            let _ = std::fs::remove_file(part);
        }
    }
}

/// Creates a file with a unique name.
fn new_part(folder: &Path) -> std::io::Result<(File, PathBuf)> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = folder.join(format!("{PART_PREFIX}{}-{count}.part", std::process::id()));
        match File::create_new(&path) {
            // Another machine may use the same numbers in the same folder.
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            result => return result.map(|file| (file, path)),
        }
    }
}

/// Follows a link, so that it stays. Refuses devices and pipes, which must not be replaced.
fn target_of(path: &Path) -> Result<PathBuf, PixelsError> {
    let is_link = std::fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_symlink());
    let target = if is_link {
        // A dangling link is replaced.
        std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
    } else {
        path.to_owned()
    };
    match std::fs::metadata(&target) {
        Ok(metadata) if !metadata.is_file() && !metadata.is_dir() => {
            Err(Fault::new("is a device or a pipe", "a regular file or a new name").in_file(path))
        }
        _ => Ok(target),
    }
}

fn write_fault(path: &Path, error: std::io::Error) -> PixelsError {
    Fault::new(
        format!("cannot be written ({error})"),
        "a path in an existing, writable folder",
    )
    .in_file(path)
}
