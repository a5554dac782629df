//! `splitsum bake`: what the precompute passes make, as files.

use super::Failure;
use clap::Args;
use std::path::PathBuf;

/// Writes prefiltered mips and DFG table of each BRDF model (EXR), SH9 (JSON) and irradiance map (EXR).
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  splitsum bake builtin:sky --out baked")]
pub struct Arguments {
    /// A builtin formula or an .hdr or .exr file.
    environment: String,
    /// Folder of the files; it is made when missing.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    Err(Failure::Failed(format!(
        "splitsum bake {} --out {}: not there yet",
        arguments.environment,
        arguments.out.display()
    )))
}
