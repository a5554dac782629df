//! Files as a whole: bounded reading, replacement in one step, the error that all image formats share.

use crate::files::read_regular;
use crate::spelling::printable;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Most texels of an environment, read or made (8192 x 4096): with [`ENVIRONMENT_TEXEL_BYTES`] they stay below 2 GiB.
pub(crate) const ENVIRONMENT_TEXELS_MAX: u64 = 1 << 25;
/// Bytes that a texel of an environment takes at most: 12 as radiance, as many again in f32 for the exact integrals, up to 34 for the
/// quadtree of those; or 12, 16 on the way to the device and, where that is this machine, 22 there.
const ENVIRONMENT_TEXEL_BYTES: u64 = 58;
/// Most pixels of a picture of 8-bit values that is read, such as a contact sheet (8192 x 8192).
pub(super) const PICTURE_TEXELS_MAX: u64 = 1 << 26;
/// Bytes that a decoded texel takes: red, green, blue and alpha.
const DECODED_TEXEL_BYTES: u64 = 16;
/// Largest file that is read, bytes. Readers hold the file in memory.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// An image file that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {what}; expected {expected}", path.display())]
pub struct PixelsError {
    pub path: PathBuf,
    /// What is wrong, with the place in the file and the value.
    pub what: String,
    pub expected: String,
}

/// A [`PixelsError`] before the path is known.
#[derive(Debug)]
pub(crate) struct Fault {
    pub what: String,
    pub expected: String,
}

impl Fault {
    pub fn new(what: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { what: printable(&what.into()), expected: expected.into() }
    }

    pub fn at(self, path: &Path) -> PixelsError {
        PixelsError { path: path.to_owned(), what: self.what, expected: self.expected }
    }
}

/// The whole file, which must be a regular one.
pub(crate) fn read_bounded(path: &Path) -> Result<Vec<u8>, PixelsError> {
    read_regular(path, MAX_FILE_BYTES)
        .map_err(|error| Fault::new(format!("cannot be read ({error})"), "a readable image file").at(path))
}

/// Checks a size that a header claims; `file_bytes * texels_per_byte` bounds what the file can plausibly hold.
pub(super) fn check_claim(
    width: u64,
    height: u64,
    most_texels: u64,
    file_bytes: usize,
    texels_per_byte: u64,
) -> Result<(), Fault> {
    if width == 0 || height == 0 {
        return Err(Fault::new(format!("the header claims {width}x{height} pixels"), "at least one pixel"));
    }
    let texels = width.saturating_mul(height);
    if texels > most_texels {
        let is_map = most_texels == ENVIRONMENT_TEXELS_MAX;
        let texel_bytes = if is_map { ENVIRONMENT_TEXEL_BYTES } else { DECODED_TEXEL_BYTES };
        let mebibytes = texels.saturating_mul(texel_bytes) >> 20;
        // Each limit is a power of 2.
        let power = most_texels.ilog2();
        let size = format!("{}x{}", 1u64 << power.div_ceil(2), 1u64 << (power / 2));
        return Err(Fault::new(
            format!("the header claims {width}x{height} pixels, which take {mebibytes} MiB of memory"),
            format!("at most {most_texels} pixels; resample the image to {size} or less"),
        ));
    }
    if texels > (file_bytes as u64).saturating_mul(texels_per_byte) {
        return Err(Fault::new(
            format!("the header claims {width}x{height} pixels, but the file has {file_bytes} bytes"),
            "pixels that fit in the file; it is probably truncated",
        ));
    }
    Ok(())
}

/// An empty vector with room for `count` values of an image, or what is missing: a process that is out of memory must say so.
pub(crate) fn reserved<T>(count: usize) -> Result<Vec<T>, Fault> {
    let mut data = Vec::new();
    data.try_reserve_exact(count).map_err(|_| {
        let mebibytes = count.saturating_mul(size_of::<T>()) >> 20;
        Fault::new(format!("{mebibytes} MiB of memory for its {count} pixels are not to be had"), "a machine with more")
    })?;
    Ok(data)
}

/// As [`reserved`], of `count` times the same value.
pub(super) fn filled<T: Clone>(count: usize, value: T) -> Result<Vec<T>, Fault> {
    let mut data = reserved(count)?;
    data.resize(count, value);
    Ok(data)
}

/// What the names of unfinished files begin with; they end in `.part`.
pub const PART_PREFIX: &str = ".splitsum-";

/// Writes through `fill` into a temporary file beside `path`, then renames it: `path` holds the old or the whole new content,
/// never a part, and nothing is left behind on failure.
pub(crate) fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut File>) -> std::io::Result<()>,
) -> Result<(), PixelsError> {
    Staged::filled(path, fill)?.put()
}

/// A file beside the one that it will replace. Until [`Staged::put`] the old file stays; a value that is dropped leaves nothing.
pub struct Staged {
    path: PathBuf,
    /// `None` once it is in its place.
    part: Option<PathBuf>,
}

impl Staged {
    /// Writes `bytes`, for the file at `path`.
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
        let staged = Self { path: path.clone(), part: Some(part) };
        let mut writer = BufWriter::new(&mut file);
        fill(&mut writer).and_then(|()| writer.flush()).map_err(io)?;
        Ok(staged)
    }

    /// Replaces the file, in one step.
    pub fn put(mut self) -> Result<(), PixelsError> {
        let Some(part) = &self.part else { return Ok(()) };
        std::fs::rename(part, &self.path).map_err(|error| write_fault(&self.path, error))?;
        self.part = None;
        Ok(())
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        if let Some(part) = &self.part {
            // An error leaves nothing to do: the folder may be gone.
            let _ = std::fs::remove_file(part);
        }
    }
}

/// Makes a file of a name that no other process and no other thread has.
fn new_part(folder: &Path) -> std::io::Result<(File, PathBuf)> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = folder.join(format!("{PART_PREFIX}{}-{count}.part", std::process::id()));
        match File::create_new(&path) {
            // Another machine may write to the same folder, by the same numbers.
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            result => return result.map(|file| (file, path)),
        }
    }
}

/// The file that a path stands for: of a link the file that it names, so that the link stays. What is there and is no regular file must not
/// be replaced by one: who may, would lose a device.
fn target_of(path: &Path) -> Result<PathBuf, PixelsError> {
    let is_link = std::fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_symlink());
    let target = match is_link {
        // A link to nothing stands for itself.
        true => std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned()),
        false => path.to_owned(),
    };
    match std::fs::metadata(&target) {
        Ok(metadata) if !metadata.is_file() && !metadata.is_dir() => {
            Err(Fault::new("is a device or a pipe", "a file, or the name of one to make").at(path))
        }
        _ => Ok(target),
    }
}

fn write_fault(path: &Path, error: std::io::Error) -> PixelsError {
    Fault::new(format!("cannot be written ({error})"), "a path in an existing, writable folder").at(path)
}
