//! How large tables must be: from which value of each of their parameters on a larger one gains nothing.
//!
//! Each parameter is judged where the others have their base, the first value of the experiment, or a larger one: beside a table that is too
//! small in one way, another way to make it smaller costs nothing.

use super::effects::{Effect, against};
use super::study::{Row, Study};
use crate::runner::axis::{AXES, is_precompute};

/// A larger value that takes no more than this share off the error gains nothing.
pub const GAIN: f64 = 0.05;

/// One parameter of the tables of one method.
#[derive(Clone, Debug, PartialEq)]
pub struct Enough {
    pub axis: String,
    /// "split-sum": the method whose tables these are.
    pub method: String,
    /// The smallest value, of those that were tried beside such others, from which on no larger one gains more than [`GAIN`], by the geometric mean of the ratios.
    pub value: String,
    /// The value in the smallest combination that was tried of values that are all enough: another parameter may need a larger one. As
    /// `value` where none was tried.
    pub together: String,
    /// The larger value that gains most, over this one; `None` for the largest tried.
    pub beyond: Option<Effect>,
    /// The next smaller value over this one; `None` for the smallest tried.
    pub below: Option<Effect>,
}

/// The parameter that the answer is about: of those with a larger value tried, the one whose next smaller value costs most; the first where none
/// costs.
pub fn leading(all: &[Enough]) -> Option<&Enough> {
    let method = &all.first()?.method;
    let own = || all.iter().filter(|one| one.method == *method);
    let cost = |one: &&Enough| one.below.as_ref().filter(|below| below.is_decided()).map_or(0.0, |below| below.ratio);
    let settled = own().filter(|one| one.beyond.is_some());
    // Of equals the first.
    settled.rev().max_by(|a, b| cost(a).total_cmp(&cost(b))).or_else(|| own().next())
}

/// A number, or the product of a pair.
pub fn size_of(text: &str) -> Option<f64> {
    text.split('x').map(|part| part.parse::<f64>().ok()).try_fold(1.0, |product, side| Some(product * side?))
}

/// Every swept parameter of tables whose values have an order.
pub fn enough(study: &Study) -> Vec<Enough> {
    let is_swept = |name: &str| AXES.iter().any(|axis| axis.name == name && is_precompute(axis));
    let axes = study.axes.iter().enumerate().filter(|(_, axis)| is_swept(&axis.name));
    let parameters: Vec<Parameter> = axes.filter_map(|(index, axis)| Parameter::new(index, &axis.values)).collect();
    let mut found: Vec<Enough> = parameters.iter().flat_map(|one| of_axis(study, one, &parameters)).collect();
    let mut methods: Vec<String> = Vec::new();
    for method in found.iter().map(|one| one.method.clone()) {
        if !methods.contains(&method) {
            methods.push(method);
        }
    }
    methods.iter().for_each(|method| set_together(study, method, &mut found));
    found
}

/// Finds the smallest tried combination, by the product of its sizes, that has of each parameter what is enough.
fn set_together(study: &Study, method: &str, found: &mut [Enough]) {
    let places: Vec<usize> = (0..found.len()).filter(|&i| found[i].method == method).collect();
    let combination = |row: &&Row| -> Option<(f64, Vec<String>)> {
        let texts: Vec<String> = places.iter().map(|&i| study.value(row, &found[i].axis).to_owned()).collect();
        let sizes: Option<Vec<f64>> = texts.iter().map(|text| size_of(text)).collect();
        let is_enough = |(size, &i): (&f64, &usize)| size_of(&found[i].value).is_some_and(|least| *size >= least);
        let sizes = sizes.filter(|sizes| sizes.iter().zip(&places).all(is_enough))?;
        Some((sizes.iter().product(), texts))
    };
    let images = study.images();
    let own = images.iter().filter(|row| row.error.is_some() && study.method_label(row) == method);
    let smallest = own.filter_map(combination).min_by(|a, b| a.0.total_cmp(&b.0));
    for (text, i) in smallest.into_iter().flat_map(|(_, texts)| texts).zip(places) {
        found[i].together = text;
    }
}

/// A swept parameter with its values, ascending.
struct Parameter<'s> {
    axis: usize,
    values: Vec<(f64, &'s String)>,
    base: f64,
}

impl<'s> Parameter<'s> {
    fn new(axis: usize, values: &'s [String]) -> Option<Self> {
        let sized = values.iter().filter(|value| !value.is_empty()).map(|value| Some((size_of(value)?, value)));
        let mut values: Vec<(f64, &String)> = sized.collect::<Option<_>>()?;
        let base = values.first()?.0;
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        (values.len() > 1).then_some(Self { axis, values, base })
    }
}

fn of_axis(study: &Study, own: &Parameter, all: &[Parameter]) -> Vec<Enough> {
    let Parameter { axis, ref values, .. } = *own;
    let is_beside_large = |row: &Row| {
        let is_large = |other: &Parameter| size_of(&row.axes[other.axis]).is_none_or(|size| size >= other.base);
        all.iter().all(|other| other.axis == axis || is_large(other))
    };
    let over = |base: &str| -> Vec<Effect> {
        against(study, axis, base, &is_beside_large).into_iter().filter(|effect| effect.alpha.is_none()).collect()
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
        // A value that no pair has was not tried beside such others.
        let is_tried = |i: &usize| tables[*i].iter().any(|effect| effect.method == method);
        let i = (0..values.len()).filter(is_tried).find(is_enough)?;
        let smaller = tables[i].iter().filter(|effect| effect.method == method && place(&effect.value) < Some(i));
        let below = smaller.max_by_key(|effect| place(&effect.value));
        Some(Enough {
            axis: study.axes[axis].name.clone(),
            method: method.to_owned(),
            value: values[i].1.clone(),
            together: values[i].1.clone(),
            beyond: best_beyond(i).cloned(),
            below: below.cloned(),
        })
    };
    methods.into_iter().filter_map(of).collect()
}
