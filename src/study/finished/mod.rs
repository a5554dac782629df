//! A finished run as typed data: what every question and the page are answered from.
//!
//! It is read from the files of a folder, published or not: those of a run that has just ended, too.

mod notes;
mod read;

pub use notes::notes;
pub use read::{FinishedError, provenance};

use crate::experiment::axis::{AXES, ENVIRONMENT, ENVIRONMENT_CLIP, ENVIRONMENT_SCALE, Point, SCENE};
use crate::experiment::config::Config;
use crate::experiment::value::Value;
use crate::metrics::{Epsilon, METRICS};
use crate::run::store::{FailureRecord, StopReason};
use crate::run::timing::TimingRecord;
use serde_json::Value as Json;
use std::path::PathBuf;

/// One number a metric, in the order of [`METRICS`]; NaN where there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct MetricValues(Box<[f64]>);

impl MetricValues {
    /// Asks `value` for each metric by its name.
    pub fn of(value: impl Fn(&'static str) -> Option<f64>) -> Self {
        Self(METRICS.iter().map(|metric| value(metric.description().name).unwrap_or(f64::NAN)).collect())
    }

    /// The value of the metric of that name, where there is one.
    pub fn get(&self, name: &str) -> Option<f64> {
        let place = METRICS.iter().position(|metric| metric.description().name == name)?;
        Some(self.0[place]).filter(|value| !value.is_nan())
    }
}

/// The pixels with `n_dot_v` in [`lo`, `hi`).
#[derive(Clone, Debug, PartialEq)]
pub struct Bin {
    pub lo: f64,
    pub hi: f64,
    pub pixel_count: u64,
    pub scores: MetricValues,
}

/// One step of an error over the pixels with n·v in `seen`: see `run::columns::STEP_NUMBERS`.
#[derive(Clone, Debug, PartialEq)]
pub struct StepRow {
    pub seen: [f64; 2],
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

/// Where the reference of a cell stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    pub samples: u64,
    /// Relative standard error of the image.
    pub relative_error: f64,
    pub stopped_by: StopReason,
}

/// The files of `images/` that belong to a cell: linear EXR of the cell and of its reference.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellImages {
    pub radiance: String,
    pub reference: String,
}

/// One cell that was tried.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishedCell {
    pub id: String,
    /// Parameters that the cell does not use are unset.
    pub point: Point,
    /// Nothing for a failed cell.
    pub scores: Option<MetricValues>,
    /// The score to expect of an exact image, from the reference's own noise.
    pub noise_floors: MetricValues,
    /// Bias squared and variance of the relative error over point sets (`bias_variance` in the experiment).
    pub bias_variance: Option<[f64; 2]>,
    pub reference: Option<Stop>,
    pub bins: Vec<Bin>,
    /// Where its error comes from, with `[ladder]` in the experiment: steps in order, over all n·v and then band by band.
    pub steps: Vec<StepRow>,
    pub images: Option<CellImages>,
}

/// The light of an environment at one clip.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    pub environment: String,
    /// As the axis writes it; empty for the whole environment.
    pub clip_log2: String,
    /// Luminance over the sphere and of the brightest texel.
    pub mean: f64,
    pub peak: f64,
}

/// A finished run.
#[derive(Clone, Debug)]
pub struct Finished {
    pub dir: PathBuf,
    /// `provenance.json`.
    pub provenance: Json,
    /// The frozen experiment file.
    pub experiment: String,
    /// The experiment, with the overrides of the run; nothing where this program does not understand it.
    pub config: Option<Config>,
    /// In plan order.
    pub cells: Vec<FinishedCell>,
    pub lights: Vec<Light>,
    pub timings: Vec<TimingRecord>,
    pub failures: Vec<FailureRecord>,
    /// Whether a run is at work in the folder: only the cells that are done are here.
    pub is_under_way: bool,
}

impl Finished {
    /// A text of the provenance by JSON pointer; empty where there is none.
    pub fn text(&self, pointer: &str) -> String {
        match self.provenance.pointer(pointer) {
            Some(Json::String(text)) => text.clone(),
            Some(Json::Null) | None => String::new(),
            Some(value) => value.to_string(),
        }
    }

