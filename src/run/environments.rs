//! `environments.csv`: one row for each environment.

use super::columns::ENVIRONMENTS;
use super::tables::Rows;
use crate::base::csv::Cell as Field;
use crate::experiment::axis::{AXES, ENVIRONMENT};
use crate::experiment::plan::Plan;
use crate::experiment::value::Value;
use crate::instrument::environment::Luminance;
use indexmap::IndexMap;

pub fn environments(plan: &Plan) -> Rows {
    let mut lights: IndexMap<Value, Luminance> = IndexMap::new();
    for cell in &plan.cells {
        let light = || {
            plan.inputs
                .environment(cell.point[ENVIRONMENT].text())
                .luminance
        };
        lights
            .entry(plan.shown(cell, ENVIRONMENT))
            .or_insert_with(light);
    }
    let columns = std::iter::once(AXES[ENVIRONMENT].name)
        .chain(ENVIRONMENTS.iter().map(|column| column.name));
    let row = |(name, found): (Value, Luminance)| {
        vec![
            Field::Text(name.to_string()),
            found.mean.into(),
            found.peak.into(),
            found.range_stops().into(),
        ]
    };
    (
        columns.map(str::to_owned).collect(),
        lights.into_iter().map(row).collect(),
    )
}
