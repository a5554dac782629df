//! The timed configurations of an experiment, and the statistics of their samples.
//!
//! Passes of a frame are timed once for each configuration that can change their cost, apart from
//! passes that run once per environment or model.

use crate::base::math::order_statistics::median;
use crate::base::names::Listed;
use crate::experiment::axis::{AXES, AxisId, ENVIRONMENT, METHOD, SAMPLES, SCENE, SIZE};
use crate::experiment::id::Id;
use crate::experiment::plan::{Cell, Plan};
use crate::instrument::precompute::prefilter;
use crate::instrument::shade::Method;
use crate::instrument::shade::pass::{DIFFUSE_PASS, SPECULAR_PASS};
use indexmap::IndexSet;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct TimingRecord {
    /// A cell with this configuration.
    pub cell: Id,
    /// [`FRAME`] or [`PRECOMPUTE`].
    pub phase: String,
    /// Configurations of one block were timed in the same rounds.
    #[serde(default)]
    pub block: String,
    pub environment_size: [u32; 2],
    pub size: [u32; 2],
    /// Axes that change times.
    pub axes: BTreeMap<String, String>,
    /// Executions before the first round.
    pub warmup: u32,
    /// Order and time in each round.
    #[serde(default)]
    pub rounds: Vec<RoundPosition>,
    pub passes: Vec<PassSamples>,
    pub wall_ms: Vec<f64>,
    pub device: String,
    pub device_type: String,
    pub driver: String,
    /// As in [`DeviceInfo`](crate::instrument::gpu::DeviceInfo).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<String>,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct RoundPosition {
    /// Within the round, from 0.
    pub order: usize,
    /// Seconds since the first round of the block.
    pub start_s: f64,
}

/// If the passes of a method take less than this on a CPU, ms, one frame runs before each that
/// counts, because the first one after another configuration finds caches of that. Without it
/// frames of 50 to 220 ms take at most 2 % longer, which is within the noise of five pairs of runs.
pub const LONG_MS: f64 = 25.0;

/// Times of one pass, ms, one per round.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct PassSamples {
    pub pass: String,
    pub ms: Vec<f64>,
}

impl PassSamples {
    /// The table that the pass fills: the levels of a prefiltered map are passes of one table.
    pub fn table(&self) -> &str {
        if prefilter::pass::PASSES.contains(&self.pass.as_str()) {
            prefilter::pass::TABLE
        } else {
            &self.pass
        }
    }
}

/// A configuration to time.
#[derive(Clone, Debug)]
pub struct TimingJob<'p> {
    /// Hash of the configuration and the number of rounds.
    pub id: Id,
    pub phase: &'static str,
    /// Configurations of one block are compared and timed in the same rounds.
    pub block: String,
    pub cell: &'p Cell,
    pub axes: BTreeMap<String, String>,
    pub environment_size: [u32; 2],
    pub size: [u32; 2],
}

/// Phase of passes that run once per environment or model.
pub const PRECOMPUTE: &str = "precompute";
/// Phase of passes that run for every frame.
pub const FRAME: &str = "frame";

/// Configurations to time, block by block in plan order.
pub fn jobs(plan: &Plan) -> Vec<TimingJob<'_>> {
    let Some(timing) = plan.config.timing else {
        return Vec::new();
    };
    let cells = timed_cells(plan);
    let mut ids = BTreeSet::new();
    let mut jobs = Vec::new();
    for phase in [PRECOMPUTE, FRAME] {
        for &cell in &cells {
            let input = plan.inputs.environment(cell.point[ENVIRONMENT].text());
            let environment_size = [input.image.width, input.image.height];
            let size = plan.size_of(cell);
            let axes = timed_axes(cell, phase);
            let key = format!("{phase} {environment_size:?} {size:?} {axes:?} {timing:?}");
            let id = Id::of_text(&key);
            if !ids.insert(id) {
                continue;
            }
            // Tables are not compared: each configuration is a block.
            let block = if phase == FRAME {
                format!("{environment_size:?} {size:?} {}", shared_values(&axes))
            } else {
                id.to_string()
            };
            jobs.push(TimingJob {
                id,
                phase,
                block,
                cell,
                axes,
                environment_size,
                size,
            });
        }
    }
    // Blocks in the order of their first member.
    let blocks: IndexSet<String> = jobs.iter().map(|job| job.block.clone()).collect();
    jobs.sort_by_key(|job| blocks.get_index_of(&job.block));
    jobs
}

/// The cells to time: the scene `design` only if there is no other.
fn timed_cells(plan: &Plan) -> Vec<&Cell> {
    let is_picture = |cell: &&Cell| !plan.inputs.scene(cell.point[SCENE].text()).is_design;
    let pictures: Vec<&Cell> = plan.cells.iter().filter(is_picture).collect();
    if pictures.is_empty() {
        plan.cells.iter().collect()
    } else {
        pictures
    }
}

