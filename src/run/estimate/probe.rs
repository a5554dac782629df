//! How fast a device is beside the one that the constants stand for: one small image of the plan, timed.

use super::constants::{SAMPLES_PER_SECOND, constants};
use super::items::{amount, kind_of};
use crate::experiment::axis::{DIFFUSE_METHOD, METHOD, SAMPLES, SIZE};
use crate::experiment::plan::Plan;
use crate::experiment::value::Value;
use crate::precompute::PrecomputeSettings;
use crate::run::renderer::{RenderFault, Renderer};
use crate::shade::{METHODS, NONE};
use std::time::Instant;

/// Side of the image: a software driver takes tenths of a second for it.
const SIDE: u32 = 256;
/// Samples a pixel.
const SAMPLE_COUNT: u32 = 64;
/// The first image also makes its tables; the fastest of the others counts.
const IMAGE_COUNT: usize = 3;

/// Samples that the first method of the list draws in a second on the device; `None` for a plan without cells. What else a frame costs is taken
/// to be in the same proportion as on the device of the constants.
pub fn samples_per_second(plan: &Plan, renderer: &mut dyn Renderer) -> Result<Option<f64>, RenderFault> {
    let Some(cell) = plan.cells.first() else { return Ok(None) };
    let mut point = cell.point.clone();
    point[METHOD] = Value::from(METHODS[0].name);
    point[DIFFUSE_METHOD] = Value::from(NONE);
    point[SAMPLES] = Value::Count(SAMPLE_COUNT);
    point[SIZE] = Value::Pair(point[SIZE].pair().map(|side| side.min(SIDE)));
    let request = plan.request(&point).shaded(|s| s.precompute = PrecomputeSettings::default());
    let mut fastest_s = f64::INFINITY;
    for image in 0..=IMAGE_COUNT {
        let started = Instant::now();
        renderer.render(&request)?;
        if image > 0 {
            fastest_s = fastest_s.min(started.elapsed().as_secs_f64());
        }
    }
    let stated_s = constants().line(&kind_of("image", &point)).map_or(0.0, |line| line.at(amount(plan, &point)));
    Ok(Some(SAMPLES_PER_SECOND * stated_s / fastest_s.max(f64::MIN_POSITIVE)))
}
