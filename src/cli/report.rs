//! `splitsum report`.

use super::{Failure, print, progress, shared};
use clap::Args;
use splitsum::metrics::Metric;
use splitsum::report::page::images::{BUDGET_BYTES, Choice};
use splitsum::report::page::{PAGE_FILE, PageError, PageOptions, PageRun, Written, check_out, write};
use splitsum::spelling::Listed;
use splitsum::study::finished::Finished;
use splitsum::study::frame::Frame;
use splitsum::study::questions::{Answer, answers};
use std::path::{Path, PathBuf};

/// Write the report of one or more finished runs.
#[derive(Args, Debug)]
#[command(after_help = "Several runs (two devices, two commits) share one report.\n\n\
    Examples:\n  splitsum report runs/quick\n  splitsum report runs/laptop runs/desktop --out comparison.html")]
pub struct Arguments {
    /// Report these runs.
    #[arg(required = true, value_name = "DIR")]
    dirs: Vec<PathBuf>,
    /// Link the images instead of embedding them.
    #[arg(long)]
    no_images: bool,
    /// Answer by this metric (`splitsum list metrics`) [default: the experiment's].
    #[arg(long, value_name = "NAME", value_parser = known_metric)]
    metric: Option<String>,
    /// Weigh views by these, first the leading one [default: the experiment's].
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    weights: Vec<String>,
    /// Write to FILE [default: report.html in the first folder].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Checks the value of `--metric`.
pub fn known_metric(name: &str) -> Result<String, String> {
    Metric::parse(name).map(|metric| metric.name().to_owned())
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let images = if arguments.no_images { Choice::None } else { Choice::Automatic };
    let out = arguments.out.clone().unwrap_or_else(|| arguments.dirs[0].join(PAGE_FILE));
    if let Some(out) = &arguments.out {
        shared::check_out("--out", out, &["html", "htm"], [])?;
    }
    check_out(&out)?;
    progress::doing("answering the questions");
    let runs: Vec<(Finished, Vec<Answer>)> = arguments
        .dirs
        .iter()
        .map(|dir| answered(dir, arguments.metric.as_deref(), &arguments.weights))
        .collect::<Result<_, Failure>>()?;
    let metric = arguments.metric.clone();
    let options = PageOptions { out, is_alone: false, images, budget: BUDGET_BYTES, metric };
    progress::doing("writing the report");
    print(&line(&write(&options, &PageRun::of_runs(&runs))?))
}

impl From<PageError> for Failure {
    fn from(error: PageError) -> Self {
        Self::of(error.is_misuse(), error)
    }
}

/// Reads a run and answers its questions by these weights of views, by default its own. A metric of pictures is refused
/// for a run without pictures.
pub fn answered(dir: &Path, metric: Option<&str>, weights: &[String]) -> Result<(Finished, Vec<Answer>), Failure> {
    let mut run = Finished::read(dir).map_err(Failure::input)?;
    let shown = dir.display();
    if !weights.is_empty() {
        run = run.with_weights(weights).map_err(|fault| Failure::input(format!("--weights: {shown}: {fault}")))?;
    }
    if let Some(name) = metric
        && Frame::new(&run, metric).has_no_picture()
    {
        return Err(Failure::input(format!("--metric {name}: scores pictures, and {shown} has only the scene design")));
    }
    let answers = answers(&run, metric);
    Ok((run, answers))
}

/// Describes a written report.
pub fn line(written: &Written) -> String {
    let notes: String = written.notes.iter().map(|note| format!("{note}\n")).collect();
    format!("{notes}Report: {} ({:.1} MB)\n", written.path.display(), written.bytes as f64 / 1e6)
}
