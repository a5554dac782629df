//! The rows of a run's tables, in plan order, so that the bytes do not depend on the order of work.

pub use crate::instrument::metrics::{DISPLAY_HEADLINE, HEADLINE};

use super::columns::{
    BINS, CELL, Column, ERRORS, FAILED, STEADINESS, STEP_NUMBERS, STEPS, TIMINGS,
};
use super::store::{
    BinRecord, CellRecord, FailureRecord, KeptCell, Scores, StepRecord, Store, StoreError,
};
use super::timing::TimingRecord;
use crate::base::csv::Cell as Field;
use crate::base::math::order_statistics::{median, median_interval};
use crate::base::names::Listed;
use crate::experiment::axis::named::{columns, fields};
use crate::experiment::axis::{AXES, AxisId, FRAMES, SIZE};
use crate::experiment::plan::{Cell, Plan};
use crate::instrument::metrics::{METRICS, Pooling, linear_metrics};
use std::collections::BTreeMap;

#[derive(Clone, Debug)]
pub enum CellResult {
    Done(Box<KeptCell>),
    Failed(FailureRecord),
}

/// Results by cell id. Cells that were not tried are missing.
pub type Results = BTreeMap<String, CellResult>;

pub type Rows = (Vec<String>, Vec<Vec<Field>>);

fn names_of(columns: &[Column]) -> impl Iterator<Item = String> + '_ {
    columns.iter().map(|column| column.name.to_owned())
}

fn metric_names() -> Vec<&'static str> {
    METRICS.iter().map(|metric| metric.name).collect()
}

/// The columns of a table of cells: id and swept axes first, axes with one value last.
struct CellColumns<'p> {
    plan: &'p Plan,
    first: Vec<AxisId>,
    last: Vec<AxisId>,
}

impl<'p> CellColumns<'p> {
    fn new(plan: &'p Plan) -> Self {
        let swept: Vec<AxisId> = plan.swept().collect();
        let (first, last) = plan.columns.iter().partition(|axis| swept.contains(axis));
        Self { plan, first, last }
    }

    fn names(&self, own: impl Iterator<Item = String>) -> Vec<String> {
        let [first, last] =
            [&self.first, &self.last].map(|axes| axes.iter().flat_map(|&axis| columns(axis)));
        let head = std::iter::once(CELL.name).chain(first).map(str::to_owned);
        head.chain(own).chain(last.map(str::to_owned)).collect()
    }

    fn row(&self, cell: &Cell, own: impl Iterator<Item = Field>) -> Vec<Field> {
        let fields = |axes: &[AxisId]| -> Vec<Field> {
            let texts = axes
                .iter()
                .flat_map(|&axis| fields(axis, &self.plan.shown(cell, axis)));
            texts.map(|text| text_field(&text)).collect()
        };
        let head = std::iter::once(Field::from(cell.id.as_str())).chain(fields(&self.first));
        head.chain(own).chain(fields(&self.last)).collect()
    }
}

/// `errors.csv`: one row per tried cell.
pub fn errors(
    plan: &Plan,
    results: &Results,
) -> (
    Vec<String>,
    impl Iterator<Item = Result<Vec<Field>, StoreError>>,
) {
    let columns = CellColumns::new(plan);
    let floors = linear_metrics()
        .into_iter()
        .map(|metric| format!("{}_noise_floor", metric.name));
    let numbers = metric_names().into_iter().map(str::to_owned).chain(floors);
    let numbers: Vec<String> = numbers.collect();
    let number_count = numbers.len();
    let steadiness = if plan.columns.contains(&FRAMES) {
        STEADINESS
    } else {
        &[]
    };
    let others = &ERRORS[..ERRORS.len() - STEADINESS.len() + steadiness.len()];
    let names = columns.names(numbers.into_iter().chain(names_of(others)));
    let row = move |cell: &Cell| {
        let mut own: Vec<Field> = Vec::new();
        let mut steady = vec![Field::Missing; steadiness.len()];
        let (stop, verdict) = match results.get(&cell.id)? {
            CellResult::Done(kept) => {
                let number = |column: &Column| {
                    kept.steadiness
                        .get(column.name)
                        .map(|number| number.0)
                        .into()
                };
                steady = steadiness.iter().map(number).collect();
                let numbers = kept.scores.iter().chain(&kept.noise_floors);
                own.extend(numbers.map(|number| Field::from(*number)));
                (kept.reference.as_ref(), &*kept.verdict)
            }
            CellResult::Failed(_) => (None, FAILED),
        };
        own.resize(number_count, Field::Missing);
        own.extend([
            stop.map_or(Field::Missing, |stop| Field::Integer(stop.samples)),
            stop.map(|stop| stop.relative_error.0).into(),
            stop.map(|stop| stop.stopped_by.name()).into(),
            verdict.into(),
        ]);
        own.extend(steady);
        Some(Ok(columns.row(cell, own.into_iter())))
    };
    (names, plan.cells.iter().filter_map(row))
}

