//! Scores of an image against its reference. Metrics see images and a mask, never a method.
//!
//! Symbols: `t` test and `r` reference, linear radiance of one pixel and channel; `d = t - r`. Every mean is over the masked
//! pixels and their three channels with equal weight, accumulated in f64. A pixel off the mask never counts: linear metrics
//! skip it and display metrics see it black in both images.
//!
//! ε is [`Epsilon`], a share of the mean luminance m of the light, so that scores of two lights compare.
//!
//! A name carries the constant that makes the number comparable: four tools call four formulas "relMSE".

mod bias;
mod bias_variance;
mod bins;
mod comparison;
mod epsilon;
mod filter;
mod flip;
mod mae;
mod mean;
mod noise;
mod psnr;
mod relmse;
mod rmse;
mod smape;
mod ssim;
mod tail;

use crate::spelling::Listed;
pub use bias_variance::{BiasVariance, Repeats};
pub use bins::{ALL_VIEWS, BinRow, N_DOT_V_BIN_EDGES, VIEWS};
pub use comparison::{Comparison, Displayed, MetricsError, signed_step};
pub use epsilon::Epsilon;
pub use flip::PIXELS_PER_DEGREE;
pub use noise::{ReferenceNoise, Verdict, noise_floor, verdict};

/// The values a metric reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// Linear radiance.
    Linear,
    /// 8-bit display values after the tone curve.
    Display,
}

impl Space {
    /// The name in tables: `linear` or `display`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Display => "display",
        }
    }
}

/// Which values of a metric are good.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    Lower,
    Higher,
    /// Signed: the magnitude counts, the sign tells the direction of the error.
    NearerZero,
}

impl Better {
    /// The name in tables: `lower`, `higher` or `nearer-zero`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lower => "lower",
            Self::Higher => "higher",
            Self::NearerZero => "nearer-zero",
        }
    }
}

/// What is recorded about a metric beside its values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// Column name and config value.
    pub name: &'static str,
    pub space: Space,
    pub better: Better,
    /// Counts up whenever a change of the code can move a value.
    pub version: u32,
    /// Constants of the formula, by name.
    pub parameters: &'static [(&'static str, f64)],
    /// One sentence for `splitsum list metrics`.
    pub formula: &'static str,
    /// Power of the difference that the score grows with: 2 for a mean square, 1 for its root. [`verdict`] compares scores
    /// and noise floors in units of the difference.
    pub power: f64,
}

impl Description {
    /// Of an error of linear radiance, whose score grows with the difference. Each metric sets beside it what is different.
    const fn linear(name: &'static str, formula: &'static str) -> Self {
        let (space, better) = (Space::Linear, Better::Lower);
        Self { name, space, better, version: 1, parameters: &[], formula, power: 1.0 }
    }
}

/// A score of a test image against a reference.
pub trait Metric: Sync {
    /// Name, space, direction, parameters and formula.
    fn description(&self) -> &'static Description;

    /// The score over `pixels` (row-major indices of masked pixels; at least one).
    fn evaluate(&self, comparison: &Comparison, pixels: &[usize]) -> f64;

    /// A score as an error, so that lower is better and ratios mean something: the score itself, or its magnitude where it has a sign.
    fn error(&self, score: f64) -> f64 {
        score.abs()
    }

    /// The score to expect over the masked pixels if the test were exact and only the reference were off, by its standard
    /// error. `None` where that needs more than the standard error (display metrics).
    fn noise_floor(&self, _noise: &ReferenceNoise) -> Option<f64> {
        None
    }
}

/// Every metric, in the order of the columns.
pub static METRICS: &[&dyn Metric] = &[
    &rmse::Rmse,
    &relmse::RelMse,
    &relmse::TrimmedRelMse,
    &mae::Mae,
    &smape::Smape,
    &bias::RelativeBias,
    &tail::P95,
    &tail::P99,
    &tail::MAXIMUM,
    &psnr::Psnr,
    &ssim::Ssim,
    &flip::Flip,
];

/// Name of the metric that answers rest on where an experiment names none.
pub const HEADLINE: &str = "relmse";

/// Name of the metric that stands for it after the tone curve.
pub const DISPLAY_HEADLINE: &str = "flip";

impl Listed for dyn Metric {
    const WHAT: &'static str = "metric";

    fn all() -> impl Iterator<Item = &'static Self> + Clone {
        METRICS.iter().copied()
    }

    fn name(&self) -> &'static str {
        self.description().name
    }
}

/// The metrics that need no tone curve.
pub fn linear_metrics() -> Vec<&'static dyn Metric> {
    METRICS.iter().copied().filter(|metric| metric.description().space == Space::Linear).collect()
}
