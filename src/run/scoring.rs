//! From images to the record of a cell. Pure host work: it runs beside the device, several cells at a time.

use super::images::{self, STANDARD_ERROR_LAYER};
use super::renderer::RenderFault;
use super::store::{BinRecord, CellRecord, Exact, ReferenceStop, Scores, Spent, StepRecord, Store, StoreError};
use super::tables::HEADLINE;
use crate::experiment::plan::{Cell, Plan};
use crate::files::content_hash;
use crate::metrics::{
    BiasVariance, BinRow, Comparison, Displayed, Epsilon, METRICS, Metric, MetricsError, N_DOT_V_BIN_EDGES, Space,
    linear_metrics, noise_floor, verdict,
};
use crate::pipeline::{DeviceInfo, Frame, RenderRequest};
use crate::pixels::{GrayImage, PixelsError, Rgb8Image, RgbImage, exr, png};
use crate::spelling::Listed;
use crate::table::colormap::{FLIP_ERROR, RELATIVE_ERROR};
use crate::tonemap::ToneCurve;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Instant;

/// The reference of a cell.
#[derive(Debug)]
pub struct ReferenceImage {
    pub radiance: RgbImage,
    pub standard_error: Option<RgbImage>,
    pub mask: GrayImage,
    /// Of its light.
    pub epsilon: Epsilon,
    /// Where it stopped, unless its method does not stop by itself.
    pub stop: Option<ReferenceStop>,
    /// The frame itself, unless the image was read back from an earlier invocation.
    pub rendered: Option<Arc<Frame>>,
    noise_floors: OnceLock<Result<Scores, String>>,
    /// Name and content hash of its linear image, once that is written.
    file: Mutex<Option<Kept>>,
    /// Its display images by tone curve; of the last few, since a sweep takes them one after the other.
    displays: Mutex<Vec<(ToneCurve, Arc<Displayed>)>>,
}

/// Name and content hash of a file of `images/`.
type Kept = (String, String);

/// Memory for what is kept of a reference's display images, bytes; one is kept whatever its size.
const DISPLAY_BYTES: usize = 64 << 20;

impl ReferenceImage {
    /// The reference that was just rendered.
    pub fn of_frame(frame: Arc<Frame>, request: &RenderRequest) -> Self {
        Self {
            stop: ReferenceStop::of(&frame.convergences, request.reference_error),
            epsilon: request.epsilon(),
            radiance: frame.radiance.clone(),
            standard_error: frame.standard_error.clone(),
            mask: GrayImage::clone(&frame.mask),
            rendered: Some(frame),
            noise_floors: OnceLock::new(),
            file: Mutex::default(),
            displays: Mutex::default(),
        }
    }

    /// The reference that an earlier invocation wrote, bit for bit; `None` when it is not there or not whole. `stop` is what it left
    /// beside the image.
    pub fn read(path: &Path, request: &RenderRequest, stop: Option<ReferenceStop>) -> Option<Self> {
        let image = exr::read(path).ok()?;
        let standard_error = match request.has_reference_term() {
            true if stop.is_none() => return None,
            true => Some(exr::read_layer(path, Some(STANDARD_ERROR_LAYER)).ok()?.rgb),
            false => None,
        };
        let has_size = [image.rgb.width, image.rgb.height] == request.size;
        let mask = image.alpha.filter(|_| has_size)?;
        Some(Self {
            radiance: image.rgb,
            standard_error,
            mask,
            epsilon: request.epsilon(),
            stop,
            rendered: None,
            noise_floors: OnceLock::new(),
            file: Mutex::default(),
            displays: Mutex::default(),
        })
    }

    /// Its linear image, written unless an earlier invocation did that.
    fn file(&self, store: &Store, name: String) -> Result<Kept, CellFault> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        if file.is_none() {
            let write =
                |path: &Path| self.rendered.as_ref().map_or(Ok(()), |frame| images::write_radiance(path, frame));
            *file = Some(keep(store, name, write)?);
        }
        Ok(file.clone().expect("it was written"))
    }

    /// The comparison with a test image, which finds the reference's display image ready where another one made it.
    fn comparison<'a>(&'a self, test: &'a RgbImage, curve: ToneCurve) -> Result<Comparison<'a>, MetricsError> {
        let comparison = Comparison::new(test, &self.radiance, &self.mask, curve, self.epsilon)?;
        // A thread that panicked left a whole list: entries are added in one step.
        let known = || self.displays.lock().unwrap_or_else(PoisonError::into_inner);
        let ready = known().iter().find(|(of, _)| *of == curve).map(|(_, display)| display.clone());
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

    /// The score of an exact test by metric, where it is known. Computed once.
    fn noise_floors(&self) -> Result<Scores, String> {
        let compute = || {
            let Some(standard_error) = &self.standard_error else { return Ok(Scores::default()) };
            let floors = noise_floor(&self.radiance, standard_error, &self.mask, self.epsilon);
            let floors = floors.map_err(|error| error.to_string())?;
            Ok(by_name(floors.into_iter().filter_map(|(name, floor)| Some((name, floor?))).collect()))
        };
        self.noise_floors.get_or_init(compute).clone()
    }
}

/// A rendered cell, ready to be scored.
#[derive(Debug)]
pub struct Rendered<'p> {
    pub cell: &'p Cell,
    pub frame: Arc<Frame>,
    pub reference: Arc<ReferenceImage>,
    /// Display images of test and reference.
    pub pictures: [Arc<Rgb8Image>; 2],
    pub bias_variance: Option<BiasVariance>,
    pub steps: Arc<Vec<StepRecord>>,
    /// Scores and files that cells share which differ in the tone curve only.
    pub linear: Arc<Mutex<Option<Linear>>>,
    pub spent: Spent,
}

