//! `splitsum answers`.

use super::{Failure, print, tell};
use clap::Args;
use splitsum::study::answers::publish::{PublishError, check, publish, write_page};
use splitsum::study::answers::run_folder::notes;
use splitsum::study::answers::{Answered, AnswersError};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// (Re)computes what finished runs answer: answers/ and summary.md, from their tables alone. Of a run under way it prints what the
/// finished cells answer, and writes nothing.
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
    /// Publishes in the place of a run of the same name whose plan is another one. The same plan, run anew, needs no such leave.
    #[arg(long, requires = "publish")]
    replace: bool,
}

fn publish_failure(error: PublishError) -> Failure {
    if error.is_misuse() { Failure::input(error) } else { Failure::failed(error) }
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let mut published = BTreeMap::new();
    // Before anything is written: of several runs all are published, or none.
    if let Some(into) = &arguments.publish {
        let faults: Vec<PublishError> =
            arguments.dirs.iter().filter_map(|dir| check(dir, into, arguments.replace).err()).collect();
        if !faults.is_empty() {
            let lines: Vec<String> = faults.iter().map(PublishError::to_string).collect();
            let text = lines.join("\n");
            let is_misuse = faults.iter().all(PublishError::is_misuse);
            return Err(if is_misuse { Failure::BadInput(text) } else { Failure::Failed(text) });
        }
    }
    for dir in &arguments.dirs {
        let failed = |error: AnswersError| match error {
            AnswersError::Run(_) => Failure::input(error),
            _ => Failure::failed(error),
        };
        for note in notes(dir) {
            tell(&format!("warning: {note}"));
        }
        let answered = Answered::of_run(dir).map_err(failed)?;
        if let Some(note) = &answered.under_way {
            if arguments.publish.is_some() {
                return Err(Failure::BadInput(format!("{note}; expected a finished run to publish")));
            }
            // The run writes its answers at its end, and these would come between.
            print(&format!("{}\n{note}; nothing is written before the run's end\n", answered.summary))?;
            continue;
        }
        answered.write().map_err(failed)?;
        print(&format!("{}: {}\n", dir.display(), answered.record.answer.sentence))?;
        if let Some(into) = &arguments.publish {
            if let Some(other) = published.insert(answered.record.name.clone(), dir) {
                let (name, dir, other) = (&answered.record.name, dir.display(), other.display());
                return Err(Failure::BadInput(format!(
                    "{dir}: {name} was just published from {other}; expected runs of different names, since the folder there is the name"
                )));
            }
            for note in publish(dir, into, arguments.replace).map_err(publish_failure)? {
                print(&format!("{note}\n"))?;
            }
        }
    }
    match &arguments.publish {
        Some(into) => print(&format!("Written {}\n", write_page(into).map_err(publish_failure)?.display())),
        None => Ok(()),
    }
}
