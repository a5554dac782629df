//! Scores images into the record of a cell, on the host, several cells at a time.

use super::cell_fault::CellFault;
use super::columns::UNSCORED;
use super::images;
use super::reference_image::{Kept, ReferenceImage, by_name, keep};
use super::store::{
    BinRecord, CellRecord, Exact, Judgement, Scores, SteadinessScores, StepRecord, Store,
};
use super::tables::HEADLINE;
use crate::base::names::Listed;
use crate::base::pixels::{Rgb8Image, png};
use crate::draw::colormap::{FLIP_ERROR, RELATIVE_ERROR};
use crate::experiment::plan::{Cell, Plan};
use crate::instrument::metrics::{
    Comparison, METRICS, Metric, N_DOT_V_BIN_EDGES, NoiseUse, Space, linear_metrics, verdict,
};
use crate::instrument::pipeline::{DeviceInfo, Frame};
use crate::instrument::tonemap::ToneCurve;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

#[derive(Debug)]
pub struct Rendered<'p> {
    pub cell: &'p Cell,
    pub frame: Arc<Frame>,
    /// Display image.
    pub picture: Arc<Rgb8Image>,
    /// `None` for a cell that is not scored.
    pub judge: Option<Judge>,
    pub steps: Arc<Vec<StepRecord>>,
    /// Shared by cells that differ only in the tone curve.
    pub linear: Arc<Mutex<Option<Linear>>>,
}

/// What a cell is compared with.
#[derive(Debug)]
pub struct Judge {
    pub image: Arc<ReferenceImage>,
    /// Display image.
    pub picture: Arc<Rgb8Image>,
}

/// The results of a cell that do not depend on the tone curve.
#[derive(Clone, Debug, Default)]
pub struct Linear {
    /// Linear image and, if it is scored, error map.
    files: Vec<Kept>,
    scores: Scores,
    bins: Vec<BinRecord>,
}

/// The parts of a record that depend on the reference.
#[derive(Debug, Default)]
struct CellResults {
    scores: Scores,
    noise_floors: Scores,
    judgement: Judgement,
    bins: Vec<BinRecord>,
    files: BTreeMap<String, String>,
}

