//! A finished run as typed data, read from its folder, published or not.

mod bins;
mod read;
mod weighted;

pub use bins::{Bin, BinRange, Bins};
pub use read::{FinishedError, provenance};
pub use weighted::check_weight;

use crate::experiment::axis::{AXES, ENVIRONMENT, ENVIRONMENT_SCALE, Point, SCENE};
use crate::experiment::config::Config;
use crate::experiment::value::Value;
use crate::instrument::metrics::{Epsilon, METRICS, Metric, NoiseUse, Weight};
use crate::instrument::scene::is_design;
use crate::run::columns::UNSCORED;
use crate::run::provenance::{Provenance, device_words};
use crate::run::store::{FailureRecord, ReferenceStop};
use crate::run::timing::TimingRecord;
use indexmap::IndexSet;
use std::path::PathBuf;
use std::sync::Arc;

/// One number per metric, in the order of [`METRICS`]; NaN if missing.
#[derive(Clone, Debug, PartialEq)]
pub struct MetricValues([f64; METRICS.len()]);

impl MetricValues {
    pub fn from_fn(value: impl Fn(&'static str) -> Option<f64>) -> Self {
        Self(std::array::from_fn(|index| {
            value(METRICS[index].name).unwrap_or(f64::NAN)
        }))
    }

    /// These values at these indices of [`METRICS`].
    fn at(indices: &[usize], values: &[f64]) -> Self {
        let mut all = [f64::NAN; METRICS.len()];
        for (index, value) in indices.iter().zip(values) {
            all[*index] = *value;
        }
        Self(all)
    }

    pub fn get(&self, name: &str) -> Option<f64> {
        let place = METRICS.iter().position(|metric| metric.name == name)?;
        Some(self.0[place]).filter(|value| !value.is_nan())
    }
}

/// One step of an error over the pixels with n·v in `n_dot_v` (`run::columns::StepColumns`).
#[derive(Clone, Debug, PartialEq)]
pub struct StepRow {
    pub n_dot_v: [f64; 2],
    pub step: String,
    pub share: f64,
    pub share_error: f64,
    pub rung_error: f64,
    pub first_in: f64,
    pub last_out: f64,
    pub shapley: f64,
    pub step_error: f64,
    pub noise: f64,
}

/// A material that a method recovers from photos (`run::columns::RecoveryColumns`).
#[derive(Clone, Debug, PartialEq)]
pub struct RecoveredRow {
    /// Id of a photo.
    pub truth: String,
    /// Id of a cell of the candidate.
    pub candidate: String,
    pub loss: String,
    pub n_dot_v: [f64; 2],
    pub true_roughness: f64,
    pub true_f0: f64,
    pub roughness: f64,
    pub f0: f64,
    pub is_at_limit: bool,
}

/// File names of the linear images of a cell and its reference.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellImages {
    pub radiance: String,
    /// `None` without references.
    pub reference: Option<String>,
}

/// A cell of a run; the run under another weight of views shares all but the scores with it.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishedCell {
    pub id: Arc<str>,
    /// Unused parameters are unset.
    pub point: Point,
    pub is_failed: bool,
    /// `None` for a failed cell and without references.
    pub scores: Option<MetricValues>,
    /// Expected scores of an exact image, from the reference's noise.
    pub noise_floors: MetricValues,
    /// Of a sequence of frames: lag bias and flicker (`run::columns::SteadinessColumns`).
    pub steadiness: Option<[f64; 2]>,
    pub reference: Option<ReferenceStop>,
    pub bins: Bins,
    /// With `[ladder]`: steps in order, over all n·v and then band by band.
    pub steps: Arc<Vec<StepRow>>,
    pub images: Option<Arc<CellImages>>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    pub environment: String,
    /// Luminance over the sphere and of the brightest texel.
    pub mean: f64,
    pub peak: f64,
}

#[derive(Clone, Debug)]
pub struct Finished {
    pub dir: PathBuf,
    pub provenance: Provenance,
    pub experiment: String,
    /// With the overrides of the run; `None` if this program does not understand it.
    pub config: Option<Config>,
    /// In plan order.
    pub cells: Vec<FinishedCell>,
    pub lights: Vec<Light>,
    pub timings: Vec<TimingRecord>,
    pub recovered: Vec<RecoveredRow>,
    pub failures: Vec<FailureRecord>,
    /// Weights of views to answer by, the leading one first.
    pub weights: Vec<Weight>,
    /// The weight of the scores of designs.
    pub weight: Weight,
}

impl Finished {
    /// Frees the scores by n·v, most of a run's numbers; questions need them, reports do not.
    pub fn drop_bins(&mut self) {
        let none = Bins::default();
        for cell in &mut self.cells {
            cell.bins = none.clone();
        }
    }

    /// The light of a point, if `environments.csv` has it.
    pub fn light(&self, point: &Point) -> Option<&Light> {
        let name = point[ENVIRONMENT].to_string();
        self.lights.iter().find(|light| light.environment == name)
    }

    /// The ε of relative metrics under the light of a point.
    pub fn epsilon(&self, point: &Point) -> Epsilon {
        let scale = if let Value::Number(scale) = point[ENVIRONMENT_SCALE] {
            scale
        } else {
            1.0
        };
        self.light(point).map_or(Epsilon::ABSOLUTE, |light| {
            Epsilon::of_light(light.mean * scale)
        })
    }

    /// What its answers do with the noise floors.
    pub fn noise_use(&self) -> NoiseUse {
        self.provenance.reference.noise_use()
    }

    /// The score of a cell as answers have it: without the reference's noise, unless references are
    /// exact. `None` for a failed cell.
    pub fn score(&self, cell: &FinishedCell, metric: &Metric) -> Option<f64> {
        let score = cell.scores.as_ref()?.get(metric.name)?;
        let floor = cell.noise_floors.get(metric.name);
        Some(self.noise_use().answered(metric, score, floor))
    }

    /// The devices of all sessions with their drivers, each once.
    pub fn devices(&self) -> Vec<String> {
        let sessions = self.provenance.sessions.iter();
        let devices: IndexSet<String> = sessions
            .map(|session| {
                let device = &session.device;
                device_words(&device.name, &device.driver, device.target.as_deref())
            })
            .collect();
        devices.into_iter().collect()
    }

    pub fn failed_count(&self) -> usize {
        self.cells.iter().filter(|cell| cell.is_failed).count()
    }

    /// Whether its cells are compared with references.
    pub fn is_scored(&self) -> bool {
        self.provenance.reference.method != UNSCORED
    }

    /// Whether some image is a picture rather than a design.
    pub fn has_pictures(&self) -> bool {
        self.cells
            .iter()
            .any(|cell| !is_design(&cell.point[SCENE].to_string()))
    }

    /// Whether times come from a CPU driver.
    pub fn is_cpu_timed(&self) -> bool {
        self.timings
            .iter()
            .any(|record| record.device_type == "cpu")
    }
}

/// The point with these texts by axis; an invalid text leaves its axis unset.
fn point_of(text: impl Fn(&'static str) -> Option<String>) -> Point {
    AXES.iter()
        .map(|axis| {
            let text = text(axis.name).filter(|text| !text.is_empty());
            text.and_then(|text| axis.kind.parse_text(&text).ok())
                .unwrap_or(Value::Unset)
        })
        .collect()
}
