//! Timing of an experiment: which configurations are timed, and the statistics of the samples.
//!
//! Per-frame passes are timed once for each distinct configuration that can change their cost; passes that run once per
//! environment or model are timed apart from them.

use super::axis::{AXES, is_precompute};
use super::plan::{Cell, Plan};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Raw samples of one configuration.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct TimingRecord {
    /// The cell that stands for the configuration.
    pub cell: String,
    /// [`FRAME`] or [`PRECOMPUTE`].
    pub phase: String,
    pub environment_size: [u32; 2],
    pub size: [u32; 2],
    /// The axes that tell configurations apart.
    pub axes: BTreeMap<String, String>,
    pub warmup: u32,
    pub passes: Vec<PassSamples>,
    pub wall_ms: Vec<f64>,
    pub device: String,
    pub device_type: String,
    pub driver: String,
}

/// Times of one pass, ms, one a round.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct PassSamples {
    pub pass: String,
    pub ms: Vec<f64>,
}

/// A configuration to time.
#[derive(Debug)]
pub struct TimingJob<'p> {
    /// Hash of the configuration and the number of rounds: the name of its record.
    pub id: String,
    pub phase: &'static str,
    pub cell: &'p Cell,
    pub axes: BTreeMap<String, String>,
    pub environment_size: [u32; 2],
}

/// The phase of passes that run once per environment or model.
pub const PRECOMPUTE: &str = "precompute";
/// The phase of passes that run for every frame.
pub const FRAME: &str = "frame";

/// Axes that change the cost of a frame. `alpha` is not one: all widths run the same instructions.
const FRAME_AXES: &[&str] = &["scene", "brdf", "method", "diffuse", "samples", "masking"];
/// Axes besides those of the precompute settings that change which tables are made, and their cost.
const PRECOMPUTE_AXES: &[&str] = &["brdf", "method", "diffuse", "masking"];

/// What is to be timed, in plan order; nothing without `[timing]`.
pub fn jobs(plan: &Plan) -> Vec<TimingJob<'_>> {
    let Some(timing) = plan.config.timing else { return Vec::new() };
    let precompute_axes: Vec<&str> =
        PRECOMPUTE_AXES.iter().copied().chain(AXES.iter().filter(|a| is_precompute(a)).map(|a| a.name)).collect();
    let mut seen = BTreeSet::new();
    let mut jobs = Vec::new();
    for (phase, names) in [(PRECOMPUTE, precompute_axes.as_slice()), (FRAME, FRAME_AXES)] {
        for cell in &plan.cells {
            let image = &plan.inputs.environment(cell.point.get("environment").text()).image;
            let environment_size = [image.width, image.height];
            // All axes appear in every record, so that the table has one header; what does not matter stays empty.
            let all = FRAME_AXES.iter().chain(&precompute_axes);
            let axes: BTreeMap<String, String> = all
                .map(|name| {
                    let text = if names.contains(name) { cell.point.get(name).to_string() } else { String::new() };
                    (name.to_string(), text)
                })
                .collect();
            let key = format!("{phase} {environment_size:?} {:?} {axes:?} {timing:?}", plan.size_of(cell));
            let id = blake3::hash(key.as_bytes()).to_hex()[..16].to_owned();
            if seen.insert(id.clone()) {
                jobs.push(TimingJob { id, phase, cell, axes, environment_size });
            }
        }
    }
    jobs
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
}

/// The statistics of samples; all NaN when there are none.
pub fn summarize(samples: &[f64]) -> Summary {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let median = quantile(&sorted, 0.5);
    let mut deviations: Vec<f64> = sorted.iter().map(|x| (x - median).abs()).collect();
    deviations.sort_by(f64::total_cmp);
    Summary {
        n: sorted.len(),
        median,
        mad: quantile(&deviations, 0.5),
        p05: quantile(&sorted, 0.05),
        p95: quantile(&sorted, 0.95),
        min: quantile(&sorted, 0.0),
    }
}

/// Quantile of ascending samples with linear interpolation between them ([HyndmanFan96] type 7); NaN when there are none.
fn quantile(sorted: &[f64], p: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = p * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// Passes may sum to this much more than the host's time: the clocks differ.
const WALL_RATIO_MAX: f64 = 1.05;
/// Below this share of the host's time, most of it is spent outside the timed passes.
const WALL_RATIO_MIN: f64 = 0.5;

impl TimingRecord {
    /// Sum of the passes in each round, ms.
    pub fn sums_ms(&self) -> Vec<f64> {
        let rounds = self.passes.iter().map(|pass| pass.ms.len()).min().unwrap_or(0);
        (0..rounds).map(|round| self.passes.iter().map(|pass| pass.ms[round]).sum()).collect()
    }

    /// Median sum of the passes over the median of the host's time of the same submissions.
    pub fn passes_over_wall(&self) -> f64 {
        summarize(&self.sums_ms()).median / summarize(&self.wall_ms).median
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
