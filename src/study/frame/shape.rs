//! The values of each axis of an experiment, which decide before rendering which questions it can
//! answer.

use super::Row;
use crate::base::names::Listed;
use crate::experiment::axis::{AXES, AxisId, METHOD, PerAxis};
use crate::experiment::config::Config;
use crate::experiment::value::Value;
use crate::instrument::shade::{METHODS, Method};
use crate::study::finished::Finished;

#[derive(Clone, Debug)]
pub struct Shape {
    /// Distinct set values by axis, in the order of the experiment.
    pub values: PerAxis<Vec<Value>>,
    pub has_timing: bool,
    pub has_ladder: bool,
    pub has_recovery: bool,
    /// Whether cells are compared with references.
    pub is_scored: bool,
    pub reference_method: String,
}

impl Shape {
    pub fn of_config(config: &Config) -> Self {
        let values = |axis: AxisId| match config.axes.iter().find(|sweep| sweep.axis == axis) {
            Some(sweep) => {
                super::distinct_in_order(sweep.values.iter().map(|placed| placed.value.clone()))
            }
            None => vec![config.base[axis].clone()],
        };
        Self::with(config, AXES.ids().map(values).collect())
    }

    pub fn of_rows(run: &Finished, rows: &[Row]) -> Self {
        let of_axis = |axis: AxisId| rows.iter().map(move |row: &Row| row.point[axis].clone());
        let values = AXES
            .ids()
            .map(|axis| super::distinct_in_order(of_axis(axis)))
            .collect();
        match &run.config {
            Some(config) => Self::with(config, values),
            None => Self {
                values: set_only(values),
                has_timing: !run.timings.is_empty(),
                has_ladder: false,
                has_recovery: !run.recovered.is_empty(),
                is_scored: run.is_scored(),
                reference_method: run.provenance.reference.method.clone(),
            },
        }
    }

    fn with(config: &Config, values: PerAxis<Vec<Value>>) -> Self {
        Self {
            values: set_only(values),
            has_timing: config.timing.is_some(),
            has_ladder: config.ladder.is_some(),
            has_recovery: config.recovery.is_some(),
            is_scored: config.is_scored,
            reference_method: config.reference.method.clone(),
        }
    }

    pub fn is_swept(&self, axis: AxisId) -> bool {
        self.values[axis].len() > 1
    }

    /// The methods with a specular term: built-in ones in the order of their list, then those in
    /// files.
    pub fn methods(&self) -> impl Iterator<Item = &'static Method> {
        let mut methods: Vec<_> = self.values[METHOD]
            .iter()
            .filter_map(|value| Method::by_name(value.text()))
            .collect();
        methods.retain(|method| !method.is_none());
        methods.sort_by_key(|method| {
            METHODS
                .iter()
                .position(|listed| listed.name == method.name)
                .unwrap_or(usize::MAX)
        });
        methods.into_iter()
    }
}

fn set_only(mut values: PerAxis<Vec<Value>>) -> PerAxis<Vec<Value>> {
    values
        .iter_mut()
        .for_each(|values| values.retain(|value| *value != Value::Unset));
    values
}
