//! Scores images into the record of a cell, on the host, several cells at a time.

use super::columns::UNSCORED;
use super::images::{self, STANDARD_ERROR_LAYER};
use super::renderer::RenderFault;
use super::store::{
    BinRecord, CellRecord, Exact, ReferenceStop, Scores, SteadinessScores, StepRecord, Store,
    StoreError,
};
use super::tables::HEADLINE;
use crate::base::files::content_hash;
use crate::base::names::Listed;
use crate::base::pixels::{GrayImage, PixelsError, Rgb8Image, RgbImage, exr, png};
use crate::draw::colormap::{FLIP_ERROR, RELATIVE_ERROR};
use crate::experiment::plan::{Cell, Plan};
use crate::instrument::metrics::{
    Comparison, Displayed, Epsilon, METRICS, Metric, MetricsError, N_DOT_V_BIN_EDGES, Pooling,
    ReferenceNoise, Space, linear_metrics, noise_floor, verdict,
};
use crate::instrument::pipeline::{DeviceInfo, Frame, RenderRequest};
use crate::instrument::tonemap::ToneCurve;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

#[derive(Debug)]
pub struct ReferenceImage {
    pub radiance: RgbImage,
    pub standard_error: Option<RgbImage>,
    pub mask: GrayImage,
    pub epsilon: Epsilon,
    pub stop: Option<ReferenceStop>,
    /// The frame, unless the image was read back.
    pub rendered: Option<Arc<Frame>>,
    noise_floors: OnceLock<Result<Floors, String>>,
    /// Its linear image, once written.
    file: Mutex<Option<Kept>>,
    /// The last few display images by tone curve.
    displays: Mutex<Vec<(ToneCurve, Arc<Displayed>)>>,
}

/// Name and content hash of a file of `images/`.
type Kept = (String, String);

/// Expected scores of an exact image, over all pixels and by bin of n·v. Empty if the standard
/// error is unknown.
#[derive(Clone, Debug, Default)]
struct Floors {
    whole: Scores,
    bins: Vec<Scores>,
}

/// Memory for a reference's display images, bytes; one is always kept.
const DISPLAY_BYTES: usize = 64 << 20;

impl ReferenceImage {
    pub fn of_frame(frame: Arc<Frame>, request: &RenderRequest) -> Self {
        let stop = ReferenceStop::from_terms(&frame.convergences, request.reference_error);
        let mask = GrayImage::clone(&frame.mask);
        let image = Self::new(
            frame.radiance.clone(),
            frame.standard_error.clone(),
            mask,
            request,
            stop,
        );
        Self {
            rendered: Some(frame),
            ..image
        }
    }

    /// Reads back a reference of an earlier invocation, bit for bit; `None` if it is missing or
    /// incomplete.
    pub fn read(path: &Path, request: &RenderRequest, stop: Option<ReferenceStop>) -> Option<Self> {
        let image = exr::read(path).ok()?;
        let standard_error = if request.has_reference_term() {
            stop.as_ref()?;
            let layer = exr::read_layer(path, Some(STANDARD_ERROR_LAYER)).ok()?;
            Some(layer.rgb)
        } else {
            None
        };
        let has_size = [image.rgb.width, image.rgb.height] == request.size;
        let mask = image.alpha.filter(|_| has_size)?;
        Some(Self::new(image.rgb, standard_error, mask, request, stop))
    }

    fn new(
        radiance: RgbImage,
        standard_error: Option<RgbImage>,
        mask: GrayImage,
        request: &RenderRequest,
        stop: Option<ReferenceStop>,
    ) -> Self {
        Self {
            radiance,
            standard_error,
            mask,
            epsilon: request.epsilon(),
            stop,
            rendered: None,
            noise_floors: OnceLock::new(),
            file: Mutex::default(),
            displays: Mutex::default(),
        }
    }

