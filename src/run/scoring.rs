//! Scores images into the record of a cell, on the host, several cells at a time.

use super::columns::STEADINESS;
use super::images::{self, STANDARD_ERROR_LAYER};
use super::renderer::RenderFault;
use super::store::{
    BinRecord, CellRecord, Exact, ReferenceStop, Scores, StepRecord, Store, StoreError,
};
use super::tables::HEADLINE;
use crate::base::files::content_hash;
use crate::base::names::Listed;
use crate::base::pixels::{GrayImage, PixelsError, Rgb8Image, RgbImage, exr, png};
use crate::draw::colormap::{FLIP_ERROR, RELATIVE_ERROR};
use crate::experiment::plan::{Cell, Plan};
use crate::instrument::metrics::{
    BinRow, Comparison, Displayed, Epsilon, METRICS, Metric, MetricsError, N_DOT_V_BIN_EDGES,
    Pooling, ReferenceNoise, Space, linear_metrics, noise_floor, verdict,
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
        let stop = ReferenceStop::of(&frame.convergences, request.reference_error);
        let mask = GrayImage::clone(&frame.mask);
        let own = Self::new(
            frame.radiance.clone(),
            frame.standard_error.clone(),
            mask,
            request,
            stop,
        );
        Self {
            rendered: Some(frame),
            ..own
        }
    }

    /// Reads back a reference of an earlier invocation, bit for bit; `None` if it is missing or
    /// incomplete.
    pub fn read(path: &Path, request: &RenderRequest, stop: Option<ReferenceStop>) -> Option<Self> {
        let image = exr::read(path).ok()?;
        let standard_error = match request.has_reference_term() {
            true if stop.is_none() => return None,
            true => Some(exr::read_layer(path, Some(STANDARD_ERROR_LAYER)).ok()?.rgb),
            false => None,
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
            .find(|(of, _)| *of == curve)
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
    pub reference: Arc<ReferenceImage>,
    /// Display images of test and reference.
    pub pictures: [Arc<Rgb8Image>; 2],
    pub steps: Arc<Vec<StepRecord>>,
    /// Shared by cells that differ only in the tone curve.
    pub linear: Arc<Mutex<Option<Linear>>>,
}

/// The results of a cell that do not depend on the tone curve.
#[derive(Clone, Debug)]
pub struct Linear {
    /// Linear image and error map.
    files: [Kept; 2],
    scores: Scores,
    bins: Vec<BinRecord>,
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
    /// Scores the cell and writes its files.
    pub fn score(
        &self,
        plan: &Plan,
        store: &Store,
        device: &DeviceInfo,
    ) -> Result<CellRecord, CellFault> {
        let (cell, reference) = (self.cell, &self.reference);
        let mask = &reference.mask;
        let curve = cell.point.settings().curve;
        let [radiance_name, reference_name] = images::linear_files(plan, cell);
        let mut files = BTreeMap::from([reference.file(store, reference_name)?]);
        let comparison = reference.comparison(&self.frame.radiance, curve)?;
        let bins_of = |metrics: &[&Metric]| -> Result<Vec<BinRecord>, CellFault> {
            let bins = comparison.evaluate_bins(&self.frame.n_dot_v, &N_DOT_V_BIN_EDGES, metrics);
            let bins = bins?.into_iter();
            let record = |b: BinRow| BinRecord {
                lo: b.lo,
                hi: b.hi,
                pixel_count: b.pixel_count,
                reference_mean: (b.pixel_count > 0).then_some(Exact(b.reference_mean)),
                scores: by_name(b.values),
                noise_floors: Scores::default(),
            };
            Ok(bins.map(record).collect())
        };
        let linear = {
            let mut linear = self.linear.lock().unwrap_or_else(PoisonError::into_inner);
            if linear.is_none() {
                let metrics = linear_metrics();
                let radiance = keep(store, radiance_name, |path| {
                    images::write_radiance(path, &self.frame)
                })?;
                let errors = RELATIVE_ERROR.image(&comparison.relative_error_map(), mask);
                let errors = keep(store, images::error_name(cell), |path| {
                    png::write_rgb8(path, &errors)
                })?;
                let scores = by_name(comparison.evaluate(&metrics));
                *linear = Some(Linear {
                    files: [radiance, errors],
                    scores,
                    bins: bins_of(&metrics)?,
                });
            }
            linear.clone().expect("it was made")
        };
        files.extend(linear.files);
        let display_metrics: Vec<&Metric> = METRICS
            .iter()
            .copied()
            .filter(|metric| metric.space == Space::Display)
            .collect();
        let (mut scores, mut bins) = (linear.scores, linear.bins);
        scores.extend(by_name(comparison.evaluate(&display_metrics)));
        let of_display = bins_of(&display_metrics)?.into_iter();
        bins.iter_mut()
            .zip(of_display)
            .for_each(|(bin, display)| bin.scores.extend(display.scores));
        let bin_pixels = comparison.bin_pixels(&self.frame.n_dot_v, &N_DOT_V_BIN_EDGES)?;
        let floors = reference
            .noise_floors(&bin_pixels)
            .map_err(CellFault::Cell)?;
        bins.iter_mut()
            .zip(floors.bins)
            .for_each(|(bin, own)| bin.noise_floors = own);
        let noise_floors = floors.whole;
        let [test, of_reference] = &self.pictures;
        files.extend([keep(store, images::picture_name(cell), |path| {
            png::write_rgb8(path, test)
        })?]);
        // Shared by cells and written once.
        files.extend([keep(
            store,
            images::reference_picture_name(plan, cell),
            |path| match path.exists() {
                true => Ok(()),
                false => png::write_rgb8(path, of_reference),
            },
        )?]);
        if images::sweeps_display(plan) {
            let flip = FLIP_ERROR.image(&comparison.flip_map(), mask);
            files.extend([keep(store, images::flip_name(cell), |path| {
                png::write_rgb8(path, &flip)
            })?]);
        }
        let steadiness = self
            .frame
            .steadiness
            .as_ref()
            .map(|own| -> Result<_, CellFault> {
                let lagging = reference.comparison(&own.without_noise, curve)?;
                let numbers = [
                    lagging.evaluate(&[Metric::listed(HEADLINE)])[0].1,
                    own.flicker,
                ];
                Ok(STEADINESS
                    .iter()
                    .map(|column| column.name.to_owned())
                    .zip(numbers.map(Exact))
                    .collect())
            });
        Ok(CellRecord {
            cell: cell.id.clone(),
            axes: plan
                .columns_of(cell)
                .iter()
                .map(|(n, v)| (n.to_string(), v.to_string()))
                .collect(),
            verdict: verdict_name(&scores, &noise_floors),
            noise_floors,
            steadiness: steadiness.transpose()?.unwrap_or_default(),
            reference: reference.stop.clone(),
            scores,
            bins,
            steps: self.steps.to_vec(),
            device: device.name.clone(),
            driver: device.driver.clone(),
            files,
        })
    }
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
