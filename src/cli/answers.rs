//! `splitsum answers`.

use super::report::{AnswerFlags, line};
use super::{Failure, print, progress};
use clap::Args;
use splitsum::report::blocks::fill_pages;
use splitsum::report::page::{PageOptions, PageRun, is_page, write};
use splitsum::report::publish::{PublishError, check, publish, write_page};
use splitsum::report::write::Written;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Answer the questions of finished runs again, from their tables.
#[derive(Args, Debug)]
#[command(
    after_help = "Needs neither a device nor the run's inputs. Answers, summary and report in the \
                  folder of a finished run are replaced.\n\n\
    Examples:\n  splitsum answers runs/break-even\n  splitsum answers runs/break-even --metric \
    flip\n  \
    splitsum answers runs/* --publish results"
)]
pub struct Arguments {
    /// Answer these runs.
    #[arg(required = true, value_name = "DIR")]
    dirs: Vec<PathBuf>,
    #[command(flatten)]
    answers: AnswerFlags,
    /// Copy each run's tables to FOLDER/NAME; update README.md and docs/ next to it.
    #[arg(long, value_name = "FOLDER")]
    publish: Option<PathBuf>,
    /// Replace a published run of another plan.
    #[arg(long, requires = "publish")]
    replace: bool,
}

impl From<PublishError> for Failure {
    fn from(error: PublishError) -> Self {
        Self::by_misuse(error.is_misuse(), error)
    }
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(into) = &arguments.publish {
        check_all(&arguments.dirs, into, arguments.replace)?;
    }
    let mut published = BTreeMap::new();
    for dir in &arguments.dirs {
        progress::doing(format!("answering the questions of {}", dir.display()));
        let (run, answers) = arguments.answers.answered(dir)?;
        let written = Written::new(&run, &answers).map_err(Failure::failed)?;
        let is_new = written.write().map_err(Failure::failed)?;
        print(&format!(
            "{}: {}\n",
            dir.display(),
            written.record.headline()
        ))?;
        // All files of a run use one metric.
        let options = PageOptions {
            metric: arguments.answers.metric.clone(),
            ..PageOptions::in_folder(dir)
        };
        if is_new && is_page(&options.out) {
            print(&line(&write(
                &options,
                &PageRun::of_runs(&[(run, answers)]),
            )?))?;
        }
        if let Some(into) = &arguments.publish {
            publish_one(
                &written.record.name,
                dir,
                into,
                arguments.replace,
                &mut published,
            )?;
        }
    }
    let Some(into) = &arguments.publish else {
        return Ok(());
    };
    let pages = [vec![write_page(into)?], fill_pages(into)?].concat();
    let names = pages.iter().map(|path| path.display().to_string());
    print(&format!(
        "Written {}\n",
        names.collect::<Vec<_>>().join(", ")
    ))
}

/// Fails if one of the runs cannot be published: publishes all or none.
fn check_all(dirs: &[PathBuf], into: &Path, replace: bool) -> Result<(), Failure> {
    let faults: Vec<PublishError> = dirs
        .iter()
        .filter_map(|dir| check(dir, into, replace).err())
        .collect();
    if faults.is_empty() {
        return Ok(());
    }
    let lines: Vec<String> = faults.iter().map(PublishError::to_string).collect();
    let is_misuse = faults.iter().all(PublishError::is_misuse);
    Err(Failure::by_misuse(is_misuse, lines.join("\n")))
}

fn publish_one<'a>(
    name: &str,
    dir: &'a Path,
    into: &Path,
    replace: bool,
    published: &mut BTreeMap<String, &'a Path>,
) -> Result<(), Failure> {
    if let Some(other) = published.insert(name.to_owned(), dir) {
        return Err(Failure::input(format!(
            "{}: {name} is already published from {}; expected runs of different names",
            dir.display(),
            other.display()
        )));
    }
    publish(dir, into, replace)?
        .iter()
        .try_for_each(|note| print(&format!("{note}\n")))
}
