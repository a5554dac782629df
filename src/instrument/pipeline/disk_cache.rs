//! Tables and references kept on disk for later runs.
//!
//! An entry is a file named by the hash of its key. The key contains everything that determines the
//! entry's bits: the SPIR-V of its shaders, the host's code around them, the device and its driver,
//! the processor's model and features if the driver compiles for it, the contents of the inputs,
//! every parameter. The build script hashes all source files except
//! those that no device result depends on (`HOST_EXCLUDED` in `shaders/compile.rs`), and the
//! versions of all crates. Floats are kept bit for bit: a run writes the same bytes with and
//! without the cache, on machines whose devices and processors are alike.
//!
//! An entry is written atomically and has a checksum; damaged entries are removed and made again.
//! Several processes may share a folder. Above its size limit, the entries used longest ago are
//! removed first.

use crate::base::files::read_regular;
use crate::base::pixels::{PART_PREFIX, write_atomically};
use crate::instrument::gpu::{DeviceInfo, HOST_HASH, code_hash, shader_code};
use std::fs::{File, Metadata};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::{Duration, SystemTime};

/// Largest entry that is read, bytes: larger than any image.
const ENTRY_BYTES_MAX: u64 = 1 << 32;

/// First bytes of an entry; the digit is the version of the format.
const MAGIC: &[u8; 8] = b"splitsu1";
const CHECKSUM_LENGTH: usize = 32;
const EXTENSION: &str = "kept";
/// A full folder is emptied down to this share of its limit, so that it is not listed again for
/// each entry.
const KEPT_SHARE: f64 = 0.8;
/// Half-written files of this age are abandoned.
const PART_AGE: Duration = Duration::from_secs(24 * 3600);

#[derive(Debug)]
pub struct DiskCache {
    dir: PathBuf,
    limit_bytes: u64,
    /// Size of all entries known to this process.
    bytes: u64,
    /// The lines of every key that name the device.
    device: String,
    warnings: Vec<String>,
    /// Whether an entry could not be written; no further one is tried then.
    is_read_only: bool,
}

#[derive(Debug, thiserror::Error)]
#[error("{}: {what}; choose a folder that you may write to", dir.display())]
pub struct DiskCacheError {
    dir: PathBuf,
    what: String,
}

impl DiskCache {
    /// Opens the folder `dir` and creates it if missing; its entries take at most `limit_bytes`.
    pub fn open(dir: &Path, limit_bytes: u64) -> Result<Self, DiskCacheError> {
        std::fs::create_dir_all(dir)
            .map_err(|error| {
                if dir.exists() {
                    "not a folder".to_owned()
                } else {
                    error.to_string()
                }
            })
            .map_err(|what| DiskCacheError {
                dir: dir.to_owned(),
                what,
            })?;
        let mut cache = Self {
            dir: dir.to_owned(),
            limit_bytes,
            bytes: 0,
            device: String::new(),
            warnings: Vec::new(),
            is_read_only: false,
        };
        cache.bytes = cache
            .entries()
            .iter()
            .map(|(_, metadata)| metadata.len())
            .sum();
        cache.remove_abandoned_parts();
        cache.evict();
        Ok(cache)
    }

    /// Limits all later calls to entries of this device.
    pub fn set_device(&mut self, device: &DeviceInfo) {
        let DeviceInfo {
            name,
            driver,
            target,
            api_version,
            ..
        } = device;
        self.device += &format!("device={name}\ndriver={driver}\napi_version={api_version}\n");
        if let Some(target) = target {
            self.device += &format!("target={target}\n");
        }
    }

    /// Returns whether there is an entry of these shaders for `key`. It may be damaged.
    pub(super) fn holds(&self, shaders: &[String], key: &str) -> bool {
        self.path(&self.whole_key(shaders, key)).exists()
    }