impl Rendered<'_> {
    /// Scores the cell, if it has a reference, and writes its files.
    pub fn score(
        &self,
        plan: &Plan,
        store: &Store,
        device: &DeviceInfo,
    ) -> Result<CellRecord, CellFault> {
        let cell = self.cell;
        let picture = keep(store, images::picture_name(cell), |path| {
            png::write_rgb8(path, &self.picture)
        })?;
        let mut results = match &self.judge {
            Some(judge) => self.compared(judge, plan, store)?,
            None => self.unscored(store)?,
        };
        results.files.extend([picture]);
        let axes = plan.columns_of(cell);
        Ok(CellRecord {
            cell: cell.id,
            axes: axes
                .iter()
                .map(|(name, value)| (name.to_string(), value.to_string()))
                .collect(),
            scores: results.scores,
            noise_floors: results.noise_floors,
            judgement: results.judgement,
            bins: results.bins,
            steps: self.steps.to_vec(),
            device: device.name.clone(),
            driver: device.driver.clone(),
            target: device.target.clone(),
            files: results.files,
        })
    }

    /// The linear image alone.
    fn unscored(&self, store: &Store) -> Result<CellResults, CellFault> {
        let mut file = self.linear.lock().unwrap_or_else(PoisonError::into_inner);
        if file.is_none() {
            let radiance = keep(store, images::linear_file(self.cell), |path| {
                images::write_unscored(path, &self.frame)
            })?;
            *file = Some(Linear {
                files: vec![radiance],
                ..Linear::default()
            });
        }
        let files = file.iter().flat_map(|linear| linear.files.clone());
        Ok(CellResults {
            judgement: Judgement {
                verdict: UNSCORED.to_owned(),
                ..Judgement::default()
            },
            files: files.collect(),
            ..CellResults::default()
        })
    }

    /// Scores, noise floors and files of a cell with a reference.
    fn compared(
        &self,
        judge: &Judge,
        plan: &Plan,
        store: &Store,
    ) -> Result<CellResults, CellFault> {
        let cell = self.cell;
        let reference = &*judge.image;
        let curve = cell.point.settings().curve;
        let reference_name = images::reference_file(plan, cell).expect("the cell has a reference");
        let mut files = BTreeMap::from([reference.file(store, reference_name)?]);
        let comparison = reference.comparison(&self.frame.radiance, curve)?;
        let linear = self.linear(store, reference, &comparison)?;
        files.extend(linear.files);
        let mut scores = linear.scores;
        let mut bins = linear.bins;
        let display_metrics = display_metrics();
        scores.extend(by_name(comparison.evaluate(&display_metrics)));
        let display_bins = self.bins(&comparison, &display_metrics)?;
        for (bin, display) in bins.iter_mut().zip(display_bins) {
            bin.scores.extend(display.scores);
        }
        let bin_pixels = comparison.bin_pixels(&self.frame.n_dot_v, &N_DOT_V_BIN_EDGES)?;
        let bin_floors = reference.bin_floors(&bin_pixels);
        for (bin, noise_floors) in bins.iter_mut().zip(bin_floors) {
            bin.noise_floors = noise_floors;
        }
        let noise_floors = reference.noise_floors().map_err(CellFault::Cell)?;
        let noise_use = plan.config.reference.noise_use();
        files.extend(self.write_pictures(judge, plan, store, &comparison)?);
        Ok(CellResults {
            judgement: Judgement {
                steadiness: self.steadiness(reference, curve)?,
                reference: reference.stop.clone(),
                verdict: verdict_name(&scores, &noise_floors, noise_use),
            },
            scores,
            noise_floors,
            bins,
            files,
        })
    }

    /// The results that do not depend on the tone curve, with their files; made by the first cell
    /// that needs them.
    fn linear(
        &self,
        store: &Store,
        reference: &ReferenceImage,
        comparison: &Comparison,
    ) -> Result<Linear, CellFault> {
        let mut shared = self.linear.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(linear) = &*shared {
            return Ok(linear.clone());
        }
        let metrics = linear_metrics();
        let radiance = keep(store, images::linear_file(self.cell), |path| {
            images::write_radiance(path, &self.frame)
        })?;
        let errors = RELATIVE_ERROR.image(&comparison.relative_error_map(), &reference.mask);
        let errors = keep(store, images::error_name(self.cell), |path| {
            png::write_rgb8(path, &errors)
        })?;
        let linear = Linear {
            files: vec![radiance, errors],
            scores: by_name(comparison.evaluate(&metrics)),
            bins: self.bins(comparison, &metrics)?,
        };
        *shared = Some(linear.clone());
        Ok(linear)
    }

    /// Scores by bin of n·v, without noise floors.
    fn bins(
        &self,
        comparison: &Comparison,
        metrics: &[&Metric],
    ) -> Result<Vec<BinRecord>, CellFault> {
        let bins = comparison.evaluate_bins(&self.frame.n_dot_v, &N_DOT_V_BIN_EDGES, metrics)?;
        let records = bins.into_iter().map(|bin| BinRecord {
            lo: bin.lo,
            hi: bin.hi,
            pixel_count: bin.pixel_count,
            reference_mean: (bin.pixel_count > 0).then_some(Exact(bin.reference_mean)),
            scores: by_name(bin.values),
            noise_floors: Scores::default(),
        });
        Ok(records.collect())
    }

    /// Writes the display image of the reference, and the map of visible differences if the tone
    /// curve is swept.
    fn write_pictures(
        &self,
        judge: &Judge,
        plan: &Plan,
        store: &Store,
        comparison: &Comparison,
    ) -> Result<Vec<Kept>, CellFault> {
        let reference_name =
            images::reference_picture_name(plan, self.cell).expect("the cell has a reference");
        let mut files = vec![judge.image.picture(store, reference_name, &judge.picture)?];
        if images::sweeps_display(plan) {
            let flip = FLIP_ERROR.image(&comparison.flip_map(), &judge.image.mask);
            files.push(keep(store, images::flip_name(self.cell), |path| {
                png::write_rgb8(path, &flip)
            })?);
        }
        Ok(files)
    }

    /// Of a sequence of frames: its bias without noise, and its flicker.
    fn steadiness(
        &self,
        reference: &ReferenceImage,
        curve: ToneCurve,
    ) -> Result<Option<SteadinessScores>, CellFault> {
        let Some(steadiness) = &self.frame.steadiness else {
            return Ok(None);
        };
        let comparison = reference.comparison(&steadiness.without_noise, curve)?;
        let (_, lag_bias) = comparison.evaluate(&[Metric::listed(HEADLINE)])[0];
        Ok(Some(SteadinessScores {
            flicker: Exact(steadiness.flicker),
            lag_bias: Exact(lag_bias),
        }))
    }
}

fn display_metrics() -> Vec<&'static Metric> {
    METRICS
        .iter()
        .copied()
        .filter(|metric| metric.space == Space::Display)
        .collect()
}

fn verdict_name(scores: &Scores, floors: &Scores, noise_use: NoiseUse) -> String {
    let metric = Metric::listed(HEADLINE);
    match (scores.get(HEADLINE), floors.get(HEADLINE)) {
        (Some(score), Some(floor)) => {
            let verdict = verdict(metric, score.0, floor.0, noise_use);
            verdict.name().to_owned()
        }
        _ => "no-noise-floor".to_owned(),
    }
}
