//! Scores of an image against its reference. Metrics see images and a mask, never a method.
//!
//! `t` is the test and `r` the reference, linear radiance of one pixel and channel; `d = t - r`.
//! Means weight masked pixels and channels equally, in f64. Pixels off the mask never count:
//! display metrics see them black in both images.
//!
//! ε is [`Epsilon`], a share of the light's mean luminance. Names include it because four tools
//! call four formulas "relMSE".

mod bias;
mod bins;
mod comparison;
mod epsilon;
mod filter;
mod flip;
mod mean;
mod noise;
mod psnr;
mod relmse;
mod rmse;
mod ssim;
mod tone_mapped;
mod weight;

use crate::base::names::{Listed, listed};
pub use bins::{ALL_VIEWS, BinRow, N_DOT_V_BIN_EDGES, VIEWS};
pub use comparison::{Comparison, Displayed, MetricsError};
pub use epsilon::Epsilon;
pub use flip::PIXELS_PER_DEGREE;
pub use noise::{
    DEVIATION_MAX, NOISE_SHARE, NoiseUse, ReferenceNoise, Verdict, noise_floor, verdict,
};
pub use tone_mapped::{TONE_MAPPED, curve as tone_mapped_curve};
pub use weight::{Part, Pooling, Weight};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    Linear,
    /// 8-bit display values after the tone curve.
    Display,
}

listed!(Space, "space", { "linear": Linear, "display": Display });

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    Lower,
    Higher,
    /// Signed: the magnitude counts.
    NearerZero,
}

listed!(Better, "order", { "lower": Lower, "higher": Higher, "nearer-zero": NearerZero });

/// What the noise of a reference does to the mean of a score.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseEffect {
    /// Adds the square of its floor to the square of the score, so it can be taken off
    /// ([`Metric::without_noise`]).
    Adds,
    /// Moves it little: filters average the noise first.
    Fades,
    /// Moves it by an amount that no floor states.
    Distorts,
}

/// A score of a test image against a reference.
pub struct Metric {
    /// Column name and config value.
    pub name: &'static str,
    pub space: Space,
    pub better: Better,
    /// Counts up if a change of the code can move a value.
    pub version: u32,
    /// Constants of the formula.
    pub parameters: &'static [(&'static str, f64)],
    pub formula: &'static str,
    /// 2 for a mean square, 1 for its root; [`verdict`] compares scores and floors in units of the
    /// difference.
    pub power: f64,
    pub pooling: Pooling,
    /// What the noise of the reference does to its mean.
    pub noise: NoiseEffect,
    /// Converts a score to an error, see [`Metric::error`].
    error: fn(f64) -> f64,
    /// Scores row-major indices of masked pixels, at least one.
    evaluate: fn(&Comparison, &[usize]) -> f64,
    /// Expected score of an exact test, caused by the reference's standard error; `None` for
    /// display metrics.
    noise_floor: fn(&ReferenceNoise) -> Option<f64>,
    /// Derivative of the square of a pixel and channel by the reference there, given the difference
    /// `t - r` and r, where single pixels can decide the score.
    noise_slope: Option<fn(Epsilon, f64, f64) -> f64>,
}

impl Metric {
    /// An error of linear radiance; metrics override other fields.
    const fn linear(
        name: &'static str,
        formula: &'static str,
        evaluate: fn(&Comparison, &[usize]) -> f64,
    ) -> Self {
        Self {
            name,
            space: Space::Linear,
            better: Better::Lower,
            version: 1,
            parameters: &[],
            formula,
            power: 1.0,
            pooling: Pooling::None,
            noise: NoiseEffect::Distorts,
            error: f64::abs,
            evaluate,
            noise_floor: |_| None,
            noise_slope: None,
        }
    }

    /// Scores `pixels` (row-major indices of masked pixels; at least one).
    pub fn evaluate(&self, comparison: &Comparison, pixels: &[usize]) -> f64 {
        (self.evaluate)(comparison, pixels)
    }

    /// Converts a score to an error: lower is better, 0 is exact, and ratios mean something.
    pub fn error(&self, score: f64) -> f64 {
        (self.error)(score)
    }

    /// Returns the expected score of an exact test, caused by the reference's standard error;
    /// `None` for display metrics.
    pub fn noise_floor(&self, noise: &ReferenceNoise) -> Option<f64> {
        (self.noise_floor)(noise)
    }
}

/// Every metric, in column order.
pub static METRICS: &[&Metric] = &[
    &rmse::RMSE,
    &relmse::RELMSE,
    &tone_mapped::TONE_MAPPED,
    &bias::BIAS,
    &flip::FLIP,
    &psnr::PSNR,
    &ssim::SSIM,
];

pub const HEADLINE: &str = "relmse";

/// Names of the scores of a picture: radiance, display values, visible difference, and mean
/// brightness.
pub const PICTURE_SCORES: [&str; 4] = [HEADLINE, "tone_mapped_mse", DISPLAY_HEADLINE, "bias_rel"];

/// Its counterpart after the tone curve.
pub const DISPLAY_HEADLINE: &str = "flip";

impl Listed for Metric {
    const WHAT: &'static str = "metric";
    const LISTED_IN: Option<&'static str> = Some("a name of `splitsum list metrics`");

    fn all() -> impl Iterator<Item = &'static Self> + Clone {
        METRICS.iter().copied()
    }

    fn name(&self) -> &'static str {
        self.name
    }
}

/// Lists the metrics that need no tone curve.
pub fn linear_metrics() -> Vec<&'static Metric> {
    METRICS
        .iter()
        .copied()
        .filter(|metric| metric.space == Space::Linear)
        .collect()
}
