//! Tables and references that later runs take from the disk.
//!
//! An entry is a file named by the hash of its key. The key spells out everything that determines the entry's bits: the code that made it,
//! the device and its driver, the contents of the inputs, every parameter. The code is this program (by the hash of its own file, so that a
//! change of any formula counts), or [`Code::Shaders`] for what the device makes.
//! Floats are kept bit for bit, so a run gives the same bytes with the cache as without it.
//!
//! An entry is written in one step and carries a checksum; one that does not hold is removed and made anew. Several processes may share
//! a folder. Above its limit the entries that were used longest ago go first.

use crate::files::read_regular;
use crate::gpu::{DeviceInfo, HOST_HASH, code_hash, shader_code};
use crate::pixels::{PART_PREFIX, write_atomically};
use std::fs::{File, Metadata};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::{Duration, SystemTime};

/// Largest entry that is read, bytes: larger than any image.
const ENTRY_BYTES_MAX: u64 = 1 << 32;

/// First bytes of an entry; the digit counts up with its form.
const MAGIC: &[u8; 8] = b"splitsu1";
const CHECKSUM_LENGTH: usize = 32;
const EXTENSION: &str = "kept";
/// A full folder is emptied down to this share of its limit, so that it is not listed again for every entry.
const KEPT_SHARE: f64 = 0.8;
/// Half-written files of this age belong to nobody.
const PART_AGE: Duration = Duration::from_secs(24 * 3600);

/// The code that an entry hangs on.
#[derive(Clone, Copy, Debug)]
pub(super) enum Code<'a> {
    /// This program, all of it.
    Program,
    /// These shaders, by their SPIR-V, and the host's code around them: the build script hashes every source file but those that
    /// no device result hangs on (`HOST_EXCLUDED` in `shaders/compile.rs`), and the versions of all crates. So the distribution of an
    /// environment, the scrambles, the rule that stops a reference and the parameters of its passes count without a version to keep.
    Shaders(&'a [String]),
}

/// A folder of entries.
#[derive(Debug)]
pub struct DiskCache {
    dir: PathBuf,
    limit_bytes: u64,
    /// Size of all entries, as far as this process knows.
    bytes: u64,
    /// Hash of this program's file.
    program: &'static str,
    /// Lines of every key: the device.
    device: String,
    warnings: Vec<String>,
    /// Whether an entry could not be written; then no further one is tried.
    is_read_only: bool,
}

/// A folder that cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}: {what}; expected a folder where this user may write", dir.display())]
pub struct DiskCacheError {
    dir: PathBuf,
    what: String,
}

impl DiskCache {
    /// Makes the folder `dir` where it is missing; its entries take at most `limit_bytes`.
    pub fn open(dir: &Path, limit_bytes: u64) -> Result<Self, DiskCacheError> {
        let fault = |what: String| DiskCacheError { dir: dir.to_owned(), what };
        let program = program_hash().ok_or_else(|| fault("this program cannot read its own file".to_owned()))?;
        std::fs::create_dir_all(dir).map_err(|error| fault(error.to_string()))?;
        let (dir, device, warnings) = (dir.to_owned(), String::new(), Vec::new());
        let mut cache = Self { dir, limit_bytes, bytes: 0, program, device, warnings, is_read_only: false };
        cache.bytes = cache.entries().iter().map(|(_, metadata)| metadata.len()).sum();
        cache.remove_abandoned_parts();
        cache.evict();
        Ok(cache)
    }

    /// From here on entries are those of this device.
    pub fn set_device(&mut self, device: &DeviceInfo) {
        let DeviceInfo { name, driver, api_version, .. } = device;
        self.device += &format!("device={name}\ndriver={driver}\napi_version={api_version}\n");
    }

    /// Whether there is an entry of this code for `key`. It may turn out to be damaged.
    pub(super) fn holds(&self, code: Code, key: &str) -> bool {
        self.path(&self.whole_key(code, key)).exists()
    }

    fn whole_key(&self, code: Code, key: &str) -> String {
        let code = match code {
            Code::Program => format!("program={}", self.program),
            Code::Shaders(shaders) => format!("host={HOST_HASH}\nshaders={}", code_hash(shaders, shader_code)),
        };
        format!("{code}\n{}{key}", self.device)
    }

    /// The folder.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// What this program kept under `key`; `None` when there is nothing, or nothing whole.
    pub fn load(&mut self, key: &str) -> Option<Vec<u8>> {
        self.load_of(Code::Program, key)
    }

