//! Makes a run the beginning of a larger one: the folder of a run becomes that of a plan that has all of its cells.
//!
//! Cells are named by what determines them, so the records of the finished ones stand as they are; only the names of their images tell what
//! the plan sweeps. Every step can be taken twice, and until the provenance names the new plan the folder is still the run that it was: a
//! killed extension is no run lost. Timings are kept block by block: a block is a set of configurations timed in the same rounds, and one that
//! has a new member is timed anew as a whole ([`super::timed`]).

use super::{Progress, RunOptions};
use crate::experiment::plan::Plan;
use crate::files::names_in;
use crate::run::frozen::EXPERIMENT_FILE;
use crate::run::images;
use crate::run::live::LIVE_FILE;
use crate::run::provenance::{self, EXTENSIONS, now_utc};
use crate::run::store::{Extension, Store, StoreError};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// Makes a folder that holds a run of another plan of the same experiment, each of whose cells is in this one, a run of this plan.
pub(super) fn extend(plan: &Plan, options: &RunOptions, progress: &mut dyn Progress) -> Result<(), StoreError> {
    let store = Store::held(&options.dir)?;
    // Another run may have changed the folder between the check and the lock.
    let Some(extension) = store.extension(plan)? else { return Ok(()) };
    rename_images(plan, &store, &extension)?;
    freeze(plan, &store, &extension, options)?;
    remove_old_names(plan, &store)?;
    let mut words = format!(
        "extends the run of plan {}: {} of its cells are kept, {} are new",
        plan_hash(&extension.from),
        extension.kept.len(),
        plan.cells.len() - extension.kept.len()
    );
    if extension.timed_again > 0 {
        words += &format!(
            "; {} timed configurations are timed again, because those they are compared with are more now",
            extension.timed_again
        );
    }
    progress.note(&words);
    Ok(())
}

fn plan_hash(provenance: &Value) -> &str {
    provenance["plan_hash"].as_str().unwrap_or_default()
}

/// Gives the images of kept cells the names that they have in the plan, beside the old ones, and their records too.
fn rename_images(plan: &Plan, store: &Store, extension: &Extension) -> Result<(), StoreError> {
    let mut placed = BTreeSet::new();
    for cell in plan.cells.iter().filter(|cell| extension.kept.contains(&cell.id)) {
        let Some(mut record) = store.cell(&cell.id)? else { continue };
        let mut files = BTreeMap::new();
        for (old, new) in images::renames(plan, cell, record.files.keys()) {
            let (from, to) = (store.image_path(old), store.image_path(&new));
            // What is missing or changed is noticed by its hash, and made again.
            if *old != new && from.is_file() && placed.insert(new.clone()) {
                store.place(&from, &to, None)?;
            }
            files.insert(new, record.files[old].clone());
        }
        if files != record.files {
            record.files = files;
            store.write_cell(&record)?;
        }
    }
    Ok(())
}

/// Removes the images of the plan's cells that have other names than in the plan: those of this extension, or of one that was cut off.
fn remove_old_names(plan: &Plan, store: &Store) -> Result<(), StoreError> {
    let ids: BTreeSet<&str> = plan.cells.iter().flat_map(|cell| [&*cell.id, &cell.radiance, &cell.reference]).collect();
    let names: BTreeSet<String> = plan.cells.iter().flat_map(|cell| images::files(plan, cell)).collect();
    let is_old = |name: &&String| {
        !names.contains(*name) && name.split('.').any(|part| ids.contains(part)) && store.image_path(name).is_file()
    };
    names_in(&store.image_path("")).iter().filter(is_old).try_for_each(|name| store.remove_image(name))
}

/// Makes the plan that of the folder, and tells from where it came.
fn freeze(plan: &Plan, store: &Store, extension: &Extension, options: &RunOptions) -> Result<(), StoreError> {
    let (dir, from) = (store.dir(), &extension.from);
    let frozen = format!("experiment.{}.toml", plan_hash(from));
    let experiment = dir.join(EXPERIMENT_FILE);
    if experiment.is_file() {
        store.place(&experiment, &dir.join(&frozen), None)?;
    }
    // It shows the environments and models of the run, which may be more now.
    if plan.cells.len() > extension.kept.len() {
        store.remove_file(LIVE_FILE)?;
    }
    let mut value = provenance::provenance(plan, dir);
    value["sessions"] = from["sessions"].clone();
    let mut extensions = from[EXTENSIONS].as_array().cloned().unwrap_or_default();
    extensions.push(json!({
        "date_utc": now_utc(),
        "command_line": options.command_line,
        "from": {
            "plan_hash": from["plan_hash"],
            "cell_count": from["cell_count"],
            "experiment_hash": from["experiment_hash"],
            "experiment_file": from["experiment_file"],
            "overrides": from["overrides"],
            "frozen": frozen,
        },
        "cells_kept": extension.kept.len(),
        "cells_new": plan.cells.len() - extension.kept.len(),
        "timed_again": extension.timed_again,
    }));
    value[EXTENSIONS] = extensions.into();
    store.write_json(&store.provenance_path(), &value)?;
    store.write_text(&experiment, &plan.config.text)
}
