//! `environments.csv`: one row for each environment.

use super::columns::{Columns, EnvironmentColumns};
use super::run_table::RunTable;
use crate::base::csv::Cell as Field;
use crate::experiment::axis::{AXES, ENVIRONMENT};
use crate::experiment::plan::Plan;
use crate::experiment::value::Value;
use crate::instrument::environment::Luminance;
use indexmap::IndexMap;

pub fn environments(plan: &Plan) -> RunTable<Vec<Vec<Field>>> {
    let mut lights: IndexMap<Value, Luminance> = IndexMap::new();
    for cell in &plan.cells {
        lights
            .entry(plan.shown(cell, ENVIRONMENT))
            .or_insert_with(|| {
                let input = plan.inputs.environment(cell.point[ENVIRONMENT].text());
                input.luminance
            });
    }
    let columns = std::iter::once(AXES[ENVIRONMENT].name.to_owned());
    let rows = lights.into_iter().map(|(name, luminance)| {
        let mut row = vec![Field::from(name.to_string())];
        row.extend(
            EnvironmentColumns {
                mean_luminance: luminance.mean,
                peak_luminance: luminance.peak,
                dynamic_range_stops: luminance.range_stops(),
            }
            .fields(),
        );
        row
    });
    RunTable {
        columns: columns.chain(EnvironmentColumns::names()).collect(),
        rows: rows.collect(),
    }
}
