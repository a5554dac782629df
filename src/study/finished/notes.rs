//! Warnings about a folder that can still be read.

use super::read::{last_command, text};
use crate::run::frozen::EXPERIMENT_FILE;
use crate::run::provenance;
use crate::run::store::{Store, TIMINGS_FOLDER};
use std::path::Path;

pub fn notes(dir: &Path) -> impl Iterator<Item = String> {
    [unfinished_note(dir), experiment_note(dir), timings_note(dir)].into_iter().flatten()
}

/// A note if the run was stopped or killed. Published folders and runs in progress have none.
fn unfinished_note(dir: &Path) -> Option<String> {
    let provenance = provenance::read(dir).ok()??;
    let planned = provenance["cell_count"].as_u64()?;
    let count = |folder: &str| std::fs::read_dir(dir.join(folder)).map(|entries| entries.count() as u64);
    let (done, tried) = (count("cells").ok()?, count("cells").ok()? + count("failed").unwrap_or(0));
    let command = last_command(&provenance)?;
    (tried < planned && !Store::at(dir).is_under_way()).then(|| {
        let dir = dir.display();
        format!("{dir}: {done} of {planned} cells are done; to continue, run: {command}")
    })
}

/// A note if the experiment file differs from the hash in the provenance.
fn experiment_note(dir: &Path) -> Option<String> {
    let provenance = provenance::read(dir).ok()??;
    let named = provenance["experiment_hash"].as_str()?;
    let path = dir.join(EXPERIMENT_FILE);
    let what = match text(&path) {
        Ok(Some(text)) if provenance::experiment_hash(&text) == named => return None,
        Ok(None) => "is missing",
        _ => "was edited or damaged after the run",
    };
    Some(format!("{}: {what}; repeat `splitsum run` to restore it", path.display()))
}

/// A note if timing records are unusable.
fn timings_note(dir: &Path) -> Option<String> {
    let store = Store::at(dir);
    let ids = store.ids(TIMINGS_FOLDER);
    let unusable: Vec<&String> = ids.iter().filter(|id| !store.has_timing(id)).collect();
    let first = unusable.first()?;
    Some(format!(
        "{}: {} of {} timing records are unusable, the first {first}.json; repeat `splitsum run` to measure them again",
        dir.join(TIMINGS_FOLDER).display(),
        unusable.len(),
        ids.len()
    ))
}
