//! `environments.csv`: one row for each environment and clip.

use super::columns::ENVIRONMENTS;
use super::tables::Rows;
use crate::environment::Luminance;
use crate::experiment::axis::{AXES, ENVIRONMENT, ENVIRONMENT_CLIP};
use crate::experiment::plan::Plan;
use crate::experiment::value::Value;
use crate::table::csv::Cell as Field;
use indexmap::IndexMap;

const LIGHT_AXES: [usize; 2] = [ENVIRONMENT, ENVIRONMENT_CLIP];

pub fn environments(plan: &Plan) -> Rows {
    let mut lights: IndexMap<[Value; 2], Luminance> = IndexMap::new();
    for cell in &plan.cells {
        let light = || {
            let settings = cell.point.settings();
            plan.inputs.clipped(&settings.environment, settings.environment_clip_log2).luminance
        };
        lights.entry(LIGHT_AXES.map(|axis| plan.shown(cell, axis))).or_insert_with(light);
    }
    let columns = LIGHT_AXES.iter().map(|&axis| AXES[axis].name).chain(ENVIRONMENTS.iter().map(|column| column.name));
    let row = |(key, found): ([Value; 2], Luminance)| {
        let key = key.map(|value| Field::Text(value.to_string()));
        let numbers = [found.mean.into(), found.peak.into(), found.range_stops().into()];
        key.into_iter().chain(numbers).collect()
    };
    (columns.map(str::to_owned).collect(), lights.into_iter().map(row).collect())
}
