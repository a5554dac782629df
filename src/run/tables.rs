//! The rows of a run's tables, in plan order, so that the bytes do not depend on the order of work.

pub use crate::metrics::{DISPLAY_HEADLINE, HEADLINE};

use super::columns::{BINS, CELL, Column, ERRORS, FAILED, RATIOS, STEP_NUMBERS, STEPS, TIMINGS};
use super::host::UNKNOWN;
use super::statistics::median;
use super::store::{BinRecord, FailureRecord, KeptCell, ReferenceStop, Scores, StepRecord, Store, StoreError};
use super::timing::{Key, TimingRecord, summarize, swept_axes};
use super::timing_ratios::{Ratio, ratios};
use crate::experiment::axis::named::{columns, fields};
use crate::experiment::axis::{AXES, METHOD, SAMPLES, SIZE};
use crate::experiment::plan::{Cell, Plan};
use crate::metrics::{BiasVariance, METRICS, linear_metrics};
use crate::table::csv::Cell as Field;
use std::collections::BTreeMap;

/// The result of a cell that was tried.
#[derive(Clone, Debug)]
pub enum CellResult {
    Done(Box<KeptCell>),
    Failed(FailureRecord),
}

/// Results by cell id.
pub type Results = BTreeMap<String, CellResult>;

/// Metrics whose noise floor stands in the table: those of linear values.
fn floored_names() -> Vec<&'static str> {
    linear_metrics().iter().map(|metric| metric.description().name).collect()
}

/// How the diffuse term is weighted beside a specular one, the same in every method and in the reference: `1 - (f0 A + B)` of the
/// DFG table (see `shaders/lib/diffuse.glsl`).
pub const DIFFUSE_WEIGHT: &str = "one-minus-directional-albedo";

/// Where a cell's reference stopped: see [`ReferenceStop`].
pub const REFERENCE_COLUMNS: [&str; 3] = ["reference_samples", "reference_relative_error", "reference_stopped_by"];

fn stop_fields(stop: Option<&ReferenceStop>) -> [Field; 3] {
    stop.map_or([Field::Missing, Field::Missing, Field::Missing], |stop| {
        [Field::Integer(stop.samples), stop.relative_error.0.into(), stop.stopped_by.name().into()]
    })
}

fn names_of(columns: &[Column]) -> impl Iterator<Item = String> + '_ {
    columns.iter().map(|column| column.name.to_owned())
}

/// Names of all metrics in column order.
fn metric_names() -> Vec<&'static str> {
    METRICS.iter().map(|metric| metric.description().name).collect()
}

/// Columns and rows of a table.
pub type Rows = (Vec<String>, Vec<Vec<Field>>);

/// `errors.csv`: one row a cell that was tried.
pub fn errors(plan: &Plan, results: &Results) -> (Vec<String>, impl Iterator<Item = Result<Vec<Field>, StoreError>>) {
    let names = metric_names();
    let [first, last] = parted(plan);
    let mut columns: Vec<String> = std::iter::once(CELL.name.to_owned()).chain(axis_columns(&first)).collect();
    columns.extend(names.iter().map(|name| name.to_string()));
    let floored = floored_names();
    columns.extend(BiasVariance::NAMES.map(str::to_owned));
    columns.extend(floored.iter().map(|name| format!("{name}_noise_floor")));
    columns.extend(names_of(&ERRORS[BiasVariance::NAMES.len()..]).chain(axis_columns(&last)));
    let number_count = names.len() + BiasVariance::NAMES.len() + floored.len();
    let row = move |cell: &Cell| {
        let mut row = [vec![Field::from(cell.id.as_str())], axis_fields(plan, &first, cell)].concat();
        let (stop, verdict) = match results.get(&cell.id)? {
            CellResult::Done(kept) => {
                let numbers = kept.scores.iter().chain(&kept.bias_variance).chain(&kept.noise_floors);
                row.extend(numbers.map(|number| Field::from(*number)));
                (kept.reference.as_ref(), &*kept.verdict)
            }
            CellResult::Failed(_) => {
                row.extend(std::iter::repeat_n(Field::Missing, number_count));
                (None, FAILED)
            }
        };
        row.extend(stop_fields(stop));
        row.extend([verdict, DIFFUSE_WEIGHT].map(Field::from));
        row.extend(axis_fields(plan, &last, cell));
        Some(Ok(row))
    };
    (columns, plan.cells.iter().filter_map(row))
}

