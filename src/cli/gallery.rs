//! `splitsum gallery`.

use super::report::AnswerFlags;
use super::{Failure, print, progress};
use clap::Args;
use splitsum::report::gallery::{INDEX_FILE, write};
use std::path::PathBuf;

/// Write a static site of published runs.
#[derive(Args, Debug)]
#[command(
    after_help = "The site needs no server and no network, and takes at most 30 MB. Copy it to any \
                  static host, or open its index.html.\n\n\
    Examples:\n  splitsum gallery --out site\n  splitsum gallery runs/quick runs/coat --out site"
)]
pub struct Arguments {
    /// Add the reports of these runs, with as many images as fit.
    #[arg(value_name = "DIR")]
    dirs: Vec<PathBuf>,
    /// Show the published runs in FOLDER.
    #[arg(long, value_name = "FOLDER", default_value = "results")]
    results: PathBuf,
    /// Write to DIR.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    progress::doing("writing the site");
    let runs = arguments
        .dirs
        .iter()
        .map(|dir| AnswerFlags::default().answered(dir))
        .collect::<Result<Vec<_>, _>>()?;
    let (bytes, notes) = write(&arguments.results, &runs, &arguments.out)?;
    let notes: String = notes.iter().map(|note| format!("{note}\n")).collect();
    print(&format!(
        "{notes}Site: {} ({:.1} MB)\n",
        arguments.out.join(INDEX_FILE).display(),
        bytes as f64 / 1e6
    ))
}
