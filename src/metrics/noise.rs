//! How small a score can be before it says more about the reference than about the test.
//!
//! The reference is a mean over samples with a known standard error per pixel and channel. Its noise floor of a metric is the
//! score to expect of an exact test: the error of the reference alone, taken as normal. Near the floor a score is not a
//! property of the test.

use super::comparison::{check_size, check_values, masked_pixels};
use super::{Epsilon, METRICS, Metric, MetricsError};
use crate::pixels::{GrayImage, RgbImage};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// `E |z|` of a standard normal `z`: `sqrt(2/π)`.
pub(super) const MEAN_ABS_NORMAL: f64 = std::f64::consts::FRAC_2_SQRT_PI * std::f64::consts::FRAC_1_SQRT_2;

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
    pub(super) fn relative_squares(&self, epsilon: Epsilon) -> Vec<f64> {
        let epsilon = epsilon.beside_square();
        let pixel =
            |[r, se]: &[[f64; 3]; 2]| (0..3).map(|c| se[c] * se[c] / (r[c] * r[c] + epsilon)).sum::<f64>() / 3.0;
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

/// Table steps a unit; linear interpolation is then within 2e-5 of the tail, relatively, up to 6.
const STEPS_PER_UNIT: usize = 512;
/// The tail beyond 8 is 1.2e-15 and taken as 0.
const TAIL_END: usize = 8;

/// `P(|z| > x)` of a standard normal `z`, for `x` ≥ 0.
pub(super) fn half_normal_tail(x: f64) -> f64 {
    // Tabulated because a floor asks for it about a million times. Summed from the far end, so that the tail keeps its
    // relative precision; one Simpson panel a step.
    static TAIL: LazyLock<Vec<f64>> = LazyLock::new(|| {
        let density = |x: f64| (2.0 / PI).sqrt() * (-0.5 * x * x).exp();
        let step = 1.0 / STEPS_PER_UNIT as f64;
        let mut tail = vec![0.0; STEPS_PER_UNIT * TAIL_END + 1];
        for i in (0..tail.len() - 1).rev() {
            let x = i as f64 * step;
            let panel = density(x) + 4.0 * density(x + 0.5 * step) + density(x + step);
            tail[i] = tail[i + 1] + panel * step / 6.0;
        }
        tail
    });
    let place = x * STEPS_PER_UNIT as f64;
    let step = place as usize;
    match TAIL.get(step..step.saturating_add(2)) {
        Some(tail) => tail[0] + (place - step as f64) * (tail[1] - tail[0]),
        None => 0.0,
    }
}
