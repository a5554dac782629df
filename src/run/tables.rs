//! The rows of a run's tables, in plan order, so that the bytes do not depend on the order of work.

pub use crate::instrument::metrics::{DISPLAY_HEADLINE, HEADLINE};

use super::columns::{
    BinColumns, CELL, Columns, ErrorColumns, FAILED, PassColumns, SteadinessColumns, StepColumns,
    TimedColumns,
};
use super::results::Results;
use super::run_table::RunTable;
use super::store::{BinRecord, CellRecord, Scores, StepRecord, Store, StoreError};
use super::timing::{PassSamples, TimingRecord};
use crate::base::csv::Cell as Field;
use crate::base::math::order_statistics::{median, median_interval};
use crate::base::names::Listed;
use crate::experiment::axis::named::{columns, fields};
use crate::experiment::axis::{AXES, AxisId, FRAMES, SIZE};
use crate::experiment::plan::{Cell, Plan};
use crate::instrument::metrics::{METRICS, Metric, Pooling, linear_metrics};

/// The column of a metric's score of an exact image.
fn noise_floor_column(metric: &Metric) -> String {
    format!("{}_noise_floor", metric.name)
}

fn metric_columns() -> impl Iterator<Item = String> {
    METRICS.iter().map(|metric| metric.name.to_owned())
}

/// The columns of a table of cells: id and swept axes first, axes with one value last, and the
/// table's own between them.
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

    fn names(&self, between: impl Iterator<Item = String>) -> Vec<String> {
        let mut names = vec![CELL.name.to_owned()];
        names.extend(axis_columns(&self.first));
        names.extend(between);
        names.extend(axis_columns(&self.last));
        names
    }

    fn row(&self, cell: &Cell, between: Vec<Field>) -> Vec<Field> {
        let mut row = vec![Field::from(cell.id.to_string())];
        row.extend(self.axis_fields(cell, &self.first));
        row.extend(between);
        row.extend(self.axis_fields(cell, &self.last));
        row
    }

    fn axis_fields(&self, cell: &Cell, axes: &[AxisId]) -> impl Iterator<Item = Field> {
        axes.iter()
            .flat_map(|&axis| fields(axis, &self.plan.shown(cell, axis)))
            .map(|text| text_field(&text))
    }
}

fn axis_columns(axes: &[AxisId]) -> impl Iterator<Item = String> {
    axes.iter()
        .flat_map(|&axis| columns(axis))
        .map(str::to_owned)
}

/// `errors.csv`: one row per tried cell.
pub fn errors(
    plan: &Plan,
    results: &Results,
    store: &Store,
) -> RunTable<impl Iterator<Item = Result<Vec<Field>, StoreError>>> {
    let layout = CellColumns::new(plan);
    let has_sequences = plan.columns.contains(&FRAMES);
    let mut names: Vec<String> = metric_columns().collect();
    names.extend(linear_metrics().into_iter().map(noise_floor_column));
    names.extend(ErrorColumns::names());
    if has_sequences {
        names.extend(SteadinessColumns::names());
    }
    let columns = layout.names(names.into_iter());
    let row = move |cell: &Cell, record: Option<CellRecord>| {
        let record = record.as_ref();
        let mut between = score_and_floor_fields(record);
        between.extend(error_columns(record).fields());
        if has_sequences {
            between.extend(steadiness_columns(record).fields());
        }
        layout.row(cell, between)
    };
    let rows = plan.cells.iter().filter_map(move |cell| {
        if results.failure(cell).is_some() {
            return Some(Ok(row(cell, None)));
        }
        let record = results.is_done(cell).then(|| store.cell(cell.id))?;
        let record = record.transpose()?;
        Some(record.map(|record| row(cell, Some(record))))
    });
    RunTable { columns, rows }
}

/// Every score, then every noise floor; missing ones of a failed cell.
fn score_and_floor_fields(record: Option<&CellRecord>) -> Vec<Field> {
    let floored = linear_metrics();
    match record {
        Some(record) => {
            let mut fields = score_fields(&record.scores, METRICS);
            fields.extend(score_fields(&record.noise_floors, &floored));
            fields
        }
        None => vec![Field::Missing; METRICS.len() + floored.len()],
    }
}

fn error_columns(record: Option<&CellRecord>) -> ErrorColumns {
    let judgement = record.map(|record| &record.judgement);
    let stop = judgement.and_then(|judgement| judgement.reference.as_ref());
    ErrorColumns {
        reference_samples: stop.map(|stop| stop.samples),
        reference_relative_error: stop.map(|stop| stop.relative_error.0),
        reference_stopped_by: stop.map(|stop| stop.stopped_by.name()),
        verdict: judgement
            .map_or(FAILED, |judgement| &judgement.verdict)
            .to_owned(),
    }
}

fn steadiness_columns(record: Option<&CellRecord>) -> SteadinessColumns {
    let steadiness = record.and_then(|record| record.judgement.steadiness);
    SteadinessColumns {
        lag_bias: steadiness.map(|scores| scores.lag_bias.0),
        flicker: steadiness.map(|scores| scores.flicker.0),
    }
}