/// The values that change the times of a phase. Every record has the axes of both phases, so that
/// the table has one header; values that do not matter are empty.
fn timed_axes(cell: &Cell, phase: &str) -> Key {
    let mut values = Key::new();
    for (axis, value) in AXES.iter().zip(cell.point.values()) {
        if !axis.tables_cost && !axis.frames_cost {
            continue;
        }
        let matters = if phase == PRECOMPUTE {
            axis.tables_cost
        } else {
            axis.frames_cost
        };
        let text = if matters {
            value.to_string()
        } else {
            String::new()
        };
        values.insert(axis.name.to_owned(), text);
    }
    values
}

/// The values that frames of one block share.
fn shared_values(axes: &Key) -> String {
    let is_compared = |name: &str| {
        AXES.iter()
            .any(|axis| axis.is_compared && axis.name == name)
    };
    let words: Vec<String> = axes
        .iter()
        .filter(|(name, _)| !is_compared(name))
        .map(|(name, value)| format!("{name}={value}"))
        .collect();
    words.join(" ")
}

/// Values by axis name; empty if the axis is irrelevant.
pub type Key = BTreeMap<String, String>;

/// Axes with more than one non-empty value, in the order of all axes.
pub fn swept_axes<'k>(keys: impl IntoIterator<Item = &'k Key>) -> Vec<&'static str> {
    let mut values: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (name, value) in keys
        .into_iter()
        .flatten()
        .filter(|(_, value)| !value.is_empty())
    {
        values.entry(name).or_default().insert(value);
    }
    let is_swept = |name: &&str| values.get(name).is_some_and(|values| values.len() > 1);
    AXES.iter().map(|axis| axis.name).filter(is_swept).collect()
}

/// Whether two keys agree on all axes that both use, except method and sample count.
pub fn is_alike(a: &Key, b: &Key) -> bool {
    let is_same = |value: &str, other: Option<&String>| {
        value.is_empty() || other.is_none_or(|other| other.is_empty() || other == value)
    };
    let of_method = [METHOD, SAMPLES].map(|axis| AXES[axis].name);
    a.iter()
        .filter(|(name, _)| !of_method.contains(&name.as_str()))
        .all(|(name, value)| is_same(value, b.get(name)))
}

/// Passes may sum to slightly more than the host's time: the clocks differ.
const WALL_RATIO_MAX: f64 = 1.05;
/// Below this, most of the host's time is outside the timed passes.
const WALL_RATIO_MIN: f64 = 0.5;

impl TimingRecord {
    /// Axes and image size.
    pub fn key(&self) -> Key {
        let [width, height] = self.size;
        let size = (AXES[SIZE].name.to_owned(), format!("{width}x{height}"));
        self.axes.clone().into_iter().chain([size]).collect()
    }

    /// The value on an axis; empty if irrelevant.
    pub fn value(&self, axis: AxisId) -> &str {
        self.axes.get(AXES[axis].name).map_or("", String::as_str)
    }

    /// The specular method; `None` if unknown.
    pub fn method(&self) -> Option<&'static Method> {
        Method::by_name(self.value(METHOD))
    }

    /// Sum of the passes in each round, ms.
    pub fn sums_ms(&self) -> Vec<f64> {
        self.sums_where(|_| true)
    }

    /// The same of the passes that differ between methods: no g-buffer, background or tone curve.
    pub fn shading_ms(&self) -> Vec<f64> {
        self.sums_where(|pass| [SPECULAR_PASS, DIFFUSE_PASS].contains(&pass))
    }

    fn sums_where(&self, counts: fn(&str) -> bool) -> Vec<f64> {
        let passes = || self.passes.iter().filter(|pass| counts(&pass.pass));
        let rounds = passes().map(|pass| pass.ms.len()).min().unwrap_or(0);
        (0..rounds)
            .map(|round| passes().map(|pass| pass.ms[round]).sum())
            .collect()
    }

    /// Median sum of the passes over the median host time of the same submissions.
    pub fn passes_over_wall(&self) -> f64 {
        median(&self.sums_ms()) / median(&self.wall_ms)
    }

    /// `ok`, `passes-exceed-wall` (wrong timestamps), `mostly-outside-passes` or `no-samples`.
    pub fn wall_check(&self) -> &'static str {
        match self.passes_over_wall() {
            ratio if ratio > WALL_RATIO_MAX => "passes-exceed-wall",
            ratio if ratio < WALL_RATIO_MIN => "mostly-outside-passes",
            ratio if ratio.is_nan() => "no-samples",
            _ => "ok",
        }
    }
}
