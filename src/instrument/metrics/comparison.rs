//! A test image, its reference and a mask, checked once, with shared intermediate results.

use super::flip::{map as flip, view::View as FlipView};
use super::mean::rgb_mean;
use super::ssim::similarities;
use super::{Epsilon, METRICS, Metric};
use crate::base::pixels::{GrayImage, Pixels, Rgb8Image, RgbImage};
use crate::instrument::tonemap::ToneCurve;
use std::sync::{Arc, OnceLock};

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MetricsError {
    #[error(
        "the {image} is {}x{} pixels, but the reference is {}x{}",
        found[0],
        found[1],
        expected[0],
        expected[1]
    )]
    Size {
        image: &'static str,
        found: [u32; 2],
        expected: [u32; 2],
    },
    #[error("the mask has value {value} at column {x}, row {y}; a mask holds only 0 and 1")]
    MaskValue { x: u32, y: u32, value: f32 },
    #[error("the {width}x{height} mask is 0 everywhere; at least one pixel must be 1")]
    EmptyMask { width: u32, height: u32 },
    #[error(
        "the {image} has {count} masked pixels with a NaN, infinite or negative value, the first \
         {value:?} at column {x}, \
         row {y}; values must be finite and not negative"
    )]
    Value {
        image: &'static str,
        count: usize,
        x: u32,
        y: u32,
        value: [f32; 3],
    },
    #[error("n_dot_v is {value} at column {x}, row {y}; a masked pixel needs a finite cosine")]
    Cosine { x: u32, y: u32, value: f32 },
    #[error("bin edges {edges:?}: at least two finite values in increasing order are needed")]
    BinEdges { edges: Vec<f64> },
}

/// An image after the tone curve, black off the mask so that the background does not affect windows
/// of FLIP.
#[derive(Debug)]
pub struct Displayed {
    image: Rgb8Image,
    flip: OnceLock<FlipView>,
}

impl Displayed {
    /// Upper bound of its memory, bytes per pixel: image, five f32 of FLIP.
    pub const BYTES_PER_PIXEL: usize = 3 + 5 * 4;

    fn new(image: &RgbImage, pixels: &[usize], curve: ToneCurve) -> Self {
        let mut display = Rgb8Image::filled(image.width, image.height, [0; 3]);
        for &pixel in pixels {
            display.data[pixel] = curve.apply_rgb8(image.data[pixel]);
        }
        Self {
            image: display,
            flip: OnceLock::new(),
        }
    }

    fn flip(&self) -> &FlipView {
        self.flip.get_or_init(|| FlipView::new(&self.image))
    }
}

/// A test image against its reference over a mask; computes lazily.
pub struct Comparison<'a> {
    test: &'a RgbImage,
    reference: &'a RgbImage,
    curve: ToneCurve,
    epsilon: Epsilon,
    pixels: Vec<usize>,
    relative_squares: OnceLock<Vec<f64>>,
    test_display: OnceLock<Displayed>,
    reference_display: OnceLock<Arc<Displayed>>,
    flip: OnceLock<GrayImage>,
    similarities: OnceLock<Vec<f64>>,
}

impl<'a> Comparison<'a> {
    /// Checks sizes, mask (0 or 1, not empty) and masked values (finite, not negative). Display
    /// metrics use `curve`, relative metrics `epsilon`.
    pub fn new(
        test: &'a RgbImage,
        reference: &'a RgbImage,
        mask: &GrayImage,
        curve: ToneCurve,
        epsilon: Epsilon,
    ) -> Result<Self, MetricsError> {
        let size = [reference.width, reference.height];
        check_size("test image", test, size)?;
        let pixels = masked_pixels(mask, size)?;
        check_values("reference", reference, &pixels)?;
        check_values("test image", test, &pixels)?;
        Ok(Self {
            test,
            reference,
            curve,
            epsilon,
            pixels,
            relative_squares: OnceLock::new(),
            test_display: OnceLock::new(),
            reference_display: OnceLock::new(),
            flip: OnceLock::new(),
            similarities: OnceLock::new(),
        })
    }

    /// Evaluates every metric in the order of [`METRICS`].
    pub fn evaluate_all(&self) -> Vec<(&'static str, f64)> {
        self.evaluate(METRICS)
    }

    pub fn evaluate(&self, metrics: &[&Metric]) -> Vec<(&'static str, f64)> {
        self.evaluate_pixels(metrics, &self.pixels)
    }

    pub(super) fn evaluate_pixels(
        &self,
        metrics: &[&Metric],
        pixels: &[usize],
    ) -> Vec<(&'static str, f64)> {
        metrics
            .iter()
            .map(|metric| (metric.name, metric.evaluate(self, pixels)))
            .collect()
    }

    /// Row-major indices of masked pixels, ascending.
    pub fn pixels(&self) -> &[usize] {
        &self.pixels
    }

    pub fn size(&self) -> [u32; 2] {
        [self.reference.width, self.reference.height]
    }

    /// Returns relative error per pixel: the root of the RGB mean of `d² / (r² + ε)`; 0 off the
    /// mask.
    pub fn relative_error_map(&self) -> GrayImage {
        let squares = self.relative_squares();
        self.map(|pixel| squares[pixel].sqrt() as f32)
    }

