//! Noise floors: scores that the reference's own error would cause.
//!
//! The reference is a mean over K = 4 scrambles with standard error `se` per pixel and channel. A
//! metric's floor is the expected score of an exact test.
//!
//! `se` is an estimate with 3 degrees of freedom: `se²` is unbiased, its root and tails are not. So
//! the error is taken as uniform within ±√3 se. Averaged over `se` that is the true normal
//! distribution: the three deviations are a point on a sphere, and one coordinate of a uniform
//! point on a sphere is uniform (the unbiased estimate of \[Kolmogorov50\]).

use super::comparison::{Comparison, check_size, check_values, masked_pixels};
use super::{Epsilon, METRICS, Metric, MetricsError, NoiseEffect};
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

/// Largest noise floor of a reference that is as exact as its images need, over the mean square
/// error without noise.
pub const NOISE_SHARE: f64 = 0.1;

/// Largest standard deviation of a mean square error by the noise of such a reference, besides the
/// floor, as a share of that error.
pub const DEVIATION_MAX: f64 = 0.02;

/// What answers do with the noise floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseUse {
    /// It stays in the scores: references are exact.
    Kept,
    /// It is taken off ([`Metric::without_noise`]).
    TakenOff,
}

impl NoiseUse {
    /// Returns the use under a largest share of noise; exact references have none.
    pub fn of_share(share: Option<f64>) -> Self {
        share.map_or(Self::Kept, |_| Self::TakenOff)
    }

    /// Returns a score as answers have it, given its noise floor.
    pub fn answered(self, metric: &Metric, score: f64, floor: Option<f64>) -> f64 {
        match self {
            Self::Kept => score,
            Self::TakenOff => metric.without_noise(score, floor),
        }
    }

    /// Least resolved mean square error, in mean square noise.
    fn resolved_from(self) -> f64 {
        match self {
            Self::Kept => 100.0,
            Self::TakenOff => 1.0 + 1.0 / NOISE_SHARE,
        }
    }
}

impl Metric {
    /// Squares a score, unless it is a mean square already.
    fn squared(&self, score: f64) -> f64 {
        score.abs().powf(2.0 / self.power)
    }

    /// Takes the reference's noise off a score whose floor is `floor`, as far as the formula
    /// allows: scores of other metrics and without a floor stay.
    ///
    /// With s the square of the score and n of the floor, the result is the root of
    /// `max(s - n, s / 2)`: unbiased from `s = 2 n` on, and never zero or negative below, where
    /// the score says only that the error is of the order of the noise.
    pub fn without_noise(&self, score: f64, floor: Option<f64>) -> f64 {
        let Some(floor) = floor.filter(|_| self.noise == NoiseEffect::Adds) else {
            return score;
        };
        let square = self.squared(score);
        let rest = (square - self.squared(floor)).max(0.5 * square);
        rest.powf(0.5 * self.power)
    }

    /// Returns the noise floor over the error without noise, both as mean squares: from 0 to
    /// infinity, where the score is not above the floor. 0 if the noise does not add to scores.
    pub fn noise_share(&self, score: f64, floor: f64) -> f64 {
        let noise = self.squared(floor);
        if self.noise != NoiseEffect::Adds || noise == 0.0 {
            return 0.0;
        }
        let rest = self.squared(score) - noise;
        if rest > 0.0 {
            noise / rest
        } else {
            f64::INFINITY
        }
    }
}

impl Metric {
    /// Returns the standard deviation of the score by the noise of the reference, to first order,
    /// as a share of the score, both as mean squares; 0 for metrics that bound each pixel.
    ///
    /// The floor is the mean of what the noise adds. A score that few pixels decide moves further:
    /// with the square q(t, r) of a pixel, independent noise of standard error `se` moves the mean
    /// of N squares by `sqrt(sum (dq/dr se)²) / N`.
    pub fn noise_deviation(&self, comparison: &Comparison, standard_error: &RgbImage) -> f64 {
        let Some(slope) = self.noise_slope else {
            return 0.0;
        };
        let pixels = comparison.pixels();
        let variance = |&pixel: &usize| {
            let [t, r] = comparison.radiance(pixel);
            let moved = |c: usize| {
                slope(comparison.epsilon(), t[c] - r[c], r[c])
                    * f64::from(standard_error.data[pixel][c])
            };
            (0..3).map(|c| moved(c).powi(2)).sum::<f64>()
        };
        let deviation = pixels.iter().map(variance).sum::<f64>().sqrt() / (3 * pixels.len()) as f64;
        let square = self.squared(self.evaluate(comparison, pixels));
        if deviation == 0.0 {
            0.0
        } else {
            deviation / square
        }
    }
}

/// A score compared with its noise floor, both as mean squares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// At most four floors: like an exact test.
    EqualWithinNoise,
    /// Below 100 floors, or 11 if answers take the floor off: the reference contributes.
    ReferenceLimited,
    /// The reference adds at most 1 % to the mean square error, or at most a tenth, which answers
    /// take off.
    Resolved,
}

listed!(Verdict, "verdict", {
    "equal-within-noise": EqualWithinNoise,
    "reference-limited": ReferenceLimited,
    "resolved": Resolved,
});

/// Largest mean square error that an exact test may have, in mean square noise.
const EQUAL_BELOW: f64 = 4.0;

/// Compares a score with its floor as mean squares, so that `rmse` and `relmse` agree.
pub fn verdict(metric: &Metric, value: f64, floor: f64, noise: NoiseUse) -> Verdict {
    let floors = |squares: f64| floor * squares.powf(0.5 * metric.power);
    if value.abs() <= floors(EQUAL_BELOW) {
        Verdict::EqualWithinNoise
    } else if value.abs() < floors(noise.resolved_from()) {
        Verdict::ReferenceLimited
    } else {
        Verdict::Resolved
    }
}
