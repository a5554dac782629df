//! Whether two records of one cell say the same.

use crate::runner::store::{CellRecord, Exact};
use std::collections::{BTreeMap, BTreeSet};

/// The columns of the tables in which two records differ, with both values, and the images whose bytes differ. The time that a cell took
/// is in none.
pub(super) fn differing_columns(a: &CellRecord, b: &CellRecord) -> Vec<String> {
    let is_other = |(name, hash): &(&String, &String)| b.files.get(*name).is_some_and(|other| other != *hash);
    let images: Vec<String> =
        a.files.iter().filter(is_other).map(|(name, _)| format!("the bytes of images/{name}")).collect();
    let (a, b) = (columns(a), columns(b));
    let names: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
    let value = |map: &BTreeMap<String, String>, name: &String| map.get(name).cloned().unwrap_or("none".to_owned());
    let differing = names.into_iter().filter(|name| a.get(*name) != b.get(*name));
    differing.map(|name| format!("{name} ({} and {})", value(&a, name), value(&b, name))).chain(images).collect()
}

/// Everything of a record that stands in a table, by column.
fn columns(record: &CellRecord) -> BTreeMap<String, String> {
    let exact = |name: String, score: &Exact| (name, String::from(*score));
    let mut columns: BTreeMap<String, String> = record.axes.clone();
    columns.extend(record.scores.iter().map(|(name, score)| exact(name.to_owned(), score)));
    columns.extend(record.bias_variance.iter().map(|(name, score)| exact(name.to_owned(), score)));
    columns.extend(record.noise_floors.iter().map(|(name, score)| exact(format!("{name}_noise_floor"), score)));
    if let Some(stop) = &record.reference {
        columns.insert("reference_samples".to_owned(), stop.samples.to_string());
        columns.extend([exact("reference_relative_error".to_owned(), &stop.relative_error)]);
        columns.insert("reference_stopped_by".to_owned(), stop.stopped_by.name().to_owned());
    }
    columns.insert("verdict".to_owned(), record.verdict.clone());
    for bin in &record.bins {
        let place = |name: &str| format!("{name} at n_dot_v {} to {}", bin.lo, bin.hi);
        columns.insert(place("pixel_count"), bin.pixel_count.to_string());
        columns.extend(bin.scores.iter().map(|(name, score)| exact(place(name), score)));
    }
    columns
}
