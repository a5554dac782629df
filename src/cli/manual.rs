//! `splitsum manual`.

use super::{Failure, print};
use clap::{Args, Command, ValueEnum};
use clap_complete::{Shell, generate_to};
use std::path::PathBuf;

/// Write man pages and shell completions.
#[derive(Args, Debug)]
#[command(after_help = "For bash, elvish, fish, PowerShell and zsh.\n\n\
    Examples:\n  splitsum manual --out manual\n  man manual/splitsum-run.1\n  source \
    manual/splitsum.bash")]
pub struct Arguments {
    /// Write to DIR.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub fn execute(arguments: &Arguments, mut command: Command) -> Result<(), Failure> {
    let out = &arguments.out;
    let write = || {
        std::fs::create_dir_all(out)?;
        for shell in Shell::value_variants() {
            generate_to(*shell, &mut command, "splitsum", out)?;
        }
        clap_mangen::generate_to(command, out)
    };
    write().map_err(|error: std::io::Error| {
        Failure::input(format!("--out: {}: {error}", out.display()))
    })?;
    print(&format!("Written to {}\n", out.display()))
}
