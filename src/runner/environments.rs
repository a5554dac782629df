//! `environments.csv`: what the light of an experiment is like, one row for each environment and clip.

use super::axis::{AXES, ENVIRONMENT, ENVIRONMENT_CLIP};
use super::plan::Plan;
use super::tables::Rows;
use super::value::Value;
use crate::color::luminance;
use crate::environment::Environment;
use crate::table::csv::Cell as Field;
use std::f64::consts::PI;

/// The column of `environments.csv` with the dynamic range.
pub const RANGE_COLUMN: &str = "dynamic_range_stops";
/// Those with the mean and the peak.
pub const LUMINANCE_COLUMNS: [&str; 2] = ["mean_luminance", "peak_luminance"];

/// Luminance of an environment, in its own unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Luminance {
    /// Over the sphere of directions.
    pub mean: f64,
    /// Of the brightest texel.
    pub peak: f64,
}

impl Luminance {
    /// Measures an environment. Rows of texels are weighted by sin(theta), their share of the sphere.
    pub fn of(environment: &Environment) -> Self {
        let image = &environment.image;
        let (mut sum, mut weights, mut peak) = (0.0, 0.0, 0.0f64);
        for (row, texels) in image.data.chunks(image.width as usize).enumerate() {
            let weight = (PI * (row as f64 + 0.5) / f64::from(image.height)).sin();
            for texel in texels {
                let value = luminance(*texel);
                sum += weight * value;
                peak = peak.max(value);
            }
            weights += weight * texels.len() as f64;
        }
        Self { mean: sum / weights, peak }
    }

    /// Dynamic range: log2 of peak over mean; `None` for a black environment.
    pub fn range_stops(&self) -> Option<f64> {
        Some((self.peak / self.mean).log2()).filter(|stops| stops.is_finite())
    }
}

/// The axes of the light.
const LIGHT_AXES: [usize; 2] = [ENVIRONMENT, ENVIRONMENT_CLIP];

/// The light of each environment and clip (the values of the two axes as tables show them), in plan order.
pub fn lights(plan: &Plan) -> Vec<([Value; 2], Luminance)> {
    let mut found: Vec<([Value; 2], Luminance)> = Vec::new();
    for cell in &plan.cells {
        let key = LIGHT_AXES.map(|axis| plan.shown(cell, axis));
        if found.iter().all(|(known, _)| *known != key) {
            let settings = cell.point.settings();
            let environment = plan.inputs.clipped(&settings.environment, settings.environment_clip_log2);
            found.push((key, Luminance::of(&environment)));
        }
    }
    found
}

/// The rows of `environments.csv`, in plan order.
pub fn environments(plan: &Plan) -> Rows {
    let [mean, peak] = LUMINANCE_COLUMNS;
    let columns = LIGHT_AXES.iter().map(|&axis| AXES[axis].name).chain([mean, peak, RANGE_COLUMN]);
    let row = |(key, found): ([Value; 2], Luminance)| {
        let mut row = key.map(|value| Field::Text(value.to_string())).to_vec();
        row.extend([found.mean.into(), found.peak.into(), found.range_stops().into()]);
        row
    };
    (columns.map(str::to_owned).collect(), lights(plan).into_iter().map(row).collect())
}
