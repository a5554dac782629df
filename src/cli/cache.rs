//! Flags for the cache of tables and references.

use super::log;
use clap::Args;
use splitsum::instrument::pipeline::DiskCache;
use splitsum::run::RenderFault;
use std::env;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub struct CacheArguments {
    /// Keep tables and references in DIR [default: ~/.cache/splitsum].
    #[arg(long, value_name = "DIR", conflicts_with = "no_cache")]
    cache: Option<PathBuf>,
    /// Compute everything again and keep nothing.
    #[arg(long)]
    no_cache: bool,
    /// Limit the cache's size, dropping the least recently used.
    #[arg(long, value_name = "MIB", default_value = "2048", value_parser = parse_mib)]
    cache_limit: u64,
}

fn parse_mib(text: &str) -> Result<u64, String> {
    text.parse()
        .map_err(|_| format!("{text:?} is not a whole number of MiB, such as 2048"))
}

impl CacheArguments {
    fn dir(&self) -> Option<PathBuf> {
        self.cache
            .clone()
            .or_else(default_dir)
            .filter(|_| !self.no_cache)
    }

    /// Opens the cache, if any. Failure is an error only for a folder that the user chose.
    pub fn open(&self) -> Result<Option<DiskCache>, RenderFault> {
        let Some(dir) = self.dir() else {
            return Ok(None);
        };
        match DiskCache::open(&dir, self.cache_limit << 20) {
            Ok(cache) => Ok(Some(cache)),
            Err(error) if self.cache.is_some() => Err(RenderFault {
                message: format!("--cache: {error}"),
                device_lost: false,
                is_input: true,
            }),
            Err(error) => {
                log(&format!(
                    "warning: cache: {error}; nothing is kept for later runs"
                ));
                Ok(None)
            }
        }
    }
}

fn default_dir() -> Option<PathBuf> {
    let folder = |name: &str| {
        env::var_os(name)
            .filter(|value| !value.is_empty())
            .map(PathBuf::from)
    };
    let base = folder("XDG_CACHE_HOME").filter(|path| path.is_absolute());
    let base = base
        .or_else(|| folder("LOCALAPPDATA"))
        .or_else(|| Some(folder("HOME")?.join(".cache")))?;
    Some(base.join("splitsum"))
}
