//! The rows of one or more runs as one table, with the part that each axis plays.

use super::run_folder::RunFolder;
use crate::experiment::axis::AXES;
use crate::experiment::timing::{FRAME, TimingRecord, summarize};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// What an axis tells apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// One value only.
    Fixed,
    /// Rows with different values have different references.
    Scene,
    /// Ways to make the image of one reference.
    Variant,
    /// Tone curve: the linear image is the same.
    Display,
}

/// An axis of the joined table.
#[derive(Clone, Debug, Serialize)]
pub struct StudyAxis {
    pub name: String,
    pub role: Role,
    /// Distinct values in row order; an unset value is empty.
    pub values: Vec<String>,
}

/// One cell of a run.
#[derive(Clone, Debug)]
pub struct Row {
    pub run: usize,
    pub cell: String,
    /// Values by axis index.
    pub axes: Vec<String>,
    /// The headline metric; `None` for a failed cell.
    pub error: Option<f64>,
    pub noise_floor: Option<f64>,
    pub verdict: String,
    pub frame_ms: Option<FrameTime>,
}

/// Time of a frame over the rounds, ms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameTime {
    pub median: f64,
    pub p05: f64,
    pub p95: f64,
    /// 95 % interval of the median by resampling; NaN (in JSON null) below two rounds.
    pub interval: [f64; 2],
    pub n: usize,
}

/// Joined runs.
#[derive(Debug)]
pub struct Study {
    pub axes: Vec<StudyAxis>,
    pub rows: Vec<Row>,
}

/// The axis that tells joined runs apart.
pub const RUN_AXIS: &str = "run";
/// The metric that answers and plots use.
pub const HEADLINE: &str = "relmse_eps1e-2";

impl Study {
    /// Joins runs; `labels` name them, one each.
    pub fn new(runs: &[RunFolder], labels: &[String]) -> Self {
        let mut names: Vec<String> = vec![RUN_AXIS.to_owned()];
        for run in runs {
            let columns = run.errors.columns.iter().filter(|name| AXES.iter().any(|axis| axis.name == *name));
            let new: Vec<String> = columns.filter(|name| !names.contains(name)).cloned().collect();
            names.extend(new);
        }
        let rows: Vec<Row> = (0..runs.len()).flat_map(|run| rows_of(&runs[run], run, &labels[run], &names)).collect();
        let axes = names
            .iter()
            .enumerate()
            .map(|(index, name)| {
                let mut seen = BTreeSet::new();
                let values: Vec<String> =
                    rows.iter().map(|row| &row.axes[index]).filter(|value| seen.insert(*value)).cloned().collect();
                StudyAxis { name: name.clone(), role: role(runs, &rows, index, name, &values), values }
            })
            .collect();
        Self { axes, rows }
    }

    /// The index of an axis.
    pub fn axis(&self, name: &str) -> Option<usize> {
        self.axes.iter().position(|axis| axis.name == name)
    }

    /// The value of a row on an axis; empty when the axis is unknown or unset.
    pub fn value<'r>(&self, row: &'r Row, name: &str) -> &'r str {
        self.axis(name).map_or("", |index| &row.axes[index])
    }

    /// Swept axes that tell cases apart: all but method, samples and the tone curve.
    pub fn case_axes(&self) -> Vec<usize> {
        let is_case = |axis: &StudyAxis| {
            matches!(axis.role, Role::Scene | Role::Variant) && !["method", "samples"].contains(&axis.name.as_str())
        };
        (0..self.axes.len()).filter(|&index| is_case(&self.axes[index])).collect()
    }
}

fn rows_of(folder: &RunFolder, run: usize, label: &str, names: &[String]) -> Vec<Row> {
    let table = &folder.errors;
    let place = |name: &str| table.columns.iter().position(|column| column == name);
    let places: Vec<Option<usize>> = names.iter().map(|name| place(name)).collect();
    let [cell, error, floor, verdict] = ["cell", HEADLINE, &format!("{HEADLINE}_noise_floor"), "verdict"].map(place);
    let text = |fields: &[String], column: Option<usize>| column.map_or_else(String::new, |c| fields[c].clone());
    let row = |fields: &Vec<String>| {
        let axes: Vec<String> = names
            .iter()
            .zip(&places)
            .map(|(name, place)| if name == RUN_AXIS { label.to_owned() } else { text(fields, *place) })
            .collect();
        Row {
            run,
            cell: text(fields, cell),
            error: text(fields, error).parse().ok(),
            noise_floor: text(fields, floor).parse().ok(),
            verdict: text(fields, verdict),
            frame_ms: frame_time(&folder.timings, names, &axes, &text(fields, cell)),
            axes,
        }
    };
    table.rows.iter().map(row).collect()
}

/// The timed configuration that a row belongs to: the axes that a record names are all the row's.
fn frame_time(timings: &[TimingRecord], names: &[String], axes: &[String], cell: &str) -> Option<FrameTime> {
    let own: BTreeMap<&str, &str> = names.iter().map(String::as_str).zip(axes.iter().map(String::as_str)).collect();
    let fits = |record: &&TimingRecord| {
        let named = record.axes.iter().filter(|(_, value)| !value.is_empty());
        record.phase == FRAME && named.into_iter().all(|(name, value)| own.get(name.as_str()) == Some(&value.as_str()))
    };
    let mut fitting = timings.iter().filter(fits);
    let first = fitting.next()?;
    let record = if first.cell == cell { first } else { fitting.find(|record| record.cell == cell).unwrap_or(first) };
    let s = summarize(&record.sums_ms());
    s.median.is_finite().then_some(FrameTime { median: s.median, p05: s.p05, p95: s.p95, interval: s.interval, n: s.n })
}

fn role(runs: &[RunFolder], rows: &[Row], index: usize, name: &str, values: &[String]) -> Role {
    // Unset is not a value: a method that does not use the axis leaves it empty.
    if values.iter().filter(|value| !value.is_empty()).count() < 2 && name != "method" {
        return Role::Fixed;
    }
    if AXES.iter().any(|axis| axis.name == name && !axis.changes_radiance) {
        return Role::Display;
    }
    if ["method", "samples", RUN_AXIS].contains(&name) {
        return Role::Variant;
    }
    let mut value_of: BTreeMap<(usize, &str), &str> = BTreeMap::new();
    for row in rows.iter().filter(|row| !row.axes[index].is_empty()) {
        if let Some(images) = runs[row.run].images.get(&row.cell) {
            let value = &row.axes[index];
            if *value_of.entry((row.run, &images.reference)).or_insert(value) != value {
                return Role::Variant;
            }
        }
    }
    Role::Scene
}
