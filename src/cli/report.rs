//! `splitsum report`.

use super::{Failure, print, progress, shared};
use clap::Args;
use splitsum::base::names::Listed;
use splitsum::instrument::metrics::Metric;
use splitsum::report::page::images::{BUDGET_BYTES, Choice};
use splitsum::report::page::{
    PAGE_FILE, PageError, PageOptions, PageRun, Written, check_out, write,
};
use splitsum::study::finished::Finished;
use splitsum::study::frame::Frame;
use splitsum::study::questions::{Answer, answers};
use std::path::{Path, PathBuf};

/// Write the report of one or more finished runs.
#[derive(Args, Debug)]
#[command(
    after_help = "Several runs (two devices, two commits) share one report.\n\n\
    Examples:\n  splitsum report runs/quick\n  splitsum report runs/laptop runs/desktop --out \
    comparison.html"
)]
pub struct Arguments {
    /// Report these runs.
    #[arg(required = true, value_name = "DIR")]
    dirs: Vec<PathBuf>,
    /// Link the images instead of embedding them.
    #[arg(long)]
    no_images: bool,
    #[command(flatten)]
    answers: AnswerFlags,
    /// Write to FILE [default: report.html in the first folder].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Args, Debug, Default)]
pub struct AnswerFlags {
    /// Answer by this metric (`splitsum list metrics`) [default: the experiment's].
    #[arg(
        long,
        value_name = "NAME",
        value_parser = |name: &str| Metric::parse(name).map(|metric| metric.name().to_owned()),
    )]
    pub metric: Option<String>,
    /// Weigh views by these, first the leading one [default: the experiment's].
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    weights: Vec<String>,
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let images = if arguments.no_images {
        Choice::None
    } else {
        Choice::Automatic
    };
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| arguments.dirs[0].join(PAGE_FILE));
    if let Some(out) = &arguments.out {
        shared::check_out("--out", out, &["html", "htm"], [])?;
    }
    check_out(&out)?;
    progress::doing("answering the questions");
    let runs = arguments
        .dirs
        .iter()
        .map(|dir| arguments.answers.answered(dir))
        .collect::<Result<Vec<_>, _>>()?;
    let metric = arguments.answers.metric.clone();
    let options = PageOptions {
        out,
        is_alone: false,
        images,
        budget: BUDGET_BYTES,
        metric,
    };
    progress::doing("writing the report");
    print(&line(&write(&options, &PageRun::of_runs(&runs))?))
}

impl From<PageError> for Failure {
    fn from(error: PageError) -> Self {
        Self::by_misuse(error.is_misuse(), error)
    }
}

impl AnswerFlags {
    /// Reads a run and answers its questions, by default by its own metric and weights of views. A
    /// metric of pictures is refused for a run without pictures.
    pub fn answered(&self, dir: &Path) -> Result<(Finished, Vec<Answer>), Failure> {
        let mut run = Finished::read(dir).map_err(Failure::input)?;
        let shown = dir.display();
        let metric = self.metric.as_deref();
        if !self.weights.is_empty() {
            let fault = |fault| Failure::input(format!("--weights: {shown}: {fault}"));
            run = run.with_weights(&self.weights).map_err(fault)?;
        }
        if let Some(name) = metric.filter(|_| Frame::new(&run, metric).has_no_picture()) {
            let why =
                format!("--metric {name}: scores pictures, and {shown} has only the scene design");
            return Err(Failure::input(why));
        }
        let answers = answers(&run, metric);
        run.drop_bins();
        Ok((run, answers))
    }
}

/// Describes a written report.
pub fn line(written: &Written) -> String {
    let notes: String = written
        .notes
        .iter()
        .map(|note| format!("{note}\n"))
        .collect();
    format!(
        "{notes}Report: {} ({:.1} MB)\n",
        written.path.display(),
        written.bytes as f64 / 1e6
    )
}
