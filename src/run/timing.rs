//! Timing of an experiment: which configurations are timed, and the statistics of the samples.
//!
//! Per-frame passes are timed once for each distinct configuration that can change their cost; passes that run once per
//! environment or model are timed apart from them.

use super::host::{HostState, UNKNOWN};
use super::statistics::{drift, median, median_interval, quantile};
use crate::experiment::axis::{AXES, Axis, ENVIRONMENT, METHOD, SAMPLES, SCENE, SIZE};
use crate::experiment::plan::{Cell, Plan};
use crate::shade::Method;
use crate::spelling::Listed;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::time::Duration;

/// Raw samples of one configuration.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct TimingRecord {
    /// The cell that stands for the configuration.
    pub cell: String,
    /// [`FRAME`] or [`PRECOMPUTE`].
    pub phase: String,
    /// Names the configurations that were timed in the same rounds.
    #[serde(default)]
    pub block: String,
    pub environment_size: [u32; 2],
    pub size: [u32; 2],
    /// The axes that tell configurations apart.
    pub axes: BTreeMap<String, String>,
    /// Executions before the first round.
    pub warmup: u32,
    /// When and in which place each round timed this configuration.
    #[serde(default)]
    pub rounds: Vec<Place>,
    pub passes: Vec<PassSamples>,
    pub wall_ms: Vec<f64>,
    pub device: String,
    pub device_type: String,
    pub driver: String,
    /// The machine before the block's first round and after its last.
    #[serde(default)]
    pub host: [HostState; 2],
}

/// Where one sample stands among those of its block.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Place {
    /// Place within the round, from 0.
    pub order: usize,
    /// Seconds since the first round of the block.
    pub start_s: f64,
}

/// Times of one pass, ms, one a round.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct PassSamples {
    pub pass: String,
    pub ms: Vec<f64>,
}

/// A configuration to time.
#[derive(Clone, Debug)]
pub struct TimingJob<'p> {
    /// Hash of the configuration and the number of rounds: the name of its record.
    pub id: String,
    pub phase: &'static str,
    /// Configurations of one block are compared, so they are timed in the same rounds.
    pub block: String,
    pub cell: &'p Cell,
    pub axes: BTreeMap<String, String>,
    pub environment_size: [u32; 2],
    pub size: [u32; 2],
}

/// The phase of passes that run once per environment or model.
pub const PRECOMPUTE: &str = "precompute";
/// The phase of passes that run for every frame.
pub const FRAME: &str = "frame";

/// A configuration that is not stable after a warm-up of this length is timed all the same; its drift stands in the table.
pub const WARMUP_TIME_MAX: Duration = Duration::from_secs(3);

/// Configurations to time, block after block in plan order; nothing without `[timing]`. The scene `design` is timed only in an experiment
/// without pictures.
pub fn jobs(plan: &Plan) -> Vec<TimingJob<'_>> {
    let Some(timing) = plan.config.timing else { return Vec::new() };
    let mut seen = BTreeSet::new();
    let mut jobs = Vec::new();
    /// Whether the time of a phase depends on an axis.
    type Costs = fn(&Axis) -> bool;
    let is_picture = |cell: &&Cell| !plan.inputs.scene(cell.point[SCENE].text()).is_design;
    let pictures: Vec<&Cell> = plan.cells.iter().filter(is_picture).collect();
    let timed = if pictures.is_empty() { plan.cells.iter().collect() } else { pictures };
    let phases: [(&str, Costs); 2] = [(PRECOMPUTE, |axis| axis.tables_cost), (FRAME, |axis| axis.frames_cost)];
    for (phase, matters) in phases {
        for &cell in &timed {
            let image = &plan.inputs.environment(cell.point[ENVIRONMENT].text()).image;
            let environment_size = [image.width, image.height];
            // All axes appear in every record, so that the table has one header; what does not matter stays empty.
            let all = AXES.iter().zip(&cell.point.0).filter(|(axis, _)| axis.tables_cost || axis.frames_cost);
            let axes: BTreeMap<String, String> = all
                .map(|(axis, value)| {
                    (axis.name.to_owned(), if matters(axis) { value.to_string() } else { String::new() })
                })
                .collect();
            let key = format!("{phase} {environment_size:?} {:?} {axes:?} {timing:?}", plan.size_of(cell));
            let id = blake3::hash(key.as_bytes()).to_hex()[..16].to_owned();
            if seen.insert(id.clone()) {
                // Tables are compared with nothing: each configuration is a block of its own.
                let is_compared = |name: &str| AXES.iter().any(|axis| axis.is_compared && axis.name == name);
                let shared = axes.iter().filter(|(name, _)| !is_compared(name));
                let words: Vec<String> = shared.map(|(name, value)| format!("{name}={value}")).collect();
                let block = match phase {
                    FRAME => format!("{environment_size:?} {:?} {}", plan.size_of(cell), words.join(" ")),
                    _ => id.clone(),
                };
                jobs.push(TimingJob { id, phase, block, cell, axes, environment_size, size: plan.size_of(cell) });
            }
        }
    }
    // Blocks in the order of their first member.
    let mut blocks: HashMap<String, usize> = HashMap::new();
    for job in &jobs {
        let next = blocks.len();
        blocks.entry(job.block.clone()).or_insert(next);
    }
    jobs.sort_by_key(|job| blocks[&job.block]);
    jobs
}

