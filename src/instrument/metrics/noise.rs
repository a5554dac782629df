//! Noise floors: scores that the reference's own error would cause.
//!
//! The reference is a mean over K = 4 scrambles with standard error `se` per pixel and channel. A
//! metric's floor is the expected score of an exact test.
//!
//! `se` is an estimate with 3 degrees of freedom: `se²` is unbiased, its root and tails are not. So
//! the error is taken as uniform within ±√3 se. Averaged over `se` that is the true normal
//! distribution: the three deviations are a point on a sphere, and one coordinate of a uniform
//! point on a sphere is uniform (the unbiased estimate of \[Kolmogorov50\]).

use super::comparison::{check_size, check_values, masked_pixels};
use super::{Epsilon, METRICS, Metric, MetricsError};
use crate::base::glsl::constants::SCRAMBLE_COUNT;
use crate::base::names::listed;
use crate::base::pixels::{GrayImage, RgbImage};

const _: () = assert!(
    SCRAMBLE_COUNT == 4,
    "the error has three degrees of freedom"
);

pub struct ReferenceNoise {
    samples: Vec<[[f64; 3]; 2]>,
    epsilon: Epsilon,
}

impl ReferenceNoise {
    /// Checks sizes, the mask, and that masked values are finite and not negative.
    pub fn new(
        reference: &RgbImage,
        standard_error: &RgbImage,
        mask: &GrayImage,
        epsilon: Epsilon,
    ) -> Result<Self, MetricsError> {
        let size = [reference.width, reference.height];
        check_size("standard error image", standard_error, size)?;
        let pixels = masked_pixels(mask, size)?;
        check_values("reference", reference, &pixels)?;
        check_values("standard error image", standard_error, &pixels)?;
        Ok(Self::of_pixels(
            [reference, standard_error],
            &pixels,
            epsilon,
        ))
    }

    /// The noise of some masked pixels of a checked reference and its standard error, by row-major
    /// index.
    pub fn of_pixels(images: [&RgbImage; 2], pixels: &[usize], epsilon: Epsilon) -> Self {
        let sample = |&pixel: &usize| images.map(|image| image.data[pixel].map(f64::from));
        Self {
            samples: pixels.iter().map(sample).collect(),
            epsilon,
        }
    }

    /// `[r, se]` of each masked pixel.
    pub(super) fn samples(&self) -> &[[[f64; 3]; 2]] {
        &self.samples
    }

    pub(super) fn epsilon(&self) -> Epsilon {
        self.epsilon
    }

    /// Averages a term of `(r, se)` over masked pixels and RGB.
    pub(super) fn mean(&self, term: impl Fn(f64, f64) -> f64) -> f64 {
        let pixel = |[r, se]: &[[f64; 3]; 2]| (0..3).map(|c| term(r[c], se[c])).sum::<f64>();
        self.samples.iter().map(pixel).sum::<f64>() / (3 * self.samples.len()) as f64
    }
}

/// Computes every metric's noise floor in the order of [`METRICS`]; `None` for display metrics.
pub fn noise_floor(
    reference: &RgbImage,
    standard_error: &RgbImage,
    mask: &GrayImage,
    epsilon: Epsilon,
) -> Result<Vec<(&'static str, Option<f64>)>, MetricsError> {
    let noise = ReferenceNoise::new(reference, standard_error, mask, epsilon)?;
    Ok(METRICS
        .iter()
        .map(|metric| (metric.name, metric.noise_floor(&noise)))
        .collect())
}

/// A score compared with its noise floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// At most twice the floor: like an exact test.
    EqualWithinNoise,
    /// Below ten times the floor: the reference contributes.
    ReferenceLimited,
    /// The reference adds at most 1 % to the mean square error.
    Resolved,
}

listed!(Verdict, "verdict", {
    "equal-within-noise": EqualWithinNoise,
    "reference-limited": ReferenceLimited,
    "resolved": Resolved,
});

const EQUAL_BELOW: f64 = 2.0;
const RESOLVED_FROM: f64 = 10.0;

/// Compares a score with its floor in units of the difference, so that `rmse` and `relmse` agree.
pub fn verdict(metric: &Metric, value: f64, floor: f64) -> Verdict {
    let floors = |count: f64| floor * count.powf(metric.power);
    if value.abs() <= floors(EQUAL_BELOW) {
        Verdict::EqualWithinNoise
    } else if value.abs() < floors(RESOLVED_FROM) {
        Verdict::ReferenceLimited
    } else {
        Verdict::Resolved
    }
}