    fn whole_key(&self, shaders: &[String], key: &str) -> String {
        format!(
            "host={HOST_HASH}\nshaders={}\n{}{key}",
            code_hash(shaders, shader_code),
            self.device
        )
    }

    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Reads the entry of these shaders for `key`; `None` if it is missing or damaged.
    pub fn load(&mut self, shaders: &[String], key: &str) -> Option<Vec<u8>> {
        let key = self.whole_key(shaders, key);
        let path = self.path(&key);
        let bytes = match read_regular(&path, ENTRY_BYTES_MAX) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return None,
            Err(error) => {
                self.warnings.push(format!(
                    "cache: {}: {error}; making its contents again",
                    path.display()
                ));
                return None;
            }
        };
        let Some(payload) = payload(bytes, &key) else {
            self.warnings.push(format!(
                "cache: {}: is damaged; making its contents again",
                path.display()
            ));
            self.remove(&path);
            return None;
        };
        // Marks it as used now. If that fails, the entry only looks older than it is.
        let _ = File::options()
            .append(true)
            .open(&path)
            .and_then(|file| file.set_modified(SystemTime::now()));
        Some(payload)
    }

    /// Keeps `payload` of these shaders under `key`. If the folder cannot be written, adds a
    /// warning.
    pub fn store(&mut self, shaders: &[String], key: &str, payload: &[u8]) {
        let key = self.whole_key(shaders, key);
        let length = (MAGIC.len() + CHECKSUM_LENGTH + 8 + key.len() + payload.len()) as u64;
        if self.is_read_only || length > self.limit_bytes {
            return;
        }
        let path = self.path(&key);
        let key_length = (key.len() as u64).to_le_bytes();
        let mut hasher = blake3::Hasher::new();
        let checksum = hasher
            .update(&key_length)
            .update(key.as_bytes())
            .update(payload)
            .finalize();
        let parts: [&[u8]; 5] = [
            MAGIC,
            checksum.as_bytes(),
            &key_length,
            key.as_bytes(),
            payload,
        ];
        match write_atomically(&path, |file| {
            parts.iter().try_for_each(|part| file.write_all(part))
        }) {
            Ok(()) => {
                self.bytes += length;
                self.evict();
            }
            Err(error) => {
                self.warnings
                    .push(format!("cache: {error}; this run keeps nothing more"));
                self.is_read_only = true;
            }
        }
    }

    /// Returns the warnings since the last call, one sentence each.
    pub fn take_warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.warnings)
    }

    fn path(&self, key: &str) -> PathBuf {
        self.dir.join(format!(
            "{}.{EXTENSION}",
            blake3::hash(key.as_bytes()).to_hex()
        ))
    }

    /// Lists every entry with its metadata. Another process may remove one at any time.
    fn entries(&self) -> Vec<(PathBuf, Metadata)> {
        let files = std::fs::read_dir(&self.dir).into_iter().flatten().flatten();
        let entries =
            files.filter(|file| file.path().extension().is_some_and(|end| end == EXTENSION));
        entries
            .filter_map(|file| Some((file.path(), file.metadata().ok()?)))
            .collect()
    }

    /// Removes the entries used longest ago if all of them take more than the limit.
    fn evict(&mut self) {
        if self.bytes <= self.limit_bytes {
            return;
        }
        // Counts again: other processes add and remove entries too.
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

    /// Removes a file; returns whether it is gone.
    fn remove(&mut self, path: &Path) -> bool {
        match std::fs::remove_file(path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                self.warnings.push(format!(
                    "cache: {}: cannot be removed ({error})",
                    path.display()
                ));
                false
            }
            _ => true,
        }
    }

    fn remove_abandoned_parts(&mut self) {
        for file in std::fs::read_dir(&self.dir).into_iter().flatten().flatten() {
            let is_part = file.file_name().to_string_lossy().starts_with(PART_PREFIX);
            let age = file
                .metadata()
                .and_then(|m| m.modified())
                .ok()
                .and_then(|time| time.elapsed().ok());
            if is_part && age.is_some_and(|age| age > PART_AGE) {
                self.remove(&file.path());
            }
        }
    }
}

/// Extracts the payload of an entry of this key; `None` if the entry is damaged.
fn payload(mut bytes: Vec<u8>, key: &str) -> Option<Vec<u8>> {
    let (magic, rest) = bytes.split_at_checked(MAGIC.len())?;
    let (checksum, body) = rest.split_at_checked(CHECKSUM_LENGTH)?;
    let (key_length, rest) = body.split_first_chunk::<8>()?;
    let is_whole = magic == MAGIC && blake3::hash(body).as_bytes() == checksum;
    let (kept_key, _) =
        rest.split_at_checked(usize::try_from(u64::from_le_bytes(*key_length)).ok()?)?;
    (is_whole && kept_key == key.as_bytes()).then(|| {
        bytes.drain(..MAGIC.len() + CHECKSUM_LENGTH + 8 + key.len());
        bytes
    })
}

/// Hashes the running program's file, once; `None` if it cannot be read.
pub fn program_hash() -> Option<&'static str> {
    static HASH: OnceLock<Option<String>> = OnceLock::new();
    let read = || {
        Some(
            blake3::hash(&std::fs::read(std::env::current_exe().ok()?).ok()?)
                .to_hex()
                .to_string(),
        )
    };
    HASH.get_or_init(read).as_deref()
}