/// Values by axis name, of a timed configuration or of a set of tables; empty where an axis does not matter.
pub type Key = BTreeMap<String, String>;

/// Axes with more than one value in these keys, in the order of all axes. An empty value is none.
pub fn swept_axes<'k>(keys: impl IntoIterator<Item = &'k Key>) -> Vec<&'static str> {
    let mut values: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (name, value) in keys.into_iter().flatten().filter(|(_, value)| !value.is_empty()) {
        values.entry(name).or_default().insert(value);
    }
    let is_swept = |name: &&str| values.get(name).is_some_and(|values| values.len() > 1);
    AXES.iter().map(|axis| axis.name).filter(is_swept).collect()
}

/// Whether an axis tells methods apart, or how many samples one draws.
pub fn is_of_method(name: &str) -> bool {
    [METHOD, SAMPLES].iter().any(|&axis| AXES[axis].name == name)
}

/// Whether two keys have the same values wherever both have one, whatever their methods and sample counts.
pub fn is_alike(a: &Key, b: &Key) -> bool {
    let is_same = |value: &str, other: Option<&String>| {
        value.is_empty() || other.is_none_or(|other| other.is_empty() || other == value)
    };
    a.iter().filter(|(name, _)| !is_of_method(name)).all(|(name, value)| is_same(value, b.get(name)))
}

/// Order statistics of samples, ms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    pub n: usize,
    pub median: f64,
    /// Median absolute deviation from the median, unscaled.
    pub mad: f64,
    pub p05: f64,
    pub p95: f64,
    pub min: f64,
    /// 95 % interval of the median; NaN below six samples.
    pub interval: [f64; 2],
}

/// The statistics of samples; all NaN when there are none.
pub fn summarize(samples: &[f64]) -> Summary {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (median, mad) = centre(samples);
    Summary {
        n: sorted.len(),
        median,
        mad,
        p05: quantile(&sorted, 0.05),
        p95: quantile(&sorted, 0.95),
        min: quantile(&sorted, 0.0),
        interval: median_interval(samples),
    }
}

/// Median, and median absolute deviation from it: a summary without its interval, which takes a thousand times as long.
fn centre(samples: &[f64]) -> (f64, f64) {
    let middle = median(samples);
    let deviations: Vec<f64> = samples.iter().map(|x| (x - middle).abs()).collect();
    (middle, median(&deviations))
}

/// Passes may sum to this much more than the host's time: the clocks differ.
const WALL_RATIO_MAX: f64 = 1.05;
/// Below this share of the host's time, most of it is spent outside the timed passes.
const WALL_RATIO_MIN: f64 = 0.5;

/// Fewer samples than this say little about tails.
const FEW_SAMPLES: usize = 10;
/// Seconds of measurement from which on a trend is told for each minute: over less it is noise, many times enlarged.
const DRIFT_SECONDS_MIN: f64 = 10.0;
/// A drift that would move a time by this share within the measurement is named.
const DRIFT_NAMED: f64 = 0.05;
/// Samples this many scaled deviations from the median are outliers (\[Iglewicz93\] as hyperfine uses it).
const OUTLIER_Z: f64 = 14.826;

