//! Error by `n_dot_v` and alpha: where on a surface, and on which surface, a method is wrong.

use super::study::{Role, Study};
use crate::runner::axis::by_name;
use crate::runner::statistics::{median, median_order};
use std::collections::{BTreeMap, BTreeSet};

/// The errors of one method at one sample count.
#[derive(Clone, Debug)]
pub struct HeatTable {
    pub method: String,
    /// As written; empty for a method that draws none.
    pub samples: String,
    /// Rows, ascending.
    pub alphas: Vec<f64>,
    /// Columns: bins of `n_dot_v`, grazing angles first.
    pub bins: Vec<(f64, f64)>,
    /// By row and column; `None` where no pixel fell into the bin.
    pub errors: Vec<Vec<Option<HeatError>>>,
}

/// The error of one place of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatError {
    /// Median headline error over everything else that is swept.
    pub median: f64,
    /// Interval that holds the median over cases with at least 95 %, from order statistics ([`median_order`]), so that it needs no
    /// distribution. A case is one reference: what its rows differ in otherwise is drawn together first. `None` where there are too few.
    pub interval: Option<[f64; 2]>,
}

impl HeatTable {
    /// "sampled 16".
    pub fn label(&self) -> String {
        format!("{} {}", self.method, self.samples).trim_end().to_owned()
    }
}

/// A table for each method and sample count, in the order of the rows. Empty where alpha is not swept.
pub fn heat(study: &Study) -> Vec<HeatTable> {
    if study.axis("alpha").is_none_or(|axis| study.axes[axis].values.iter().filter(|v| !v.is_empty()).count() < 2) {
        return Vec::new();
    }
    let mut seen = BTreeSet::new();
    let names = study.rows.iter().map(|row| (study.value(row, "method"), study.value(row, "samples")));
    let names: Vec<_> = names.filter(|name| name.0 != "none" && seen.insert(*name)).collect();
    names.into_iter().filter_map(|(method, samples)| table(study, method, samples)).collect()
}

fn table(study: &Study, method: &str, samples: &str) -> Option<HeatTable> {
    // Copies that differ in the tone curve only share their linear errors.
    let own = study
        .images()
        .into_iter()
        .filter(|r| study.value(r, "method") == method && study.value(r, "samples") == samples);
    let own: Vec<_> = own.filter(|row| row.error.is_some() && !row.bins.is_empty()).collect();
    let alpha = |row| study.value(row, "alpha").parse::<f64>().ok();
    let mut alphas: Vec<f64> = own.iter().filter_map(|row| alpha(row)).collect();
    alphas.sort_by(f64::total_cmp);
    alphas.dedup();
    let mut bins: Vec<(f64, f64)> = own.iter().flat_map(|row| row.bins.iter().map(|bin| (bin.lo, bin.hi))).collect();
    bins.sort_by(|a, b| a.0.total_cmp(&b.0));
    bins.dedup();
    let of_case: Vec<usize> = (0..study.axes.len()).filter(|&index| study.axes[index].role == Role::Scene).collect();
    let error = |at: f64, lo: f64| {
        let mut cases: BTreeMap<Vec<&str>, Vec<f64>> = BTreeMap::new();
        for row in own.iter().filter(|row| alpha(row) == Some(at)) {
            let case = of_case.iter().map(|&index| row.axes[index].as_str()).collect();
            let errors = row.bins.iter().filter(|bin| bin.lo == lo).map(|bin| bin.error);
            cases.entry(case).or_default().extend(errors);
        }
        cases.retain(|_, errors| !errors.is_empty());
        let all: Vec<f64> = cases.values().flatten().copied().collect();
        let mut medians: Vec<f64> = cases.values().map(|errors| median(errors)).collect();
        medians.sort_by(f64::total_cmp);
        let interval = median_order(medians.len()).map(|outer| [medians[outer], medians[medians.len() - 1 - outer]]);
        (!all.is_empty()).then(|| HeatError { median: median(&all), interval })
    };
    let errors = alphas.iter().map(|&at| bins.iter().map(|&(lo, _)| error(at, lo)).collect()).collect();
    let found = HeatTable { method: method.to_owned(), samples: samples.to_owned(), alphas, bins, errors };
    (!found.alphas.is_empty()).then_some(found)
}

/// The tables that a reader is shown: of each method the one whose sample count is nearest to the default of the axis, by ratio.
pub fn shown(tables: &[HeatTable]) -> Vec<&HeatTable> {
    let usual = f64::from((by_name("samples").default)().count());
    let distance = |table: &HeatTable| table.samples.parse::<f64>().map_or(0.0, |n| (n / usual).ln().abs());
    let mut shown: Vec<&HeatTable> = Vec::new();
    for table in tables {
        match shown.iter_mut().find(|known| known.method == table.method) {
            Some(known) if distance(table) < distance(known) => *known = table,
            Some(_) => {}
            None => shown.push(table),
        }
    }
    shown
}
