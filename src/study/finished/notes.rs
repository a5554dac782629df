//! Oddities of a folder that keep nobody from reading it.

use super::read::{last_command, text};
use crate::run::frozen::EXPERIMENT_FILE;
use crate::run::provenance;
use crate::run::store::{Store, TIMINGS_FOLDER};
use std::path::Path;

/// Whatever is odd about the run in `dir` that does not keep it from being read.
pub fn notes(dir: &Path) -> impl Iterator<Item = String> {
    [unfinished_note(dir), experiment_note(dir), timings_note(dir)].into_iter().flatten()
}

/// A sentence when cells of the run in `dir` were not tried yet: it was stopped or killed.
/// Nothing for the files of a published run, nor for a run that is under way.
fn unfinished_note(dir: &Path) -> Option<String> {
    let provenance = provenance::read(dir).ok()??;
    let planned = provenance["cell_count"].as_u64()?;
    let count = |folder: &str| std::fs::read_dir(dir.join(folder)).map(|entries| entries.count() as u64);
    let (done, tried) = (count("cells").ok()?, count("cells").ok()? + count("failed").unwrap_or(0));
    let command = last_command(&provenance)?;
    (tried < planned && !Store::at(dir).is_under_way()).then(|| {
        let dir = dir.display();
        format!("{dir}: {done} of {planned} cells are done; to go on run the same command again: {command}")
    })
}

/// A sentence when the frozen experiment file is not the one that the provenance names, by its hash.
fn experiment_note(dir: &Path) -> Option<String> {
    let provenance = provenance::read(dir).ok()??;
    let named = provenance["experiment_hash"].as_str()?;
    let path = dir.join(EXPERIMENT_FILE);
    let what = match text(&path) {
        Ok(Some(text)) if provenance::experiment_hash(&text) == named => return None,
        Ok(None) => "is missing",
        _ => "is not the experiment that was run: it was changed or damaged since",
    };
    Some(format!("{}: {what}; the same `splitsum run` again writes it anew", path.display()))
}

/// A sentence when timing records of the run are damaged or others' under their names: they do not count.
fn timings_note(dir: &Path) -> Option<String> {
    let store = Store::at(dir);
    let ids = store.ids(TIMINGS_FOLDER);
    let unusable: Vec<&String> = ids.iter().filter(|id| !store.has_timing(id)).collect();
    let first = unusable.first()?;
    Some(format!(
        "{}: {} of {} timing records are damaged or another's and do not count, the first {first}.json; the same `splitsum run` again \
         times them anew",
        dir.join(TIMINGS_FOLDER).display(),
        unusable.len(),
        ids.len()
    ))
}
