//! A finished run from the memory of the process that ran it: nothing is read back but records of bins.

use super::{Bin, CellImages, Finished, FinishedCell, Light, MetricValues, Stop};
use crate::metrics::BiasVariance;
use crate::runner::environments::lights;
use crate::runner::images::linear_files;
use crate::runner::plan::{Cell, Plan};
use crate::runner::provenance;
use crate::runner::store::{FailureRecord, Store, StoreError};
use crate::runner::tables::{CellResult, Results};
use crate::runner::timing::TimingRecord;

impl Finished {
    /// Of a plan whose run has ended with these results in `store`.
    pub fn of_run(plan: &Plan, store: &Store, results: &Results, timings: &[TimingRecord]) -> Result<Self, StoreError> {
        let failure = |cell: &Cell| match results.get(&cell.id) {
            Some(CellResult::Failed(record)) => Some(FailureRecord::clone(record)),
            _ => None,
        };
        let tried = plan.cells.iter().filter(|cell| results.contains_key(&cell.id));
        let cells = tried.map(|cell| of_cell(plan, store, results, cell)).collect::<Result<_, _>>()?;
        Ok(Self {
            dir: store.dir().to_owned(),
            provenance: provenance::read(store.dir())?.unwrap_or_default(),
            experiment: plan.config.text.clone(),
            config: Some(plan.config.clone()),
            cells,
            lights: lights(plan)
                .into_iter()
                .map(|(key, luminance)| Light {
                    environment: key[0].to_string(),
                    clip_log2: key[1].to_string(),
                    mean: luminance.mean,
                    peak: luminance.peak,
                    range_stops: luminance.range_stops(),
                })
                .collect(),
            timings: timings.to_vec(),
            failures: plan.cells.iter().filter_map(failure).collect(),
            is_under_way: false,
        })
    }
}

fn of_cell(plan: &Plan, store: &Store, results: &Results, cell: &Cell) -> Result<FinishedCell, StoreError> {
    let Some(CellResult::Done(done)) = results.get(&cell.id) else {
        return Ok(FinishedCell {
            id: cell.id.clone(),
            point: plan.shown_point(cell),
            scores: None,
            noise_floors: MetricValues::of(|_| None),
            bias_variance: None,
            reference: None,
            bins: Vec::new(),
            images: None,
        });
    };
    let bins = store.cell(&cell.id)?.map_or_else(Vec::new, |record| record.bins);
    let [radiance, reference] = linear_files(plan, cell);
    let [variance, bias] = BiasVariance::RELATIVE_NAMES.map(|name| done.bias_variance.get(name).map(|value| value.0));
    Ok(FinishedCell {
        id: cell.id.clone(),
        point: plan.shown_point(cell),
        scores: Some(MetricValues::of(|name| done.scores.get(name).map(|value| value.0))),
        noise_floors: MetricValues::of(|name| done.noise_floors.get(name).map(|value| value.0)),
        bias_variance: bias.zip(variance).map(|(bias, variance)| [bias, variance]),
        reference: done.reference.as_ref().map(|stop| Stop {
            samples: stop.samples,
            relative_error: stop.relative_error.0,
            stopped_by: stop.stopped_by,
        }),
        bins: bins
            .into_iter()
            .filter(|bin| bin.pixel_count > 0)
            .map(|bin| Bin {
                lo: bin.lo,
                hi: bin.hi,
                pixel_count: bin.pixel_count as u64,
                scores: MetricValues::of(|name| bin.scores.get(name).map(|value| value.0)),
            })
            .collect(),
        images: Some(CellImages { radiance, reference }),
    })
}