    /// Its linear image, written if necessary.
    fn file(&self, store: &Store, name: String) -> Result<Kept, CellFault> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        if file.is_none() {
            let write = |path: &Path| {
                self.rendered
                    .as_ref()
                    .map_or(Ok(()), |frame| images::write_radiance(path, frame))
            };
            *file = Some(keep(store, name, write)?);
        }
        Ok(file.clone().expect("it was written"))
    }

    /// Compares a test image, reusing the reference's display image.
    fn comparison<'a>(
        &'a self,
        test: &'a RgbImage,
        curve: ToneCurve,
    ) -> Result<Comparison<'a>, MetricsError> {
        let comparison = Comparison::new(test, &self.radiance, &self.mask, curve, self.epsilon)?;
        let known = || self.displays.lock().unwrap_or_else(PoisonError::into_inner);
        let ready = known()
            .iter()
            .find(|(known, _)| *known == curve)
            .map(|(_, display)| display.clone());
        if let Some(display) = ready {
            return Ok(comparison.with_reference_display(display));
        }
        let display = comparison.reference_display().clone();
        let mut known = known();
        let count_max = DISPLAY_BYTES / (Displayed::BYTES_PER_PIXEL * self.mask.data.len());
        if known.len() >= count_max.max(1) {
            known.remove(0);
        }
        known.push((curve, display));
        Ok(comparison)
    }

    /// Expected scores of an exact image, given the pixels of each bin. Computed once.
    fn noise_floors(&self, bins: &[Vec<usize>]) -> Result<Floors, String> {
        let compute = || {
            let Some(standard_error) = &self.standard_error else {
                return Ok(Floors::default());
            };
            let floors = noise_floor(&self.radiance, standard_error, &self.mask, self.epsilon);
            let floors = floors.map_err(|error| error.to_string())?;
            let whole = by_name(
                floors
                    .into_iter()
                    .filter_map(|(name, floor)| Some((name, floor?)))
                    .collect(),
            );
            let of_bin = |pixels: &Vec<usize>| {
                let noise = ReferenceNoise::of_pixels(
                    [&self.radiance, standard_error],
                    pixels,
                    self.epsilon,
                );
                let pooled = METRICS
                    .iter()
                    .filter(|metric| metric.pooling != Pooling::None && !pixels.is_empty());
                by_name(
                    pooled
                        .filter_map(|metric| Some((metric.name, metric.noise_floor(&noise)?)))
                        .collect(),
                )
            };
            Ok(Floors {
                whole,
                bins: bins.iter().map(of_bin).collect(),
            })
        };
        self.noise_floors.get_or_init(compute).clone()
    }
}

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
    steadiness: Option<SteadinessScores>,
    reference: Option<ReferenceStop>,
    verdict: String,
    bins: Vec<BinRecord>,
    files: BTreeMap<String, String>,
}

#[derive(Debug)]
pub enum CellFault {
    /// Only this cell fails.
    Cell(String),
    /// A file cannot be written: the run ends.
    Store(StoreError),
    /// The device is lost: the run ends.
    Lost(String),
}

impl From<StoreError> for CellFault {
    fn from(error: StoreError) -> Self {
        Self::Store(error)
    }
}

impl From<MetricsError> for CellFault {
    fn from(error: MetricsError) -> Self {
        Self::Cell(error.to_string())
    }
}

impl From<RenderFault> for CellFault {
    fn from(fault: RenderFault) -> Self {
        if fault.device_lost {
            Self::Lost(fault.message)
        } else {
            Self::Cell(fault.message)
        }
    }
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
            cell: cell.id.clone(),
            axes: axes
                .iter()
                .map(|(name, value)| (name.to_string(), value.to_string()))
                .collect(),
            verdict: results.verdict,
            noise_floors: results.noise_floors,
            steadiness: results.steadiness,
            reference: results.reference,
            scores: results.scores,
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
            verdict: UNSCORED.to_owned(),
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
        let floors = reference
            .noise_floors(&bin_pixels)
            .map_err(CellFault::Cell)?;
        for (bin, noise_floors) in bins.iter_mut().zip(floors.bins) {
            bin.noise_floors = noise_floors;
        }
        files.extend(self.write_pictures(judge, plan, store, &comparison)?);
        Ok(CellResults {
            verdict: verdict_name(&scores, &floors.whole),
            noise_floors: floors.whole,
            steadiness: self.steadiness(reference, curve)?,
            reference: reference.stop.clone(),
            scores,
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
        // Shared by cells and written once.
        let reference_name =
            images::reference_picture_name(plan, self.cell).expect("the cell has a reference");
        let mut files = vec![keep(store, reference_name, |path| {
            if path.exists() {
                Ok(())
            } else {
                png::write_rgb8(path, &judge.picture)
            }
        })?];
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

/// Writes a file of `images/`. If its path is not a file, only this cell fails.
fn keep(
    store: &Store,
    name: String,
    write: impl FnOnce(&Path) -> Result<(), PixelsError>,
) -> Result<Kept, CellFault> {
    let path = store.image_path(&name);
    let hash = || {
        content_hash(&path).map_err(|error| StoreError::Io {
            path: path.clone(),
            error,
        })
    };
    match write(&path).map_err(StoreError::from).and_then(|()| hash()) {
        Ok(hash) => Ok((name, hash)),
        Err(error) if error.is_of_one_place(&path) => Err(CellFault::Cell(error.to_string())),
        Err(error) => Err(CellFault::Store(error)),
    }
}

fn by_name(values: Vec<(&'static str, f64)>) -> Scores {
    values
        .into_iter()
        .map(|(name, value)| (name.to_owned(), Exact(value)))
        .collect()
}

fn verdict_name(scores: &Scores, floors: &Scores) -> String {
    let metric = Metric::listed(HEADLINE);
    match (scores.get(HEADLINE), floors.get(HEADLINE)) {
        (Some(score), Some(floor)) => verdict(metric, score.0, floor.0).name().to_owned(),
        _ => "no-noise-floor".to_owned(),
    }
}