/// `errors_by_n_dot_v.csv`: one row a finished cell and bin that holds pixels, from the records on disk.
pub fn errors_by_n_dot_v(
    plan: &Plan,
    results: &Results,
    store: &Store,
) -> (Vec<String>, impl Iterator<Item = Result<Vec<Field>, StoreError>>) {
    let names = metric_names();
    let [first, last] = parted(plan);
    let mut columns: Vec<String> = std::iter::once(CELL.name.to_owned()).chain(axis_columns(&first)).collect();
    columns.extend(names_of(BINS));
    columns.extend(names.iter().map(|name| name.to_string()).chain(axis_columns(&last)));
    let done = plan.cells.iter().filter(|cell| matches!(results.get(&cell.id), Some(CellResult::Done(_))));
    let rows = move |cell: &Cell| {
        let bins = store.cell(&cell.id).map(|record| record.map_or_else(Vec::new, |record| record.bins));
        let row = |bin: BinRecord| {
            let mut row = [vec![Field::from(cell.id.as_str())], axis_fields(plan, &first, cell)].concat();
            row.extend([bin.lo.into(), bin.hi.into(), Field::Integer(bin.pixel_count as u64)]);
            row.extend(score_fields(&bin.scores, &names));
            row.extend(axis_fields(plan, &last, cell));
            Ok(row)
        };
        match bins {
            Ok(bins) => bins.into_iter().filter(|bin| bin.pixel_count > 0).map(row).collect(),
            Err(error) => vec![Err(error)],
        }
    };
    (columns, done.flat_map(rows))
}

/// `steps.csv`: one row a finished cell, band of n·v and step, from the records on disk. The axes are those of the cell in `errors.csv`.
pub fn steps(
    plan: &Plan,
    results: &Results,
    store: &Store,
) -> (Vec<String>, impl Iterator<Item = Result<Vec<Field>, StoreError>>) {
    let columns = std::iter::once(CELL.name.to_owned()).chain(names_of(STEPS)).collect();
    let done = plan.cells.iter().filter(|cell| matches!(results.get(&cell.id), Some(CellResult::Done(_))));
    let names: Vec<&str> = STEP_NUMBERS.iter().map(|column| column.name).collect();
    let rows = move |cell: &Cell| {
        let steps = store.cell(&cell.id).map(|record| record.map_or_else(Vec::new, |record| record.steps));
        let row = |step: StepRecord| {
            let head = [cell.id.as_str().into(), step.lo.into(), step.hi.into(), step.step.as_str().into()];
            Ok(head.into_iter().chain(score_fields(&step.numbers, &names)).collect())
        };
        match steps {
            Ok(steps) => steps.into_iter().map(row).collect(),
            Err(error) => vec![Err(error)],
        }
    };
    (columns, done.flat_map(rows))
}

