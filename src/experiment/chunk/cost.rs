//! What work is expected to cost, from the experiment alone. A plan file must not depend on the machine that makes it, so nothing is
//! measured here: samples are counted and divided by a stated speed. Only the proportions matter for even chunks.

use crate::experiment::axis::{AXES, Point};
use crate::experiment::config::{Timing, Warmup};
use crate::experiment::estimate::Amount;
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::timing::{FRAME, TimingJob, WARMUP_TIME_MAX};
use serde::{Deserialize, Serialize};

/// The speeds that costs are reckoned with. A plan file holds those it was made with.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Rates {
    /// Samples of an image or a table drawn in one second.
    pub samples_per_second: f64,
    /// Scoring and writing of one cell of 128x128 to 256x256 pixels.
    pub seconds_per_cell: f64,
    /// Submission of one timed frame.
    pub seconds_per_frame: f64,
    /// Start of a process and its device.
    pub seconds_per_chunk: f64,
}

impl Default for Rates {
    /// A software driver on two cores.
    fn default() -> Self {
        Self { samples_per_second: 25e6, seconds_per_cell: 0.03, seconds_per_frame: 0.002, seconds_per_chunk: 1.0 }
    }
}

/// Frames that a warm-up until the times settle is taken to need: twice the window that is compared.
const STABLE_WARMUP_FRAMES: u32 = 64;

/// A table that an image needs: what tells it from others, and the samples it takes.
pub type Table = (String, f64);

impl Rates {
    /// Seconds for the image of a point and its repeats, without tables and reference.
    pub fn image(&self, plan: &Plan, point: &Point) -> f64 {
        let images = 1 + plan.repeats_of(point).unwrap_or(0);
        self.frame(plan, point) * f64::from(images)
    }

    /// Seconds for the reference of a cell: an upper bound where a relative error may end it earlier.
    pub fn reference(&self, plan: &Plan, cell: &Cell) -> f64 {
        self.frame(plan, &plan.reference_point(&cell.point))
    }

    /// Seconds for a table.
    pub fn table(&self, table: &Table) -> f64 {
        table.1 / self.samples_per_second
    }

    /// Seconds for timing a configuration of a block with `members` of them.
    pub fn timing(&self, plan: &Plan, job: &TimingJob, members: usize) -> f64 {
        let Some(timing) = plan.config.timing else { return 0.0 };
        let frame = match job.phase {
            FRAME => self.frame(plan, &job.cell.point),
            _ => tables(plan, &job.cell.point).iter().map(|table| self.table(table)).sum(),
        };
        (warmup_frames(timing).0 + timing_frames(timing, members)) * (frame + self.seconds_per_frame)
    }

    fn frame(&self, plan: &Plan, point: &Point) -> f64 {
        amount(plan, point).samples / self.samples_per_second
    }
}

/// Pixels of a point's image, and the samples that its terms draw at most.
pub fn amount(plan: &Plan, point: &Point) -> Amount {
    let settings = point.settings();
    let [width, height] = settings.size.map(f64::from);
    let specular = if settings.method.uses_samples { settings.samples } else { 1 };
    let diffuse = match settings.diffuse.name {
        "reference" => plan.config.reference.samples,
        _ => 0,
    };
    let pixels = width * height;
    Amount { pixels, samples: pixels * (f64::from(specular) + f64::from(diffuse)) }
}

/// Frames of a warm-up, and the seconds after which it ends in any case.
pub fn warmup_frames(timing: Timing) -> (f64, f64) {
    match timing.warmup {
        Warmup::Frames(frames) => (f64::from(frames), f64::INFINITY),
        Warmup::Stable => (f64::from(STABLE_WARMUP_FRAMES), WARMUP_TIME_MAX.as_secs_f64()),
    }
}

/// Frames of one configuration after its warm-up, in a block with `members` of them.
pub fn timing_frames(timing: Timing, members: usize) -> f64 {
    // A frame that does not count follows each change of configuration.
    let changes = if members > 1 { timing.rounds } else { 0 };
    f64::from(timing.rounds + changes)
}

/// The tables that the image of a point reads.
pub fn tables(plan: &Plan, point: &Point) -> Vec<Table> {
    let settings = point.settings();
    let precompute = &settings.precompute;
    let key = |kind: &str, names: &[&str], prefix: &str| {
        let axes = AXES.iter().zip(&point.0).filter(|(a, _)| names.contains(&a.name) || a.name.starts_with(prefix));
        axes.fold(kind.to_owned(), |key, (axis, value)| format!("{key} {}={value}", axis.name))
    };
    let samples = |pass: &str| precompute.samples_of(pass).unwrap_or(0.0);
    let mut tables = Vec::new();
    if settings.method.uses_prefiltered {
        let axes = ["environment", "environment_clip_log2", "brdf"];
        tables.push((key("prefilter", &axes, "prefilter_"), samples("prefilter")));
    }
    if settings.method.needs_dfg(settings.diffuse, !plan.config.lights.is_empty()) {
        tables.push((key("dfg", &["brdf", "masking"], "dfg_"), samples("dfg")));
    }
    if settings.diffuse.uses_irradiance_map {
        let axes = ["environment", "environment_clip_log2"];
        tables.push((key("irradiance", &axes, "irradiance_"), samples("irradiance")));
    }
    tables
}
