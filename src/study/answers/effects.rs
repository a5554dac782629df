//! What each parameter of a method does to its error: ratios of pairs of cells that differ in that parameter alone.
//!
//! For a swept axis, its first value is the base. Every cell with another value is divided by the cell that has the base and agrees
//! on all other axes; the ratio's geometric mean over all cases has Student's 95 % interval in logarithms. A case is one reference: its
//! point sets, and its pairs at different values of other parameters, are averaged first and count as one pair, because they share all that
//! makes cases differ and would narrow the interval without telling more. An axis that one of the two cells does not use stands at its
//! default in the other.
//!
//! A pair of which both errors are within the reference's noise tells nothing and is left out. Where one of the two is, the ratio is drawn
//! towards 1, so what is claimed is the less.

use super::slope::mean_95;
use super::study::{Role, Row, Study, short};
use crate::runner::axis::{AXES, Axis};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// The error with one value of an axis over that with the base.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Effect {
    pub axis: String,
    pub base: String,
    pub value: String,
    /// "sampled 16": the method whose parameter it is; for the axis `method` the sample count alone.
    pub method: String,
    /// One alpha, or `None` for all.
    pub alpha: Option<String>,
    /// Geometric mean of the ratios; below 1 the value is better than the base.
    pub ratio: f64,
    /// 95 % interval of it; infinite for a single case.
    pub interval: [f64; 2],
    /// Cases, each with the mean of its pairs.
    pub n: usize,
    /// How many of the cases are better than the base.
    pub better: usize,
    /// Cases left out because in all of their pairs both errors are within the reference's noise.
    pub in_noise: usize,
    /// Each case, where there are no more than [`PAIRS_SHOWN_MAX`]: its mean says little then.
    pub pairs: Vec<Pair>,
}

/// A case that has both values: its pairs of cells together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pair {
    /// What tells it from the other cases, in the words of its axes; empty for a single one.
    pub label: String,
    /// Error over that with the base; the geometric mean over its pairs.
    pub ratio: f64,
}

/// More cases than this are told by their mean and its interval.
pub const PAIRS_SHOWN_MAX: usize = 12;

impl Effect {
    /// Whether the interval tells which of the two errs less.
    pub fn is_decided(&self) -> bool {
        let [lo, hi] = self.interval;
        hi.is_finite() && (lo > 1.0 || hi < 1.0)
    }
}

/// Axes that are no parameters: counts of samples have slopes and break-even, point sets are luck.
const NOT_PARAMETERS: [&str; 3] = ["samples", "point_set", super::study::RUN_AXIS];

/// Effects of all swept parameters, over all alphas first and then by alpha.
pub fn effects(study: &Study) -> Vec<Effect> {
    let swept = study
        .axes
        .iter()
        .enumerate()
        .filter(|(_, axis)| axis.role == Role::Variant && !NOT_PARAMETERS.contains(&axis.name.as_str()));
    let base = |axis: usize| study.axes[axis].values.iter().find(|value| !value.is_empty() && *value != "none");
    swept
        .flat_map(|(index, _)| base(index).map_or_else(Vec::new, |base| against(study, index, base, &|_| true)))
        .collect()
}