/// Everything about a cell that does not depend on the tone curve.
#[derive(Clone, Debug)]
pub struct Linear {
    /// Its linear image and its error map.
    files: [Kept; 2],
    scores: Scores,
    bins: Vec<BinRecord>,
}

/// Why a cell has no record.
#[derive(Debug)]
pub enum CellFault {
    /// Of the cell alone: it fails.
    Cell(String),
    /// The folder takes no files: the run ends.
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
        if fault.device_lost { Self::Lost(fault.message) } else { Self::Cell(fault.message) }
    }
}

impl Rendered<'_> {
    /// Scores the cell and writes its files.
    pub fn score(&self, plan: &Plan, store: &Store, device: &DeviceInfo) -> Result<CellRecord, CellFault> {
        let started = Instant::now();
        let (cell, reference) = (self.cell, &self.reference);
        let mask = &reference.mask;
        let curve = cell.point.settings().curve;
        let [radiance_name, reference_name] = images::linear_files(plan, cell);
        let mut files = BTreeMap::from([reference.file(store, reference_name)?]);
        let comparison = reference.comparison(&self.frame.radiance, curve)?;
        let bins_of = |metrics: &[&dyn Metric]| -> Result<Vec<BinRecord>, CellFault> {
            let bins = comparison.evaluate_bins(&self.frame.n_dot_v, &N_DOT_V_BIN_EDGES, metrics);
            let bins = bins?.into_iter();
            let record =
                |b: BinRow| BinRecord { lo: b.lo, hi: b.hi, pixel_count: b.pixel_count, scores: by_name(b.values) };
            Ok(bins.map(record).collect())
        };
        let linear = {
            let mut linear = self.linear.lock().unwrap_or_else(PoisonError::into_inner);
            if linear.is_none() {
                let metrics = linear_metrics();
                let radiance = keep(store, radiance_name, |path| images::write_radiance(path, &self.frame))?;
                let errors = RELATIVE_ERROR.image(&comparison.relative_error_map(), mask);
                let errors = keep(store, images::error_name(cell), |path| png::write_rgb8(path, &errors))?;
                let scores = by_name(comparison.evaluate(&metrics));
                *linear = Some(Linear { files: [radiance, errors], scores, bins: bins_of(&metrics)? });
            }
            linear.clone().expect("it was made")
        };
        files.extend(linear.files);
        let display_metrics: Vec<&dyn Metric> =
            METRICS.iter().copied().filter(|metric| metric.description().space == Space::Display).collect();
        let (mut scores, mut bins) = (linear.scores, linear.bins);
        scores.extend(by_name(comparison.evaluate(&display_metrics)));
        let of_display = bins_of(&display_metrics)?.into_iter();
        bins.iter_mut().zip(of_display).for_each(|(bin, display)| bin.scores.extend(display.scores));
        let noise_floors = reference.noise_floors().map_err(CellFault::Cell)?;
        let [test, of_reference] = &self.pictures;
        files.extend([keep(store, images::picture_name(cell), |path| png::write_rgb8(path, test))?]);
        // Shared by cells and written once.
        files.extend([keep(store, images::reference_picture_name(plan, cell), |path| match path.exists() {
            true => Ok(()),
            false => png::write_rgb8(path, of_reference),
        })?]);
        if images::sweeps_display(plan) {
            let flip = FLIP_ERROR.image(&comparison.flip_map(), mask);
            files.extend([keep(store, images::flip_name(cell), |path| png::write_rgb8(path, &flip))?]);
        }
        let bias_variance = self.bias_variance.map(|parts| BiasVariance::NAMES.into_iter().zip(parts.values()));
        Ok(CellRecord {
            cell: cell.id.clone(),
            axes: plan.columns_of(cell).iter().map(|(n, v)| (n.to_string(), v.to_string())).collect(),
            verdict: verdict_name(&scores, &noise_floors),
            noise_floors,
            reference: reference.stop.clone(),
            scores,
            bias_variance: by_name(bias_variance.into_iter().flatten().collect()),
            bins,
            steps: self.steps.to_vec(),
            device: device.name.clone(),
            driver: device.driver.clone(),
            spent: Spent { score_ms: started.elapsed().as_secs_f64() * 1e3, ..self.spent.clone() },
            files,
        })
    }
}

/// Writes a file of `images/`. Where something that is no file stands in its place the cell fails, and others can still be written.
fn keep(store: &Store, name: String, write: impl FnOnce(&Path) -> Result<(), PixelsError>) -> Result<Kept, CellFault> {
    let path = store.image_path(&name);
    let fault = |error: StoreError| match error.is_of_one_place(&path) {
        true => CellFault::Cell(error.to_string()),
        false => CellFault::Store(error),
    };
    write(&path).map_err(|error| fault(error.into()))?;
    match content_hash(&path) {
        Ok(hash) => Ok((name, hash)),
        Err(error) => Err(fault(StoreError::Io { path: path.clone(), error })),
    }
}

fn by_name(values: Vec<(&'static str, f64)>) -> Scores {
    values.into_iter().map(|(name, value)| (name.to_owned(), Exact(value))).collect()
}

/// The verdict of the headline metric; `no-noise-floor` when the reference does not know its own error.
fn verdict_name(scores: &Scores, floors: &Scores) -> String {
    let metric = <dyn Metric>::listed(HEADLINE);
    match (scores.get(HEADLINE), floors.get(HEADLINE)) {
        (Some(score), Some(floor)) => verdict(metric, score.0, floor.0).name().to_owned(),
        _ => "no-noise-floor".to_owned(),
    }
}
