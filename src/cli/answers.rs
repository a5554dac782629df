//! `splitsum answers`.

use super::{Failure, print};
use clap::Args;
use splitsum::experiment::answers::publish::{publish, write_page};
use splitsum::experiment::answers::run_folder::unfinished_note;
use splitsum::experiment::answers::{Answered, AnswersError};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// (Re)computes what finished runs answer: answers/ and summary.md, from their tables alone.
#[derive(Args, Debug)]
#[command(after_help = "Needs neither a device nor the inputs of the run.\n\n\
    Examples:\n  splitsum answers runs/break-even\n  splitsum answers runs/* --publish results")]
pub struct Arguments {
    /// Folders of runs.
    #[arg(required = true, value_name = "DIR")]
    dirs: Vec<PathBuf>,
    /// Copies the small files of each run to FOLDER/NAME, and writes FOLDER/README.md with the answers of all runs there.
    #[arg(long, value_name = "FOLDER")]
    publish: Option<PathBuf>,
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let mut published = BTreeMap::new();
    for dir in &arguments.dirs {
        let failed = |error: AnswersError| match error {
            AnswersError::Run(_) => Failure::input(error),
            _ => Failure::failed(error),
        };
        if let Some(note) = unfinished_note(dir) {
            eprintln!("warning: {note}");
        }
        let answered = Answered::of_run(dir).map_err(failed)?;
        answered.write().map_err(failed)?;
        print(&format!("{}: {}\n", dir.display(), answered.record.answer.sentence))?;
        if let Some(into) = &arguments.publish {
            if let Some(other) = published.insert(answered.record.name.clone(), dir) {
                let (name, dir, other) = (&answered.record.name, dir.display(), other.display());
                return Err(Failure::BadInput(format!(
                    "{dir}: {name} was just published from {other}; expected runs of different names, since the folder there is the name"
                )));
            }
            for note in publish(dir, into).map_err(Failure::failed)? {
                print(&format!("{note}\n"))?;
            }
        }
    }
    match &arguments.publish {
        Some(into) => print(&format!("Written {}\n", write_page(into).map_err(Failure::failed)?.display())),
        None => Ok(()),
    }
}
