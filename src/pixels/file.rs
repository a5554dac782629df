//! Files as a whole: bounded reading, replacement in one step, the error that all image formats share.

use crate::files::read_regular;
use crate::spelling::printable;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Largest image that is read or made, texels (32768 x 4096): 1.5 GiB as RGB floats.
pub(crate) const MAX_TEXELS: u64 = 1 << 27;
/// Largest file that is read, bytes. Readers hold the file in memory.
const MAX_FILE_BYTES: u64 = 1 << 32;

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
pub(super) struct Fault {
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
pub(super) fn check_claim(width: u64, height: u64, file_bytes: usize, texels_per_byte: u64) -> Result<(), Fault> {
    if width == 0 || height == 0 {
        return Err(Fault::new(format!("the header claims {width}x{height} pixels"), "at least one pixel"));
    }
    let texels = width.saturating_mul(height);
    if texels > MAX_TEXELS {
        return Err(Fault::new(
            format!("the header claims {width}x{height} pixels"),
            format!("at most {MAX_TEXELS} pixels"),
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

/// What the names of unfinished files begin with; they end in `.part`.
pub(crate) const PART_PREFIX: &str = ".splitsum-";

/// Writes through `fill` into a temporary file beside `path`, then renames it: `path` holds the old or the whole new content,
/// never a part, and nothing is left behind on failure.
pub(crate) fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut File>) -> std::io::Result<()>,
) -> Result<(), PixelsError> {
    Staged::filled(path, fill)?.put()
}

/// A file written beside the one that it will replace: until [`Staged::put`] the old one stands, and where this is dropped nothing is left.
pub(crate) struct Staged {
    path: PathBuf,
    temporary: tempfile::NamedTempFile,
}

impl Staged {
    /// Writes `bytes`, for the file at `path`.
    pub(crate) fn new(path: &Path, bytes: &[u8]) -> Result<Self, PixelsError> {
        Self::filled(path, |writer| writer.write_all(bytes))
    }

    fn filled(
        path: &Path,
        fill: impl FnOnce(&mut BufWriter<&mut File>) -> std::io::Result<()>,
    ) -> Result<Self, PixelsError> {
        let target = target_of(path)?;
        let path = target.as_path();
        let io = |error| write_fault(path, error);
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        builder.prefix(PART_PREFIX).suffix(".part");
        // The default of temporary files is private to the user; the result should get the rights of any new file.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut temporary = builder.tempfile_in(folder).map_err(io)?;
        let mut writer = BufWriter::new(temporary.as_file_mut());
        fill(&mut writer).and_then(|()| writer.flush()).map_err(io)?;
        drop(writer);
        Ok(Self { path: path.to_owned(), temporary })
    }

    /// Replaces the file, in one step.
    pub(crate) fn put(self) -> Result<(), PixelsError> {
        self.temporary.persist(&self.path).map_err(|error| write_fault(&self.path, error.error))?;
        Ok(())
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
