//! Records of cells and references.

use crate::base::names::{Listed, listed};
use crate::base::numbers::round_to_significant;
use crate::experiment::Id;
use crate::instrument::ladder::{Attribution, StepNumbers};
use crate::instrument::metrics::{Metric, NoiseUse};
use crate::instrument::shade::reference_pass::Convergence;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A number that JSON preserves bit for bit: it is written as text, which may be `inf`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(into = "String", try_from = "String")]
pub struct Exact(pub f64);

impl From<Exact> for String {
    fn from(number: Exact) -> Self {
        format!("{:e}", number.0)
    }
}

impl TryFrom<String> for Exact {
    type Error = std::num::ParseFloatError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse().map(Self)
    }
}

pub type Scores = BTreeMap<String, Exact>;

/// Where the least certain term of a reference stopped.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct ReferenceStop {
    /// Samples per pixel and term, minimum over terms.
    pub samples: u64,
    /// Relative standard error of the image (`shade::reference_pass::Convergence`), maximum over
    /// terms.
    pub relative_error: Exact,
    pub stopped_by: StopReason,
}

/// The limit that a reference met.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StopReason {
    Samples,
    /// Every term reached the requested relative standard error.
    RelativeError,
    /// The noise is small beside the errors of all images that it judges.
    NoiseShare,
}

listed!(StopReason, "reason to stop", {
    "samples": Samples,
    "relative-error": RelativeError,
    "noise-share": NoiseShare,
});

impl ReferenceStop {
    /// Combines the terms of one image; `None` if none is a reference. `wanted` is the requested
    /// relative error.
    pub fn from_terms(terms: &[Convergence], wanted: Option<f64>) -> Option<Self> {
        let samples = terms.iter().map(|term| term.sample_count).min()?;
        let is_met = wanted.is_some() && terms.iter().all(|term| term.is_met);
        Some(Self {
            samples,
            relative_error: Exact(
                terms
                    .iter()
                    .map(|term| term.relative_error)
                    .fold(0.0, f64::max),
            ),
            stopped_by: if is_met {
                StopReason::RelativeError
            } else {
                StopReason::Samples
            },
        })
    }
}

/// The reference of a group of cells.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct ReferenceRecord {
    #[serde(flatten)]
    pub stop: ReferenceStop,
    /// By the id of an image: the first sample count whose noise is small beside the image's error.
    /// Empty for exact references.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub needs: BTreeMap<Id, u32>,
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct CellRecord {
    pub cell: Id,
    pub axes: BTreeMap<String, String>,
    pub scores: Scores,
    /// Expected scores of an exact image, if the reference's standard error is known.
    pub noise_floors: Scores,
    #[serde(flatten)]
    pub judgement: Judgement,
    pub bins: Vec<BinRecord>,
    /// Empty without `[ladder]`.
    #[serde(default)]
    pub steps: Vec<StepRecord>,
    pub device: String,
    pub driver: String,
    /// As in [`DeviceInfo`](crate::instrument::gpu::DeviceInfo).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<String>,
    /// Content hash by file of `images/`.
    pub files: BTreeMap<String, String>,
}

/// What a comparison finds besides scores ([`super::columns::ErrorColumns`]). Fields in the order of
/// the record's keys; those that older programs did not write have a default.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Judgement {
    /// Of a sequence of frames.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steadiness: Option<SteadinessScores>,
    #[serde(default)]
    pub reference: Option<ReferenceStop>,
    pub verdict: String,
}

/// How steady a sequence of frames is ([`super::columns::SteadinessColumns`]). Fields in the order
/// of the record's keys.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct SteadinessScores {
    pub flicker: Exact,
    pub lag_bias: Exact,
}

/// Scores over the pixels with `n_dot_v` in [`lo`, `hi`).
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct BinRecord {
    pub lo: f64,
    pub hi: f64,
    pub pixel_count: usize,
    /// RGB mean of the reference. Records of older programs lack it and the noise floors.
    #[serde(default)]
    pub reference_mean: Option<Exact>,
    /// Empty if the bin has no pixels.
    pub scores: Scores,
    /// Expected scores of an exact image, of metrics that bins determine
    /// ([`crate::instrument::metrics::Pooling`]).
    #[serde(default)]
    pub noise_floors: Scores,
}

/// One step of a cell's error over the pixels with n·v in [`lo`, `hi`).
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct StepRecord {
    pub lo: f64,
    pub hi: f64,
    pub pixel_count: usize,
    pub step: String,
    pub numbers: StepScores,
}

/// The numbers of a step ([`super::columns::StepColumns`]). Fields in the order of the record's
/// keys.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct StepScores {
    pub first_in: Exact,
    pub last_out: Exact,
    pub noise: Exact,
    pub rung_error: Exact,
    pub shapley: Exact,
    pub share: Exact,
    pub share_error: Exact,
    pub step_error: Exact,
}

/// Significant digits of the numbers of a step: more than the noise leaves.
const STEP_DIGITS: usize = 4;

impl StepScores {
    /// Rounds the numbers of a step; `noise` is the `relmse` of an exact image.
    fn new(numbers: &StepNumbers, noise: f64) -> Self {
        let exact = |number: f64| Exact(round_to_significant(number, STEP_DIGITS));
        Self {
            first_in: exact(numbers.first_in),
            last_out: exact(numbers.last_out),
            noise: exact(noise),
            rung_error: exact(numbers.error),
            shapley: exact(numbers.shapley),
            share: exact(numbers.share),
            share_error: exact(numbers.share_error),
            step_error: exact(numbers.step_error),
        }
    }
}

impl StepRecord {
    /// The steps of each band, in order.
    pub fn of_attributions(attributions: &[Attribution]) -> Vec<Self> {
        let mut records = Vec::new();
        for band in attributions {
            let [lo, hi] = band.n_dot_v;
            records.extend(band.steps.iter().map(|numbers| Self {
                lo,
                hi,
                pixel_count: band.pixel_count,
                step: numbers.step.to_owned(),
                numbers: StepScores::new(numbers, band.noise),
            }));
        }
        records
    }
}

impl CellRecord {
    pub fn score(&self, metric: &str) -> Option<f64> {
        self.scores.get(metric).map(|score| score.0)
    }

    /// The score as answers have it.
    pub fn answered(&self, metric: &str, noise_use: NoiseUse) -> Option<f64> {
        let floor = self.noise_floor(metric);
        Some(noise_use.answered(Metric::listed(metric), self.score(metric)?, floor))
    }

    /// Expected score of an exact image.
    pub fn noise_floor(&self, metric: &str) -> Option<f64> {
        self.noise_floors.get(metric).map(|floor| floor.0)
    }
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct FailureRecord {
    pub cell: Id,
    pub label: String,
    pub reason: String,
}

#[cfg(test)]
mod tests;