    /// As [`Self::load`], of this code.
    pub(super) fn load_of(&mut self, code: Code, key: &str) -> Option<Vec<u8>> {
        let key = self.whole_key(code, key);
        let path = self.path(&key);
        let bytes = match read_regular(&path, ENTRY_BYTES_MAX) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return None,
            Err(error) => {
                self.warnings.push(format!("cache: {}: {error}; what it holds is made anew", path.display()));
                return None;
            }
        };
        let Some(payload) = payload(bytes, &key) else {
            self.warnings.push(format!("cache: {}: is damaged; what it held is made anew", path.display()));
            self.remove(&path);
            return None;
        };
        // Used now. Where the time cannot be set, the entry merely looks older than it is.
        let _ = File::options().append(true).open(&path).and_then(|file| file.set_modified(SystemTime::now()));
        Some(payload)
    }

    /// Keeps `payload` under `key` for this program. A folder that takes no files is a warning, no fault: the work itself is done.
    pub fn store(&mut self, key: &str, payload: &[u8]) {
        self.store_of(Code::Program, key, payload);
    }

    /// As [`Self::store`], for this code.
    pub(super) fn store_of(&mut self, code: Code, key: &str, payload: &[u8]) {
        let key = self.whole_key(code, key);
        let length = (MAGIC.len() + CHECKSUM_LENGTH + 8 + key.len() + payload.len()) as u64;
        if self.is_read_only || length > self.limit_bytes {
            return;
        }
        let path = self.path(&key);
        let key_length = (key.len() as u64).to_le_bytes();
        let mut hasher = blake3::Hasher::new();
        let checksum = hasher.update(&key_length).update(key.as_bytes()).update(payload).finalize();
        let parts: [&[u8]; 5] = [MAGIC, checksum.as_bytes(), &key_length, key.as_bytes(), payload];
        match write_atomically(&path, |file| parts.iter().try_for_each(|part| file.write_all(part))) {
            Ok(()) => {
                self.bytes += length;
                self.evict();
            }
            Err(error) => {
                self.warnings.push(format!("cache: {error}; nothing more is kept by this run"));
                self.is_read_only = true;
            }
        }
    }

    /// What went wrong since the last call, one sentence each.
    pub fn take_warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.warnings)
    }

    fn path(&self, key: &str) -> PathBuf {
        self.dir.join(format!("{}.{EXTENSION}", blake3::hash(key.as_bytes()).to_hex()))
    }

    /// Every entry with what the system knows of it. Another process may remove one at any time.
    fn entries(&self) -> Vec<(PathBuf, Metadata)> {
        let files = std::fs::read_dir(&self.dir).into_iter().flatten().flatten();
        let entries = files.filter(|file| file.path().extension().is_some_and(|end| end == EXTENSION));
        entries.filter_map(|file| Some((file.path(), file.metadata().ok()?))).collect()
    }

    /// Removes the entries used longest ago when all of them are too large.
    fn evict(&mut self) {
        if self.bytes <= self.limit_bytes {
            return;
        }
        // What other processes added and removed counts from here on.
        let mut entries = self.entries();
        entries.sort_by_key(|(path, metadata)| (metadata.modified().ok(), path.clone()));
        self.bytes = entries.iter().map(|(_, metadata)| metadata.len()).sum();
        if self.bytes <= self.limit_bytes {
            return;
        }
        let goal = (self.limit_bytes as f64 * KEPT_SHARE) as u64;
        for (path, metadata) in entries {
            if self.bytes <= goal {
                return;
            }
            if self.remove(&path) {
                self.bytes -= metadata.len();
            }
        }
    }

    /// Whether the file is gone.
    fn remove(&mut self, path: &Path) -> bool {
        match std::fs::remove_file(path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                self.warnings.push(format!("cache: {}: cannot be removed ({error})", path.display()));
                false
            }
            _ => true,
        }
    }

    fn remove_abandoned_parts(&mut self) {
        for file in std::fs::read_dir(&self.dir).into_iter().flatten().flatten() {
            let is_part = file.file_name().to_string_lossy().starts_with(PART_PREFIX);
            let age = file.metadata().and_then(|m| m.modified()).ok().and_then(|time| time.elapsed().ok());
            if is_part && age.is_some_and(|age| age > PART_AGE) {
                self.remove(&file.path());
            }
        }
    }
}

/// The payload of an entry of this key, when it is whole.
fn payload(mut bytes: Vec<u8>, key: &str) -> Option<Vec<u8>> {
    let (magic, rest) = bytes.split_at_checked(MAGIC.len())?;
    let (checksum, body) = rest.split_at_checked(CHECKSUM_LENGTH)?;
    let (key_length, rest) = body.split_first_chunk::<8>()?;
    let is_whole = magic == MAGIC && blake3::hash(body).as_bytes() == checksum;
    let (kept_key, _) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*key_length)).ok()?)?;
    (is_whole && kept_key == key.as_bytes()).then(|| {
        bytes.drain(..MAGIC.len() + CHECKSUM_LENGTH + 8 + key.len());
        bytes
    })
}

/// Hash of the running program's file, read once; `None` where it cannot be read.
pub fn program_hash() -> Option<&'static str> {
    static HASH: OnceLock<Option<String>> = OnceLock::new();
    let read = || Some(blake3::hash(&std::fs::read(std::env::current_exe().ok()?).ok()?).to_hex().to_string());
    HASH.get_or_init(read).as_deref()
}
