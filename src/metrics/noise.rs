//! How small a score can be before it says more about the reference than about the test.
//!
//! The reference is a mean over K = 4 scrambles with a standard error `se` per pixel and channel. Its noise floor of a metric is the
//! score to expect of an exact test: the error of the reference alone, taken as normal. Near the floor a score is not a
//! property of the test.
//!
//! A pixel's se is itself an estimate with K - 1 = 3 degrees of freedom. `se²` has no bias, but its root, or a tail at a multiple
//! of it, has. So the error stands as uniform within ±√3 se. Averaged over what se may come out as, that is the true normal
//! distribution: the three deviations behind se are a point on a sphere, and one coordinate of a uniform point on a sphere in three
//! dimensions is uniform (the unbiased estimate of \[Kolmogorov50\] for three degrees of freedom).

use super::comparison::{check_size, check_values, masked_pixels};
use super::mean::rgb_mean;
use super::{Epsilon, METRICS, Metric, MetricsError};
use crate::glsl::constants::SCRAMBLE_COUNT;
use crate::pixels::{GrayImage, RgbImage};

const _: () = assert!(SCRAMBLE_COUNT == 4, "the distribution of the error is that of three degrees of freedom");

/// The largest error in standard errors: √3.
pub(super) const LARGEST_ERROR: f64 = 1.732_050_807_568_877_2;

/// The mean absolute error in standard errors.
pub(super) const MEAN_ABS_ERROR: f64 = 0.5 * LARGEST_ERROR;

/// A reference and its standard error, over a mask.
pub struct ReferenceNoise {
    samples: Vec<[[f64; 3]; 2]>,
    epsilon: Epsilon,
}

impl ReferenceNoise {
    /// Checks sizes, the mask, and that both images are finite and not negative on it.
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
        let sample =
            |pixel: usize| [reference, standard_error].map(|image: &RgbImage| image.data[pixel].map(f64::from));
        Ok(Self { samples: pixels.into_iter().map(sample).collect(), epsilon })
    }

    /// `[r, se]` of each masked pixel.
    pub(super) fn samples(&self) -> &[[[f64; 3]; 2]] {
        &self.samples
    }

    pub(super) fn epsilon(&self) -> Epsilon {
        self.epsilon
    }

    /// Mean of a term of `(r, se)` over masked pixels and RGB.
    pub(super) fn mean(&self, term: impl Fn(f64, f64) -> f64) -> f64 {
        let pixel = |[r, se]: &[[f64; 3]; 2]| (0..3).map(|c| term(r[c], se[c])).sum::<f64>();
        self.samples.iter().map(pixel).sum::<f64>() / (3 * self.samples.len()) as f64
    }

    /// RGB mean of `se² / (r² + ε)` of each masked pixel: the expected square of its relative error.
    pub(super) fn relative_squares(&self) -> Vec<f64> {
        let pixel = |[r, se]: &[[f64; 3]; 2]| rgb_mean(|c| self.epsilon.relative(se[c] * se[c], r[c]));
        self.samples.iter().map(pixel).collect()
    }
}

/// The noise floor of every metric by name, in the order of [`METRICS`]; `None` for display metrics.
pub fn noise_floor(
    reference: &RgbImage,
    standard_error: &RgbImage,
    mask: &GrayImage,
    epsilon: Epsilon,
) -> Result<Vec<(&'static str, Option<f64>)>, MetricsError> {
    let noise = ReferenceNoise::new(reference, standard_error, mask, epsilon)?;
    Ok(METRICS.iter().map(|metric| (metric.description().name, metric.noise_floor(&noise))).collect())
}

/// What a score means beside its noise floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// At most twice the floor: indistinguishable from an exact test.
    EqualWithinNoise,
    /// Below ten times the floor: real, but the reference contributes to the number.
    ReferenceLimited,
    /// The reference adds at most 1 % to the mean square error.
    Resolved,
}

impl Verdict {
    /// The name in tables: `equal-within-noise`, `reference-limited` or `resolved`.
    pub fn name(self) -> &'static str {
        match self {
            Self::EqualWithinNoise => "equal-within-noise",
            Self::ReferenceLimited => "reference-limited",
            Self::Resolved => "resolved",
        }
    }
}

/// Floors a score must exceed to differ from an exact test: two standard errors.
const EQUAL_BELOW: f64 = 2.0;
/// Floors from which on the reference no longer shows in the score.
const RESOLVED_FROM: f64 = 10.0;

/// Places a score by its ratio to the floor, in units of the difference: the ratio of a mean square (`power` 2) is taken to
/// its root first, so that `rmse` and `relmse` agree. A score of 0 is equal whatever the floor.
pub fn verdict(metric: &dyn Metric, value: f64, floor: f64) -> Verdict {
    let floors = |count: f64| floor * count.powf(metric.description().power);
    if value.abs() <= floors(EQUAL_BELOW) {
        Verdict::EqualWithinNoise
    } else if value.abs() < floors(RESOLVED_FROM) {
        Verdict::ReferenceLimited
    } else {
        Verdict::Resolved
    }
}

/// The probability of an error of more than `x` standard errors, for `x` ≥ 0.
pub(super) fn error_tail(x: f64) -> f64 {
    (1.0 - x / LARGEST_ERROR).max(0.0)
}
