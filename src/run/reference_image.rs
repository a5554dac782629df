//! The image of a reference, with the files, noise floors and display images that its cells share.

use super::cell_fault::CellFault;
use super::images::{self, STANDARD_ERROR_LAYER};
use super::store::{Exact, ReferenceStop, Scores, Store, StoreError};
use crate::base::files::content_hash;
use crate::base::pixels::{GrayImage, PixelsError, Rgb8Image, RgbImage, exr, png};
use crate::instrument::metrics::{
    Comparison, DEVIATION_MAX, Displayed, Epsilon, METRICS, MetricsError, NoiseEffect, Pooling,
    ReferenceNoise, linear_metrics, noise_floor,
};
use crate::instrument::pipeline::{Frame, RenderRequest};
use crate::instrument::tonemap::ToneCurve;
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A reference and what cells share of it.
#[derive(Debug)]
pub struct ReferenceImage {
    pub radiance: RgbImage,
    pub standard_error: Option<RgbImage>,
    pub mask: GrayImage,
    pub epsilon: Epsilon,
    pub stop: Option<ReferenceStop>,
    /// The frame, unless the image was read back.
    pub rendered: Option<Arc<Frame>>,
    noise_floors: OnceLock<Result<Scores, String>>,
    bin_floors: OnceLock<Vec<Scores>>,
    /// Its linear image, once written.
    file: Mutex<Option<Kept>>,
    /// Its display images, once written.
    pictures: Mutex<Vec<Kept>>,
    /// The last few display images by tone curve.
    displays: Mutex<Vec<(ToneCurve, Arc<Displayed>)>>,
}

/// Name and content hash of a file of `images/`.
pub(super) type Kept = (String, String);

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
            bin_floors: OnceLock::new(),
            file: Mutex::default(),
            pictures: Mutex::default(),
            displays: Mutex::default(),
        }
    }

    /// Its linear image, written if necessary.
    pub(super) fn file(&self, store: &Store, name: String) -> Result<Kept, CellFault> {
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

    /// A display image of it, written by the first cell that shows it: a file of that name may be
    /// of another sample count.
    pub(super) fn picture(
        &self,
        store: &Store,
        name: String,
        picture: &Rgb8Image,
    ) -> Result<Kept, CellFault> {
        let mut written = self.pictures.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = written.iter().find(|(known, _)| *known == name) {
            return Ok(known.clone());
        }
        let kept = keep(store, name, |path| png::write_rgb8(path, picture))?;
        written.push(kept.clone());
        Ok(kept)
    }

    /// Compares a test image, reusing the reference's display image.
    pub(super) fn comparison<'a>(
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

    /// Expected scores of an exact image, over all pixels; empty if the standard error is unknown.
    /// Computed once.
    pub(super) fn noise_floors(&self) -> Result<Scores, String> {
        let compute = || {
            let Some(standard_error) = &self.standard_error else {
                return Ok(Scores::default());
            };
            let floors = noise_floor(&self.radiance, standard_error, &self.mask, self.epsilon);
            let floors = floors.map_err(|error| error.to_string())?;
            let known = floors
                .into_iter()
                .filter_map(|(name, floor)| Some((name, floor?)));
            Ok(by_name(known.collect()))
        };
        self.noise_floors.get_or_init(compute).clone()
    }

    /// Expected scores of an exact image by bin, given the pixels of each bin; empty if the
    /// standard error is unknown. Computed once.
    pub(super) fn bin_floors(&self, bins: &[Vec<usize>]) -> Vec<Scores> {
        let of_bin = |standard_error: &RgbImage, pixels: &Vec<usize>| {
            let images = [&self.radiance, standard_error];
            let noise = ReferenceNoise::of_pixels(images, pixels, self.epsilon);
            let pooled = METRICS
                .iter()
                .filter(|metric| metric.pooling != Pooling::None && !pixels.is_empty());
            by_name(
                pooled
                    .filter_map(|metric| Some((metric.name, metric.noise_floor(&noise)?)))
                    .collect(),
            )
        };
        let compute = || {
            let of_bins = |standard_error| {
                let bins = bins.iter();
                bins.map(|pixels| of_bin(standard_error, pixels)).collect()
            };
            self.standard_error.as_ref().map_or_else(Vec::new, of_bins)
        };
        self.bin_floors.get_or_init(compute).clone()
    }

    /// How many times the noise of the reference is too much for the scores of an image; at most 1
    /// if it is exact enough. The variance of the noise divides by this number.
    ///
    /// The floor may be `share` of each mean square error without noise
    /// ([`Metric::noise_share`](crate::instrument::metrics::Metric::noise_share)), and the noise may
    /// move that error by [`DEVIATION_MAX`] of it.
    pub fn excess_noise(&self, radiance: &RgbImage, share: f64) -> Result<f64, CellFault> {
        let curve = ToneCurve::default();
        let comparison =
            Comparison::new(radiance, &self.radiance, &self.mask, curve, self.epsilon)?;
        let floors = self.noise_floors().map_err(CellFault::Cell)?;
        let mut metrics = linear_metrics();
        metrics.retain(|metric| metric.noise == NoiseEffect::Adds);
        let mut largest: f64 = 0.0;
        for (metric, (name, score)) in metrics.iter().zip(comparison.evaluate(&metrics)) {
            let floor = floors.get(name).map_or(0.0, |floor| floor.0);
            largest = largest.max(metric.noise_share(score, floor) / share);
            if let Some(standard_error) = &self.standard_error {
                let deviation = metric.noise_deviation(&comparison, standard_error);
                largest = largest.max((deviation / DEVIATION_MAX).powi(2));
            }
        }
        Ok(largest)
    }
}

/// Writes a file of `images/`. If its path is not a file, only this cell fails.
pub(super) fn keep(
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

pub(super) fn by_name(values: Vec<(&'static str, f64)>) -> Scores {
    values
        .into_iter()
        .map(|(name, value)| (name.to_owned(), Exact(value)))
        .collect()
}