impl TimingRecord {
    /// All that tells the configuration apart but the size of its environment: its axes, and the size of the image.
    pub fn key(&self) -> Key {
        let [width, height] = self.size;
        let size = (AXES[SIZE].name.to_owned(), format!("{width}x{height}"));
        self.axes.clone().into_iter().chain([size]).collect()
    }

    /// The value on an axis; empty where it does not matter.
    pub fn value(&self, axis: usize) -> &str {
        self.axes.get(AXES[axis].name).map_or("", String::as_str)
    }

    /// The specular method, where this program knows it.
    pub fn method(&self) -> Option<&'static Method> {
        Method::by_name(self.value(METHOD))
    }

    /// Minutes from the first round to the last.
    fn minutes(&self) -> f64 {
        self.rounds.last().map_or(0.0, |place| place.start_s / 60.0)
    }

    /// Trend of a pass, in percent of its median a minute; NaN where the times of the rounds are not known, or all lie within
    /// `DRIFT_SECONDS_MIN`.
    pub fn drift_percent_per_min(&self, pass: &PassSamples) -> f64 {
        if 60.0 * self.minutes() < DRIFT_SECONDS_MIN { f64::NAN } else { self.trend(pass) }
    }

    fn trend(&self, pass: &PassSamples) -> f64 {
        let points: Vec<(f64, f64)> =
            self.rounds.iter().zip(&pass.ms).map(|(place, ms)| (place.start_s / 60.0, *ms)).collect();
        100.0 * drift(&points) / median(&pass.ms)
    }

    /// Why the clock was low before or after the rounds, as words with spaces; empty for nothing, `unknown` where nobody tells.
    pub fn slowdown(&self) -> String {
        let [before, after] = self.host.each_ref().map(HostState::slowdown);
        if before == after || after.is_empty() {
            before
        } else if before.is_empty() {
            after
        } else {
            format!("{before} {after}")
        }
    }

    /// Cautions, as words with spaces: `few-samples`, `drift`, `outliers`, `throttled`; empty for nothing.
    pub fn flags(&self, pass: &PassSamples) -> String {
        let (n, (middle, mad)) = (pass.ms.len(), centre(&pass.ms));
        let moved = self.trend(pass) / 100.0 * self.minutes();
        let is_outlier = |ms: &f64| mad > 0.0 && (ms - middle).abs() / mad > OUTLIER_Z;
        let flags = [
            ("few-samples", n < FEW_SAMPLES),
            ("drift", n >= FEW_SAMPLES && moved.abs() > DRIFT_NAMED),
            ("outliers", pass.ms.iter().any(is_outlier)),
            ("throttled", self.host.iter().any(|host| !["", UNKNOWN].contains(&host.slowdown().as_str()))),
        ];
        flags.iter().filter(|(_, is_set)| *is_set).map(|(name, _)| *name).collect::<Vec<_>>().join(" ")
    }

    /// Sum of the passes in each round, ms.
    pub fn sums_ms(&self) -> Vec<f64> {
        let rounds = self.passes.iter().map(|pass| pass.ms.len()).min().unwrap_or(0);
        (0..rounds).map(|round| self.passes.iter().map(|pass| pass.ms[round]).sum()).collect()
    }

    /// Median sum of the passes over the median of the host's time of the same submissions.
    pub fn passes_over_wall(&self) -> f64 {
        median(&self.sums_ms()) / median(&self.wall_ms)
    }

    /// `ok`, `passes-exceed-wall` (timestamps cannot be right) or `mostly-outside-passes`.
    pub fn wall_check(&self) -> &'static str {
        match self.passes_over_wall() {
            ratio if ratio > WALL_RATIO_MAX => "passes-exceed-wall",
            ratio if ratio < WALL_RATIO_MIN => "mostly-outside-passes",
            ratio if ratio.is_nan() => "no-samples",
            _ => "ok",
        }
    }
}