    /// Returns signed relative error per pixel: the RGB mean of `d / sqrt(r² + ε)`; 0 off the mask.
    pub fn signed_error_map(&self) -> GrayImage {
        self.map(|pixel| {
            let [t, r] = self.radiance(pixel);
            rgb_mean(|c| self.epsilon.signed(t[c] - r[c], r[c])) as f32
        })
    }

    /// Returns the FLIP error map in [0, 1]; 0 off the mask.
    pub fn flip_map(&self) -> GrayImage {
        let flip = self.flip();
        self.map(|pixel| flip.data[pixel])
    }

    fn map(&self, value: impl Fn(usize) -> f32) -> GrayImage {
        let [width, height] = self.size();
        let mut map = GrayImage::filled(width, height, 0.0);
        for &pixel in &self.pixels {
            map.data[pixel] = value(pixel);
        }
        map
    }

    /// Returns `[t, r]` of a pixel.
    pub(super) fn radiance(&self, pixel: usize) -> [[f64; 3]; 2] {
        [self.test, self.reference].map(|image| image.data[pixel].map(f64::from))
    }

    /// RGB mean of the reference over these pixels; 0 for none.
    pub(super) fn reference_mean(&self, pixels: &[usize]) -> f64 {
        let sum: f64 = pixels
            .iter()
            .map(|&pixel| self.radiance(pixel)[1].iter().sum::<f64>())
            .sum();
        sum / (3 * pixels.len().max(1)) as f64
    }

    /// RGB mean of `d² / (r² + ε)` by pixel index; 0 off the mask.
    pub(super) fn relative_squares(&self) -> &[f64] {
        self.relative_squares.get_or_init(|| {
            let mut squares = vec![0.0; self.reference.data.len()];
            for &pixel in &self.pixels {
                let [t, r] = self.radiance(pixel);
                squares[pixel] = rgb_mean(|c| self.epsilon.relative((t[c] - r[c]).powi(2), r[c]));
            }
            squares
        })
    }

    pub(super) fn epsilon(&self) -> Epsilon {
        self.epsilon
    }

    pub fn reference_display(&self) -> &Arc<Displayed> {
        self.reference_display
            .get_or_init(|| Arc::new(Displayed::new(self.reference, &self.pixels, self.curve)))
    }

    /// Shares the tone-mapped reference of another comparison with the same reference, mask and
    /// curve.
    pub fn with_reference_display(self, display: Arc<Displayed>) -> Self {
        Self {
            reference_display: display.into(),
            ..self
        }
    }

    pub(super) fn display(&self) -> [&Displayed; 2] {
        [
            self.test_display
                .get_or_init(|| Displayed::new(self.test, &self.pixels, self.curve)),
            self.reference_display(),
        ]
    }

    /// Returns the 8-bit display values of test and reference, black off the mask.
    pub(super) fn codes(&self) -> [&Rgb8Image; 2] {
        self.display().map(|displayed| &displayed.image)
    }

    /// Returns SSIM by pixel index, off the mask too.
    pub(super) fn similarities(&self) -> &[f64] {
        self.similarities.get_or_init(|| {
            let [test, reference] = self.codes();
            similarities(test, reference)
        })
    }

    pub(super) fn flip(&self) -> &GrayImage {
        self.flip.get_or_init(|| {
            let [test, reference] = self.display().map(Displayed::flip);
            flip::flip_map(test, reference)
        })
    }
}

/// Fails unless an image has the reference's size.
pub(super) fn check_size<T>(
    image: &'static str,
    found: &Pixels<T>,
    expected: [u32; 2],
) -> Result<(), MetricsError> {
    let found = [found.width, found.height];
    if found == expected {
        Ok(())
    } else {
        Err(MetricsError::Size {
            image,
            found,
            expected,
        })
    }
}

pub(super) fn masked_pixels(mask: &GrayImage, size: [u32; 2]) -> Result<Vec<usize>, MetricsError> {
    check_size("mask", mask, size)?;
    if let Some(pixel) = mask
        .data
        .iter()
        .position(|&value| value != 0.0 && value != 1.0)
    {
        let [x, y] = column_and_row(pixel, mask.width);
        return Err(MetricsError::MaskValue {
            x,
            y,
            value: mask.data[pixel],
        });
    }
    let pixels: Vec<usize> = (0..mask.data.len())
        .filter(|&pixel| mask.data[pixel] == 1.0)
        .collect();
    if pixels.is_empty() {
        return Err(MetricsError::EmptyMask {
            width: mask.width,
            height: mask.height,
        });
    }
    Ok(pixels)
}

/// Fails if a masked pixel is NaN, infinite or negative.
pub(super) fn check_values(
    image: &'static str,
    values: &RgbImage,
    pixels: &[usize],
) -> Result<(), MetricsError> {
    let is_bad = |&&pixel: &&usize| {
        !values.data[pixel]
            .iter()
            .all(|v| v.is_finite() && *v >= 0.0)
    };
    let Some(&first) = pixels.iter().find(is_bad) else {
        return Ok(());
    };
    let [x, y] = column_and_row(first, values.width);
    Err(MetricsError::Value {
        image,
        count: pixels.iter().filter(is_bad).count(),
        x,
        y,
        value: values.data[first],
    })
}

pub(super) fn column_and_row(pixel: usize, width: u32) -> [u32; 2] {
    let width = width as usize;
    [(pixel % width) as u32, (pixel / width) as u32]
}
