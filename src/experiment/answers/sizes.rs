//! How large tables must be: from which value of each of their parameters on a larger one gains nothing.

use super::effects::{Effect, against};
use super::study::Study;
use crate::experiment::axis::{AXES, is_precompute};

/// A larger value that takes no more than this share off the error gains nothing.
pub const GAIN: f64 = 0.05;

/// One parameter of the tables of one method.
#[derive(Clone, Debug, PartialEq)]
pub struct Enough {
    pub axis: String,
    /// "split-sum": the method whose tables these are.
    pub method: String,
    /// The smallest value from which on no larger one gains more than [`GAIN`], by the geometric mean of the ratios.
    pub value: String,
    /// The larger value that gains most, over this one; `None` for the largest tried.
    pub beyond: Option<Effect>,
    /// The next smaller value over this one; `None` for the smallest tried.
    pub below: Option<Effect>,
}

/// A number, or the product of a pair.
fn size_of(text: &str) -> Option<f64> {
    text.split('x').map(|part| part.parse::<f64>().ok()).try_fold(1.0, |product, side| Some(product * side?))
}

/// Every swept parameter of tables whose values have an order.
pub fn enough(study: &Study) -> Vec<Enough> {
    let is_swept = |name: &str| AXES.iter().any(|axis| axis.name == name && is_precompute(axis));
    let axes = study.axes.iter().enumerate().filter(|(_, axis)| is_swept(&axis.name));
    axes.flat_map(|(index, axis)| {
        let sized = axis.values.iter().filter(|value| !value.is_empty()).map(|value| Some((size_of(value)?, value)));
        let mut values: Vec<(f64, &String)> = sized.collect::<Option<_>>().unwrap_or_default();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        if values.len() < 2 { Vec::new() } else { of_axis(study, index, &values) }
    })
    .collect()
}

/// `values` ascend.
fn of_axis(study: &Study, axis: usize, values: &[(f64, &String)]) -> Vec<Enough> {
    let over = |base: &str| -> Vec<Effect> {
        against(study, axis, base).into_iter().filter(|effect| effect.alpha.is_none()).collect()
    };
    let tables: Vec<Vec<Effect>> = values.iter().map(|(_, base)| over(base)).collect();
    let mut methods: Vec<&str> = Vec::new();
    for effect in tables.iter().flatten() {
        if !methods.contains(&effect.method.as_str()) {
            methods.push(&effect.method);
        }
    }
    let place = |text: &str| values.iter().position(|(_, value)| *value == text);
    let of = |method: &str| {
        let best_beyond = |i: usize| {
            let larger = tables[i].iter().filter(|effect| effect.method == method && place(&effect.value) > Some(i));
            larger.min_by(|a, b| a.ratio.total_cmp(&b.ratio))
        };
        let is_enough = |i: &usize| best_beyond(*i).is_none_or(|effect| effect.ratio >= 1.0 - GAIN);
        let i = (0..values.len()).find(is_enough)?;
        let below = i.checked_sub(1).and_then(|smaller| {
            tables[i].iter().find(|effect| effect.method == method && place(&effect.value) == Some(smaller))
        });
        Some(Enough {
            axis: study.axes[axis].name.clone(),
            method: method.to_owned(),
            value: values[i].1.clone(),
            beyond: best_beyond(i).cloned(),
            below: below.cloned(),
        })
    };
    methods.into_iter().filter_map(of).collect()
}
