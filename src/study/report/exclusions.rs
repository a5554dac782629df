//! Which combinations of values the experiments leave out on purpose, so that the page can tell them from what failed, was never run, or
//! was not reached. Read from the frozen experiment files: no record of a run says it cell by cell.

use crate::runner::axis;
use crate::study::answers::run_folder::RunFolder;
use crate::study::answers::study::{RUN_AXIS, Role, Row, Study};
use serde::Serialize;
use std::collections::BTreeSet;

/// More would only make the page large; a map of so many cells shows none of them.
const POINTS_MAX: usize = 20_000;

/// Combinations without a cell.
#[derive(Debug, Default, PartialEq, Eq, Serialize)]
pub struct Exclusions {
    /// Names of the swept axes, in the order of the values.
    pub axes: Vec<String>,
    pub reasons: Vec<String>,
    /// Index of the reason, then a value for each axis as in `errors.csv`; empty where the combination does not use the axis.
    pub points: Vec<(usize, Vec<String>)>,
}

/// The exclusions of joined runs; `labels` name the runs. A file that this program does not understand any more excludes nothing.
pub fn collect(runs: &[RunFolder], labels: &[String], study: &Study) -> Exclusions {
    let swept = study.axes.iter().filter(|axis| axis.role != Role::Fixed || axis.values.len() > 1);
    let mut exclusions = Exclusions { axes: swept.map(|axis| axis.name.clone()).collect(), ..Exclusions::default() };
    // An axis of which every other value is excluded is swept in the file alone.
    for run in runs {
        for name in run.config.iter().flat_map(|config| config.axes.iter().map(|sweep| axis::AXES[sweep.axis].name)) {
            if !exclusions.axes.iter().any(|known| known == name) {
                exclusions.axes.push(name.to_owned());
            }
        }
    }
    let of_row =
        |row: &Row| -> Vec<String> { exclusions.axes.iter().map(|name| study.value(row, name).to_owned()).collect() };
    // What another combination makes is not left out: a method without samples has one cell whichever counts are excluded.
    let made: BTreeSet<Vec<String>> = study.rows.iter().map(of_row).collect();
    let mut points: BTreeSet<(usize, Vec<String>)> = BTreeSet::new();
    for (run, label) in runs.iter().zip(labels) {
        let Some(config) = &run.config else { continue };
        let first = exclusions.reasons.len();
        exclusions.reasons.extend(config.exclusions.iter().map(|exclusion| exclusion.why.clone()));
        for (index, point) in config.excluded_points() {
            let value = |name: &String| if name == RUN_AXIS { label.clone() } else { point.get(name).to_string() };
            let values: Vec<String> = exclusions.axes.iter().map(value).collect();
            if !made.contains(&values) {
                points.insert((first + index, values));
            }
            if points.len() >= POINTS_MAX {
                break;
            }
        }
    }
    exclusions.points = points.into_iter().collect();
    exclusions
}