/// Rows from the records of finished cells.
fn of_records(
    plan: &Plan,
    results: &Results,
    store: &Store,
    rows: impl Fn(&Cell, CellRecord) -> Vec<Vec<Field>>,
) -> impl Iterator<Item = Result<Vec<Field>, StoreError>> {
    let done = plan.cells.iter().filter(|cell| results.is_done(cell));
    done.flat_map(move |cell| match store.cell(cell.id) {
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
) -> RunTable<impl Iterator<Item = Result<Vec<Field>, StoreError>>> {
    let layout = CellColumns::new(plan);
    let pooled: Vec<&Metric> = METRICS
        .iter()
        .copied()
        .filter(|metric| metric.pooling != Pooling::None)
        .collect();
    let floors = pooled.iter().copied().map(noise_floor_column);
    let names = BinColumns::names().chain(metric_columns()).chain(floors);
    let columns = layout.names(names);
    let bin_fields = move |bin: &BinRecord| -> Vec<Field> {
        let mut row = BinColumns {
            n_dot_v_from: bin.lo,
            n_dot_v_to: bin.hi,
            pixel_count: bin.pixel_count,
            reference_mean: bin.reference_mean.map(|mean| mean.0),
        }
        .fields();
        row.extend(score_fields(&bin.scores, METRICS));
        row.extend(score_fields(&bin.noise_floors, &pooled));
        row
    };
    let rows = of_records(plan, results, store, move |cell, record| {
        let bins = record.bins.iter().filter(|bin| bin.pixel_count > 0);
        bins.map(|bin| layout.row(cell, bin_fields(bin))).collect()
    });
    RunTable { columns, rows }
}

/// `steps.csv`: one row per finished cell, band of n·v and step. The axes are in `errors.csv`.
pub fn steps(
    plan: &Plan,
    results: &Results,
    store: &Store,
) -> RunTable<impl Iterator<Item = Result<Vec<Field>, StoreError>>> {
    let columns = std::iter::once(CELL.name.to_owned()).chain(StepColumns::names());
    let rows = of_records(plan, results, store, |cell, record| {
        let steps = record.steps.into_iter();
        steps
            .map(|step| {
                let mut row = vec![Field::from(cell.id.to_string())];
                row.extend(step_columns(step).fields());
                row
            })
            .collect()
    });
    RunTable {
        columns: columns.collect(),
        rows,
    }
}

fn step_columns(record: StepRecord) -> StepColumns {
    let numbers = record.numbers;
    StepColumns {
        n_dot_v_from: record.lo,
        n_dot_v_to: record.hi,
        step: record.step,
        share: numbers.share.0,
        share_error: numbers.share_error.0,
        rung_error: numbers.rung_error.0,
        first_in: numbers.first_in.0,
        last_out: numbers.last_out.0,
        shapley: numbers.shapley.0,
        step_error: numbers.step_error.0,
        noise: numbers.noise.0,
    }
}

/// `timings.csv`: one row per timed configuration and pass. All records have the same axes.
pub fn timings(records: &[TimingRecord]) -> RunTable<Vec<Vec<Field>>> {
    let axes: Vec<&String> = records
        .first()
        .map(|record| record.axes.keys().collect())
        .unwrap_or_default();
    let mut columns = vec![CELL.name.to_owned()];
    columns.extend(TimedColumns::names());
    columns.push(AXES[SIZE].name.to_owned());
    columns.extend(axes.iter().map(|name| name.to_string()));
    columns.extend(PassColumns::names());
    let mut rows = Vec::new();
    for record in records {
        let mut head = vec![Field::from(record.cell.to_string())];
        head.extend(
            TimedColumns {
                phase: record.phase.clone(),
                environment_size: size_text(record.environment_size),
            }
            .fields(),
        );
        head.push(Field::from(size_text(record.size)));
        head.extend(axes.iter().map(|name| text_field(&record.axes[*name])));
        for pass in &record.passes {
            let mut row = head.clone();
            row.extend(pass_columns(record, pass).fields());
            rows.push(row);
        }
    }
    RunTable { columns, rows }
}

fn pass_columns(record: &TimingRecord, pass: &PassSamples) -> PassColumns {
    let [lo, hi] = median_interval(&pass.ms);
    PassColumns {
        pass: pass.pass.clone(),
        n: pass.ms.len(),
        median_ms: median(&pass.ms),
        median_lo_ms: Some(lo).filter(|ms| ms.is_finite()),
        median_hi_ms: Some(hi).filter(|ms| ms.is_finite()),
        wall_median_ms: median(&record.wall_ms),
        passes_over_wall: record.passes_over_wall(),
        wall_check: record.wall_check(),
        device: record.device.clone(),
        device_type: record.device_type.clone(),
    }
}

fn size_text([width, height]: [u32; 2]) -> String {
    format!("{width}x{height}")
}

fn text_field(text: &str) -> Field {
    if text.is_empty() {
        Field::Missing
    } else {
        text.into()
    }
}

fn score_fields(scores: &Scores, metrics: &[&Metric]) -> Vec<Field> {
    metrics
        .iter()
        .map(|metric| scores.get(metric.name).map(|score| score.0).into())
        .collect()
}