/// `timings.csv`: one row a timed configuration and pass.
pub fn timings(records: &[TimingRecord]) -> Rows {
    let axes: Vec<&String> = records.first().map(|record| record.axes.keys().collect()).unwrap_or_default();
    let (before, after) = TIMINGS.split_at(2);
    let mut columns: Vec<String> = std::iter::once(CELL.name.to_owned()).chain(names_of(before)).collect();
    columns.extend(std::iter::once(AXES[SIZE].name.to_owned()).chain(axes.iter().map(|name| name.to_string())));
    columns.extend(names_of(after));
    let mut rows = Vec::new();
    for record in records {
        let wall_ms = median(&record.wall_ms);
        for pass in &record.passes {
            let s = summarize(&pass.ms);
            let mut row: Vec<Field> = vec![record.cell.as_str().into(), record.phase.as_str().into()];
            let sizes = [record.environment_size, record.size];
            row.extend(sizes.map(|[w, h]| Field::Text(format!("{w}x{h}"))));
            row.extend(axes.iter().map(|name| text_field(&record.axes[*name])));
            row.extend([Field::from(pass.pass.as_str()), Field::Integer(s.n as u64)]);
            let numbers = [s.median, s.mad, s.p05, s.p95, s.min, wall_ms, record.passes_over_wall()];
            row.extend(numbers.map(Field::Number));
            row.extend([record.wall_check(), &record.device, &record.device_type].map(Field::from));
            row.extend(s.interval.map(finite));
            row.extend([finite(record.drift_percent_per_min(pass)), text_field(&record.flags(pass))]);
            let known = |number: Option<f64>| number.map_or_else(|| UNKNOWN.into(), Field::Number);
            row.extend(record.host.each_ref().map(|host| known(host.clock_mhz(&record.device_type))));
            let load = record.host[0].load_average.as_ref().and_then(|load| load.first().copied());
            row.extend([text_field(&record.slowdown()), known(load)]);
            rows.push(row);
        }
    }
    (columns, rows)
}

/// `timing_ratios.csv`: one row for each pair of methods that was timed in the same rounds ([`ratios`]).
pub fn timing_ratios(records: &[TimingRecord]) -> Rows {
    let pairs: Vec<(Ratio, Key)> = ratios(records).into_iter().map(|pair| (pair.clone(), pair.key())).collect();
    let named = AXES.iter().filter(|axis| axis.frames_cost && !axis.is_compared).map(|axis| axis.name);
    let mut axes: Vec<&str> = std::iter::once(AXES[SIZE].name).chain(named).collect();
    let swept = swept_axes(pairs.iter().map(|(_, key)| key));
    axes.extend(swept.into_iter().filter(|name| !axes.contains(name)).collect::<Vec<_>>());
    let (before, after) = RATIOS.split_at(1);
    let columns = names_of(before).chain(axes.iter().map(|name| name.to_string())).chain(names_of(after)).collect();
    let row = |(pair, key): &(Ratio, Key)| {
        let [width, height] = pair.sampled.environment_size;
        let mut row = vec![Field::Text(format!("{width}x{height}"))];
        row.extend(axes.iter().map(|axis| text_field(key.get(*axis).map_or("", String::as_str))));
        row.extend([METHOD, SAMPLES].map(|axis| text_field(pair.sampled.value(axis))));
        row.push(text_field(pair.fixed.value(METHOD)));
        row.extend([pair.ratio, pair.interval[0], pair.interval[1]].map(finite));
        row.push(Field::Integer(pair.rounds as u64));
        row.extend([&pair.sampled.device, &pair.sampled.device_type].map(|text| Field::from(text.as_str())));
        row
    };
    (columns, pairs.iter().map(row).collect())
}

/// A number, or nothing where it is not defined.
fn finite(number: f64) -> Field {
    Some(number).filter(|number| number.is_finite()).into()
}

/// The axes of a plan in the order of its file: those that tell cells apart, and those with one value, whose columns come last.
fn parted(plan: &Plan) -> [Vec<usize>; 2] {
    let swept: Vec<usize> = plan.swept().collect();
    let (first, last) = plan.columns.iter().partition(|axis| swept.contains(axis));
    [first, last]
}

fn axis_columns(axes: &[usize]) -> impl Iterator<Item = String> {
    axes.iter().flat_map(|&axis| columns(axis)).map(str::to_owned)
}

fn axis_fields(plan: &Plan, axes: &[usize], cell: &Cell) -> Vec<Field> {
    let values = axes.iter().flat_map(|&axis| fields(axis, &plan.shown(cell, axis)));
    values.map(|text| text_field(&text)).collect()
}

fn text_field(text: &str) -> Field {
    if text.is_empty() { Field::Missing } else { text.into() }
}

fn score_fields(scores: &Scores, names: &[&str]) -> Vec<Field> {
    names.iter().map(|name| scores.get(*name).map(|score| score.0).into()).collect()
}