    /// The last invocation that did work, as a JSON pointer prefix.
    pub fn last_session(&self) -> String {
        let count = self.provenance["sessions"].as_array().map_or(0, Vec::len);
        format!("/sessions/{}", count.saturating_sub(1))
    }

    /// The light of a point; `None` where the run has no table of lights.
    pub fn light(&self, point: &Point) -> Option<&Light> {
        let texts = [ENVIRONMENT, ENVIRONMENT_CLIP].map(|axis| point[axis].to_string());
        self.lights.iter().find(|light| [&light.environment, &light.clip_log2] == [&texts[0], &texts[1]])
    }

    /// That of relative errors in the light of a point.
    pub fn epsilon(&self, point: &Point) -> Epsilon {
        let scale = if let Value::Number(scale) = point[ENVIRONMENT_SCALE] { scale } else { 1.0 };
        self.light(point).map_or(Epsilon::ABSOLUTE, |light| Epsilon::of_light(light.mean * scale))
    }

    /// Every device that did work, with its driver, each once.
    pub fn devices(&self) -> Vec<String> {
        let mut devices: Vec<String> = Vec::new();
        for session in 0..self.provenance["sessions"].as_array().map_or(0, Vec::len) {
            let text = |name: &str| self.text(&format!("/sessions/{session}/device/{name}"));
            let device = format!("{} ({})", text("name"), text("driver"));
            if !devices.contains(&device) {
                devices.push(device);
            }
        }
        devices
    }

    /// Cells without scores.
    pub fn failed_count(&self) -> usize {
        self.cells.iter().filter(|cell| cell.scores.is_none()).count()
    }

    /// How many of its cells a run that is under way has done.
    pub fn under_way_note(&self) -> Option<String> {
        let planned = self.provenance["cell_count"].as_u64().filter(|_| self.is_under_way)?;
        Some(format!("{}: under way: {} of {planned} cells", self.dir.display(), self.cells.len()))
    }

    /// The same run judged by the pixels with n·v from `lo` to `hi` alone; `None` where no cell has such bins. Bins are weighed by their pixels,
    /// so that only metrics that are means over pixels keep their meaning. Noise floors are not known by bin.
    pub fn seen_at(&self, [lo, hi]: [f64; 2]) -> Option<Self> {
        let cell = |cell: &FinishedCell| {
            let own: Vec<&Bin> =
                cell.bins.iter().filter(|bin| bin.lo >= lo && bin.hi <= hi && bin.pixel_count > 0).collect();
            let pixels = own.iter().map(|bin| bin.pixel_count as f64).sum::<f64>();
            let mean = |name: &str| {
                let sum =
                    own.iter().map(|bin| Some(bin.scores.get(name)? * bin.pixel_count as f64)).sum::<Option<f64>>()?;
                Some(sum / pixels).filter(|mean| mean.is_finite())
            };
            let scores = cell.scores.as_ref().map(|_| MetricValues::of(mean));
            FinishedCell { scores, noise_floors: MetricValues::of(|_| None), bins: Vec::new(), ..cell.clone() }
        };
        let has_bins = self.cells.iter().any(|cell| !cell.bins.is_empty());
        has_bins.then(|| Self { cells: self.cells.iter().map(cell).collect(), ..self.clone() })
    }

    /// Whether images are pictures; those of a design mean nothing to a reader.
    pub fn has_pictures(&self) -> bool {
        self.cells.iter().any(|cell| !crate::scene::is_design(&cell.point[SCENE].to_string()))
    }

    /// Whether times come from a driver that computes on the CPU.
    pub fn is_cpu_timed(&self) -> bool {
        self.timings.iter().any(|record| record.device_type == "cpu")
    }
}

/// The point whose axes have these texts, in the order of [`AXES`]; a text that an axis does not take leaves it unset.
fn point_of(text: impl Fn(&'static str) -> Option<String>) -> Point {
    Point(
        AXES.iter()
            .map(|axis| {
                let text = text(axis.name).filter(|text| !text.is_empty());
                text.and_then(|text| axis.kind.parse_text(&text).ok()).unwrap_or(Value::Unset)
            })
            .collect(),
    )
}
