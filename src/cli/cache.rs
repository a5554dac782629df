//! Where runs keep tables and references for later ones.

use super::tell;
use clap::Args;
use splitsum::pipeline::DiskCache;
use splitsum::run::RenderFault;
use splitsum::run::estimate::speeds::SPEEDS_FILE;
use std::env;
use std::path::PathBuf;

/// Which cache to use.
#[derive(Args, Debug)]
pub struct CacheArguments {
    /// Folder of tables and references kept for later runs; $XDG_CACHE_HOME/splitsum or ~/.cache/splitsum when left out.
    #[arg(long, value_name = "DIR", conflicts_with = "no_cache")]
    cache: Option<PathBuf>,
    /// Makes everything anew and keeps nothing for later runs.
    #[arg(long)]
    no_cache: bool,
    /// Size of the cache; what was used longest ago goes first.
    #[arg(long, value_name = "MIB", default_value_t = 2048)]
    cache_limit: u64,
}

impl CacheArguments {
    /// The file with the speeds of earlier runs, if there is to be a cache.
    pub fn speeds(&self) -> Option<PathBuf> {
        Some(self.dir()?.join(SPEEDS_FILE))
    }

    fn dir(&self) -> Option<PathBuf> {
        self.cache.clone().or_else(default_dir).filter(|_| !self.no_cache)
    }

    /// The cache, if there is to be one. A folder that was asked for must work; the default one may not.
    pub fn open(&self) -> Result<Option<DiskCache>, RenderFault> {
        let Some(dir) = self.dir() else { return Ok(None) };
        match DiskCache::open(&dir, self.cache_limit << 20) {
            Ok(cache) => Ok(Some(cache)),
            Err(error) if self.cache.is_some() => {
                Err(RenderFault { message: format!("--cache: {error}"), device_lost: false, is_input: true })
            }
            Err(error) => {
                tell(&format!("warning: cache: {error}; nothing is kept for later runs"));
                Ok(None)
            }
        }
    }
}

fn default_dir() -> Option<PathBuf> {
    let folder = |name: &str| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let base = folder("XDG_CACHE_HOME").filter(|path| path.is_absolute());
    let base = base.or_else(|| folder("LOCALAPPDATA")).or_else(|| Some(folder("HOME")?.join(".cache")))?;
    Some(base.join("splitsum"))
}