/// Rows from the records of finished cells.
fn of_records(
    plan: &Plan,
    results: &Results,
    store: &Store,
    rows: impl Fn(&Cell, CellRecord) -> Vec<Vec<Field>>,
) -> impl Iterator<Item = Result<Vec<Field>, StoreError>> {
    let done = plan
        .cells
        .iter()
        .filter(|cell| matches!(results.get(&cell.id), Some(CellResult::Done(_))));
    done.flat_map(move |cell| match store.cell(&cell.id) {
        Ok(record) => record
            .into_iter()
            .flat_map(|record| rows(cell, record))
            .map(Ok)
            .collect(),
        Err(error) => vec![Err(error)],
    })
}

/// `errors_by_n_dot_v.csv`: one row per finished cell and bin that holds pixels.
pub fn errors_by_n_dot_v(
    plan: &Plan,
    results: &Results,
    store: &Store,
) -> (
    Vec<String>,
    impl Iterator<Item = Result<Vec<Field>, StoreError>>,
) {
    let (names, columns) = (metric_names(), CellColumns::new(plan));
    let pooled: Vec<&str> = METRICS
        .iter()
        .filter(|metric| metric.pooling != Pooling::None)
        .map(|metric| metric.name)
        .collect();
    let own = names
        .iter()
        .map(|name| name.to_string())
        .chain(pooled.iter().map(|name| format!("{name}_noise_floor")));
    let heads = columns.names(names_of(BINS).chain(own));
    let rows = move |cell: &Cell, record: CellRecord| {
        let row = |bin: &BinRecord| {
            let reference_mean = bin.reference_mean.map(|mean| mean.0).into();
            let head = [
                bin.lo.into(),
                bin.hi.into(),
                Field::from(bin.pixel_count),
                reference_mean,
            ];
            let scores =
                score_fields(&bin.scores, &names).chain(score_fields(&bin.noise_floors, &pooled));
            columns.row(cell, head.into_iter().chain(scores))
        };
        record
            .bins
            .iter()
            .filter(|bin| bin.pixel_count > 0)
            .map(row)
            .collect()
    };
    (heads, of_records(plan, results, store, rows))
}

/// `steps.csv`: one row per finished cell, band of n·v and step. The axes are in `errors.csv`.
pub fn steps(
    plan: &Plan,
    results: &Results,
    store: &Store,
) -> (
    Vec<String>,
    impl Iterator<Item = Result<Vec<Field>, StoreError>>,
) {
    let names: Vec<&str> = STEP_NUMBERS.iter().map(|column| column.name).collect();
    let rows = move |cell: &Cell, record: CellRecord| {
        let row = |step: &StepRecord| {
            let head = [
                cell.id.as_str().into(),
                step.lo.into(),
                step.hi.into(),
                step.step.as_str().into(),
            ];
            head.into_iter()
                .chain(score_fields(&step.numbers, &names))
                .collect()
        };
        record.steps.iter().map(row).collect()
    };
    let heads = std::iter::once(CELL.name.to_owned())
        .chain(names_of(STEPS))
        .collect();
    (heads, of_records(plan, results, store, rows))
}

/// `timings.csv`: one row per timed configuration and pass.
pub fn timings(records: &[TimingRecord]) -> Rows {
    let axes: Vec<&String> = records
        .first()
        .map(|record| record.axes.keys().collect())
        .unwrap_or_default();
    let (before, after) = TIMINGS.split_at(2);
    let mut columns: Vec<String> = std::iter::once(CELL.name.to_owned())
        .chain(names_of(before))
        .collect();
    columns.extend(
        std::iter::once(AXES[SIZE].name.to_owned()).chain(axes.iter().map(|name| name.to_string())),
    );
    columns.extend(names_of(after));
    let mut rows = Vec::new();
    for record in records {
        let wall_ms = median(&record.wall_ms);
        for pass in &record.passes {
            let mut row: Vec<Field> =
                vec![record.cell.as_str().into(), record.phase.as_str().into()];
            let sizes = [record.environment_size, record.size];
            row.extend(sizes.map(|[w, h]| Field::Text(format!("{w}x{h}"))));
            row.extend(axes.iter().map(|name| text_field(&record.axes[*name])));
            row.extend([
                Field::from(pass.pass.as_str()),
                pass.ms.len().into(),
                median(&pass.ms).into(),
            ]);
            row.extend(
                median_interval(&pass.ms).map(|end| Some(end).filter(|end| end.is_finite()).into()),
            );
            row.extend([wall_ms, record.passes_over_wall()].map(Field::Number));
            row.extend([record.wall_check(), &record.device, &record.device_type].map(Field::from));
            rows.push(row);
        }
    }
    (columns, rows)
}

fn text_field(text: &str) -> Field {
    if text.is_empty() {
        Field::Missing
    } else {
        text.into()
    }
}

fn score_fields(scores: &Scores, names: &[&str]) -> impl Iterator<Item = Field> {
    names
        .iter()
        .map(|name| scores.get(*name).map(|score| score.0).into())
}
