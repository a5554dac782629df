//! `environments.csv`: what the light of an experiment is like, one row for each environment and clip.

use super::tables::Rows;
use crate::environment::Luminance;
use crate::experiment::axis::{AXES, ENVIRONMENT, ENVIRONMENT_CLIP};
use crate::experiment::plan::Plan;
use crate::experiment::value::Value;
use crate::table::csv::Cell as Field;

/// The column of `environments.csv` with the dynamic range.
pub const RANGE_COLUMN: &str = "dynamic_range_stops";
/// Those with the mean and the peak.
pub const LUMINANCE_COLUMNS: [&str; 2] = ["mean_luminance", "peak_luminance"];

/// The axes of the light.
const LIGHT_AXES: [usize; 2] = [ENVIRONMENT, ENVIRONMENT_CLIP];

/// The light of each environment and clip (the values of the two axes, as tables show them), in plan order.
pub fn lights(plan: &Plan) -> Vec<([Value; 2], Luminance)> {
    let mut found: Vec<([Value; 2], Luminance)> = Vec::new();
    for cell in &plan.cells {
        let key = LIGHT_AXES.map(|axis| plan.shown(cell, axis));
        if found.iter().all(|(known, _)| *known != key) {
            let settings = cell.point.settings();
            let light = plan.inputs.clipped(&settings.environment, settings.environment_clip_log2);
            found.push((key, light.luminance));
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
