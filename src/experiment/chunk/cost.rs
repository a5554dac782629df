//! What work is expected to cost, from the experiment alone. A plan file must not depend on the machine that makes it, so nothing is
//! measured here: samples are counted and divided by a stated speed. Only the proportions matter for even chunks.

use crate::experiment::axis::{AXES, Point};
use crate::experiment::config::Warmup;
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::timing::{FRAME, TimingJob};
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
        let warmup = match timing.warmup {
            Warmup::Frames(frames) => frames,
            Warmup::Stable => STABLE_WARMUP_FRAMES,
        };
        // A frame that does not count follows each change of configuration.
        let changes = if members > 1 { timing.rounds } else { 0 };
        let frame = match job.phase {
            FRAME => self.frame(plan, &job.cell.point),
            _ => tables(plan, &job.cell.point).iter().map(|table| self.table(table)).sum(),
        };
        f64::from(warmup + timing.rounds + changes) * (frame + self.seconds_per_frame)
    }

    fn frame(&self, plan: &Plan, point: &Point) -> f64 {
        let settings = point.settings();
        let [width, height] = settings.size.map(f64::from);
        let specular = if settings.method.uses_samples { settings.samples } else { 1 };
        let diffuse = match settings.diffuse.name {
            "reference" => plan.config.reference.samples,
            _ => 0,
        };
        width * height * (f64::from(specular) + f64::from(diffuse)) / self.samples_per_second
    }
}

/// The tables that the image of a point reads.
pub fn tables(plan: &Plan, point: &Point) -> Vec<Table> {
    let settings = point.settings();
    let precompute = &settings.precompute;
    let key = |kind: &str, names: &[&str], prefix: &str| {
        let axes = AXES.iter().zip(&point.0).filter(|(a, _)| names.contains(&a.name) || a.name.starts_with(prefix));
        axes.fold(kind.to_owned(), |key, (axis, value)| format!("{key} {}={value}", axis.name))
    };
    let texels = |size: [u32; 2]| f64::from(size[0]) * f64::from(size[1]);
    let mut tables = Vec::new();
    if settings.method.uses_prefiltered {
        // Each level has a quarter of the texels of the one before.
        let levels = (0..precompute.prefilter_level_count).map(|level| 0.25_f64.powi(level as i32)).sum::<f64>();
        let samples = texels(precompute.prefilter_size) * levels * f64::from(precompute.prefilter_sample_count);
        tables.push((key("prefilter", &["environment", "environment_clip_log2", "brdf"], "prefilter_"), samples));
    }
    if settings.method.needs_dfg(settings.diffuse, !plan.config.lights.is_empty()) {
        let samples = f64::from(precompute.dfg_size).powi(2) * f64::from(precompute.dfg_sample_count);
        tables.push((key("dfg", &["brdf", "masking"], "dfg_"), samples));
    }
    if settings.diffuse.uses_irradiance_map {
        let samples = texels(precompute.irradiance_size) * texels(precompute.irradiance_sample_count);
        tables.push((key("irradiance", &["environment", "environment_clip_log2"], "irradiance_"), samples));
    }
    tables
}