/// Effects of the other values of an axis against this one among some of the rows, over all alphas first and then by alpha.
pub fn against(study: &Study, axis: usize, base: &str, is_among: &dyn Fn(&Row) -> bool) -> Vec<Effect> {
    let name = study.axes[axis].name.as_str();
    let display = study.display_axes();
    let images = study.images().into_iter();
    let rows: Vec<&Row> = images.filter(|row| row.error.is_some() && is_among(row)).collect();
    let usual: BTreeMap<&str, String> =
        AXES.iter().map(|axis: &Axis| (axis.name, (axis.default)().to_string())).collect();
    let agrees = |a: &Row, b: &Row| {
        study.axes.iter().enumerate().all(|(index, known)| {
            let (x, y) = (&a.axes[index], &b.axes[index]);
            let default = usual.get(known.name.as_str());
            index == axis
                || display.contains(&index)
                || x == y
                // A method that draws no samples has no partner among those that do.
                || (known.name != "samples"
                    && ((x.is_empty() && Some(y) == default) || (y.is_empty() && Some(x) == default)))
        })
    };
    let bases: Vec<&Row> = rows.iter().copied().filter(|row| row.axes[axis] == base).collect();
    // Pairs by value, method and alpha, in the order of the rows.
    let mut order: Vec<[String; 3]> = Vec::new();
    let mut logs: BTreeMap<[String; 3], BTreeMap<Vec<&str>, Vec<f64>>> = BTreeMap::new();
    let mut in_noise: BTreeMap<[String; 3], BTreeSet<Vec<&str>>> = BTreeMap::new();
    let of_case: Vec<usize> = (0..study.axes.len()).filter(|&index| study.axes[index].role == Role::Scene).collect();
    for row in rows.iter().filter(|row| !["", "none", base].contains(&row.axes[axis].as_str())) {
        let Some(partner) = bases.iter().find(|other| agrees(row, other)) else { continue };
        let (Some(error), Some(of_base)) = (row.error, partner.error) else { continue };
        let method = match (name, study.value(row, "method")) {
            ("method", _) => study.value(row, "samples").to_owned(),
            // The value itself says how the image is made.
            ("diffuse", "none") => String::new(),
            _ => study.method_label(row),
        };
        let alpha = study.value(row, "alpha");
        let keys = [String::new(), alpha.to_owned()].map(|alpha| [row.axes[axis].clone(), method.clone(), alpha]);
        for key in &keys[..if alpha.is_empty() { 1 } else { 2 }] {
            if !order.contains(key) {
                order.push(key.clone());
            }
            let case: Vec<&str> = of_case.iter().map(|&index| row.axes[index].as_str()).collect();
            if !row.is_resolved() && !partner.is_resolved() {
                in_noise.entry(key.clone()).or_default().insert(case);
                continue;
            }
            logs.entry(key.clone()).or_default().entry(case).or_default().push((error / of_base).ln());
        }
    }
    let is_swept_alpha = study.axis("alpha").is_some_and(|alpha| study.axes[alpha].values.len() > 1);
    order.sort_by_key(|[_, _, alpha]| !alpha.is_empty());
    let effect = |key: &[String; 3]| {
        let [value, method, alpha] = key.clone();
        let told = logs.get(key)?;
        let own: Vec<f64> = told.values().map(|logs| logs.iter().sum::<f64>() / logs.len() as f64).collect();
        // The values that tell the pairs apart.
        let telling: Vec<usize> = (0..of_case.len())
            .filter(|&i| told.keys().any(|case| case[i] != told.keys().next().map_or("", |first| first[i])))
            .collect();
        let label = |case: &Vec<&str>| {
            let words = telling.iter().map(|&i| short(&study.axes[of_case[i]].name, case[i]));
            words.filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" · ")
        };
        let pairs = told.keys().zip(&own).map(|(case, log)| Pair { label: label(case), ratio: log.exp() });
        let (mean, half) = mean_95(&own)?;
        Some(Effect {
            axis: name.to_owned(),
            base: base.to_owned(),
            value,
            method,
            alpha: Some(alpha).filter(|alpha| !alpha.is_empty()),
            ratio: mean.exp(),
            interval: [(mean - half).exp(), (mean + half).exp()],
            n: own.len(),
            better: own.iter().filter(|log| **log < 0.0).count(),
            // A case of which another pair tells something is counted there.
            in_noise: in_noise
                .get(key)
                .map_or(0, |cases| cases.iter().filter(|case| !told.contains_key(*case)).count()),
            pairs: if own.len() > PAIRS_SHOWN_MAX { Vec::new() } else { pairs.collect() },
        })
    };
    order.iter().filter(|[_, _, alpha]| is_swept_alpha || alpha.is_empty()).filter_map(effect).collect()
}
