//! What the rows say: break-even of every case, convergence slopes, break-even by `n_dot_v`.
//!
//! A *case* is one setting of everything but method, sample count and tone curve. In a case the error of a sampling method
//! falls along its sample counts; the error of a method without samples is one number. Break-even is where they cross.

use super::run_folder::RunFolder;
use super::study::{HEADLINE, Row, Study};
use crate::experiment::break_even::{BreakEven, break_even, median};
use serde::Serialize;
use std::collections::BTreeMap;

/// One measured point of an error curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CurvePoint {
    pub samples: u32,
    pub error: f64,
    pub run: usize,
    pub cell: String,
    /// Whether the reference's own noise is far below the error.
    pub is_resolved: bool,
}

/// Slope of ln(error) over ln(samples) with its 95 % interval (Student's t); plain Monte Carlo has -1 in squared error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Slope {
    pub value: f64,
    pub lo: f64,
    pub hi: f64,
    /// ln(error) at one sample.
    pub intercept: f64,
    pub n: usize,
}

/// The curve of one sampling method in one case.
#[derive(Clone, Debug, Serialize)]
pub struct Curve {
    /// Values on the case axes.
    pub key: Vec<String>,
    pub method: String,
    pub points: Vec<CurvePoint>,
    pub slope: Option<Slope>,
    /// Headline error that an exact image would have against this reference.
    pub noise_floor: Option<f64>,
}

/// A case in which a sampling method meets one without samples.
#[derive(Clone, Debug, Serialize)]
pub struct Case {
    pub key: Vec<String>,
    pub fixed_error: f64,
    pub fixed_run: usize,
    pub fixed_cell: String,
    /// Index into the curves.
    pub curve: usize,
    #[serde(serialize_with = "as_json")]
    pub break_even: BreakEven,
    /// Where the curves cross by log-log interpolation; `None` when they do not between two tried counts.
    pub crossing: Option<f64>,
    /// Break-even within each bin of `n_dot_v`.
    pub bins: Vec<BinBreakEven>,
}

/// Break-even over the pixels of one bin.
#[derive(Clone, Debug, Serialize)]
pub struct BinBreakEven {
    pub lo: f64,
    pub hi: f64,
    pub fixed_error: f64,
    #[serde(serialize_with = "as_json")]
    pub break_even: BreakEven,
}

/// All cases of one pair of methods.
#[derive(Clone, Debug, Serialize)]
pub struct Pair {
    pub sampled: String,
    pub fixed: String,
    pub cases: Vec<Case>,
    pub sample_counts: Vec<u32>,
}

/// Everything that is computed from the rows.
#[derive(Debug, Serialize)]
pub struct Analysis {
    /// Names of the case axes, in key order.
    pub case_axes: Vec<String>,
    pub curves: Vec<Curve>,
    pub pairs: Vec<Pair>,
}

/// `{n, above}`: JSON for the page.
fn as_json<S: serde::Serializer>(value: &BreakEven, serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Shape {
        n: u32,
        above: bool,
    }
    match *value {
        BreakEven::From(n) => Shape { n, above: false },
        BreakEven::Above(n) => Shape { n, above: true },
    }
    .serialize(serializer)
}

impl Pair {
    /// Lower quartile, median and upper quartile of the cases, each a tried count.
    pub fn quartiles(&self) -> Option<[BreakEven; 3]> {
        let mut sorted: Vec<BreakEven> = self.cases.iter().map(|case| case.break_even).collect();
        sorted.sort();
        let last = sorted.len().checked_sub(1)?;
        // Nearest rank, so that each is one of the tried counts.
        let at = |p: f64| sorted[(p * last as f64).round() as usize];
        Some([at(0.25), median(&sorted)?, at(0.75)])
    }

    /// The extreme cases.
    pub fn extremes(&self) -> Option<[BreakEven; 2]> {
        let all = || self.cases.iter().map(|case| case.break_even);
        Some([all().min()?, all().max()?])
    }
}

/// Analyses joined runs.
pub fn analyse(study: &Study, runs: &[RunFolder]) -> Analysis {
    let axes = study.case_axes();
    let key = |row: &Row| -> Vec<String> { axes.iter().map(|&axis| row.axes[axis].clone()).collect() };
    let bins = bins_by_cell(runs);
    let mut curves: Vec<Curve> = Vec::new();
    let mut fixed: Vec<(String, Vec<String>, &Row, f64)> = Vec::new();
    for row in &study.rows {
        let Some(error) = row.error else { continue };
        let (method, key) = (study.value(row, "method").to_owned(), key(row));
        let Ok(samples) = study.value(row, "samples").parse::<u32>() else {
            // Cells that differ in the tone curve only share their linear errors.
            if method != "none" && !fixed.iter().any(|(m, k, _, _)| *m == method && *k == key) {
                fixed.push((method, key, row, error));
            }
            continue;
        };
        let point = CurvePoint {
            samples,
            error,
            run: row.run,
            cell: row.cell.clone(),
            is_resolved: ["resolved", "no-noise-floor"].contains(&row.verdict.as_str()),
        };
        match curves.iter_mut().find(|curve| curve.method == method && curve.key == key) {
            Some(curve) if curve.points.iter().any(|p| p.samples == samples) => {}
            Some(curve) => curve.points.push(point),
            None => {
                curves.push(Curve { key, method, points: vec![point], slope: None, noise_floor: row.noise_floor });
            }
        }
    }
    for curve in &mut curves {
        curve.points.sort_by_key(|point| point.samples);
        let usable = curve.points.iter().filter(|p| p.is_resolved).map(|p| (f64::from(p.samples), p.error));
        curve.slope = slope(&usable.collect::<Vec<_>>());
    }
    let mut pairs: Vec<Pair> = Vec::new();
    for (fixed_method, fixed_key, row, fixed_error) in &fixed {
        for (index, curve) in curves.iter().enumerate().filter(|(_, curve)| curve.points.len() > 1) {
            // An axis that one of the two methods does not use is unset there and fits any value.
            let fits = |(a, b): (&String, &String)| a == b || a.is_empty() || b.is_empty();
            if !curve.key.iter().zip(fixed_key).all(fits) {
                continue;
            }
            let case = case(curve, index, row, *fixed_error, fixed_key, &bins);
            match pairs.iter_mut().find(|pair| pair.sampled == curve.method && pair.fixed == *fixed_method) {
                Some(pair) => pair.cases.push(case),
                None => pairs.push(Pair {
                    sampled: curve.method.clone(),
                    fixed: fixed_method.clone(),
                    cases: vec![case],
                    sample_counts: Vec::new(),
                }),
            }
        }
    }
    for pair in &mut pairs {
        let mut counts: Vec<u32> =
            pair.cases.iter().flat_map(|case| &curves[case.curve].points).map(|point| point.samples).collect();
        counts.sort_unstable();
        counts.dedup();
        pair.sample_counts = counts;
    }
    Analysis { case_axes: axes.iter().map(|&axis| study.axes[axis].name.clone()).collect(), curves, pairs }
}

/// Headline error of the bins of a cell: (lo, hi, error).
type Bins = BTreeMap<(usize, String), Vec<(f64, f64, f64)>>;

fn bins_by_cell(runs: &[RunFolder]) -> Bins {
    let mut by_cell = Bins::new();
    for (run, folder) in runs.iter().enumerate() {
        let Some(table) = &folder.bins else { continue };
        let columns = ["cell", "n_dot_v_from", "n_dot_v_to", HEADLINE].map(|name| table.column(name).ok());
        let [Some(cell), Some(lo), Some(hi), Some(error)] = columns else { continue };
        for row in &table.rows {
            if let [Ok(lo), Ok(hi), Ok(error)] = [lo, hi, error].map(|column| row[column].parse::<f64>()) {
                by_cell.entry((run, row[cell].clone())).or_default().push((lo, hi, error));
            }
        }
    }
    by_cell
}

fn case(curve: &Curve, index: usize, row: &Row, fixed_error: f64, fixed_key: &[String], bins: &Bins) -> Case {
    let points: Vec<(u32, f64)> = curve.points.iter().map(|p| (p.samples, p.error)).collect();
    let key = curve.key.iter().zip(fixed_key).map(|(a, b)| if a.is_empty() { b } else { a }.clone()).collect();
    let result = break_even(&points, fixed_error);
    let in_bin = |lo: f64, run: usize, cell: &str| {
        let own = bins.get(&(run, cell.to_owned()))?;
        own.iter().find(|bin| bin.0 == lo).map(|bin| bin.2)
    };
    let own_bins = bins.get(&(row.run, row.cell.clone())).map_or(&[][..], Vec::as_slice);
    let bins = own_bins
        .iter()
        .map(|&(lo, hi, fixed_error)| {
            let curve: Vec<(u32, f64)> =
                curve.points.iter().filter_map(|p| Some((p.samples, in_bin(lo, p.run, &p.cell)?))).collect();
            BinBreakEven { lo, hi, fixed_error, break_even: break_even(&curve, fixed_error) }
        })
        .collect();
    Case {
        key,
        fixed_error,
        fixed_run: row.run,
        fixed_cell: row.cell.clone(),
        curve: index,
        break_even: result,
        crossing: crossing(&points, fixed_error, result),
        bins,
    }
}

/// Where the segment that ends at the break-even count meets the fixed error, by log-log interpolation. `points` ascend.
pub fn crossing(points: &[(u32, f64)], fixed: f64, result: BreakEven) -> Option<f64> {
    let BreakEven::From(count) = result else { return None };
    let index = points.iter().position(|(samples, _)| *samples == count)?;
    let ((n0, e0), (n1, e1)) = (*points.get(index.checked_sub(1)?)?, points[index]);
    let [x0, x1] = [n0, n1].map(|n| f64::from(n).ln());
    let t = (e0 / fixed).ln() / (e0 / e1).ln();
    t.is_finite().then(|| (x0 + t * (x1 - x0)).exp())
}

/// Two-sided 95 % quantiles of Student's t for 1 to 10 degrees of freedom; beyond, [`T_NORMAL`] with its first correction.
const T_95: [f64; 10] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228];
const T_NORMAL: f64 = 1.960;

fn t_95(degrees: usize) -> f64 {
    // Cornish-Fisher: t = z + (z^3 + z) / 4 dof, good to 0.5 % above 10.
    let correction = (T_NORMAL.powi(3) + T_NORMAL) / (4.0 * degrees.max(1) as f64);
    T_95.get(degrees.wrapping_sub(1)).copied().unwrap_or(T_NORMAL + correction)
}

/// Least-squares slope of ln y over ln x; `None` for fewer than three points, or ones that are not positive.
pub fn slope(points: &[(f64, f64)]) -> Option<Slope> {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    if logs.len() < 3 || logs.iter().any(|(x, y)| !x.is_finite() || !y.is_finite()) {
        return None;
    }
    let n = logs.len() as f64;
    let (mean_x, mean_y) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let sxx: f64 = logs.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
    let sxy: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    if sxx == 0.0 {
        return None;
    }
    let value = sxy / sxx;
    let intercept = mean_y - value * mean_x;
    let residual: f64 = logs.iter().map(|p| (p.1 - intercept - value * p.0).powi(2)).sum();
    let half = t_95(logs.len() - 2) * (residual / (n - 2.0) / sxx).sqrt();
    Some(Slope { value, lo: value - half, hi: value + half, intercept, n: logs.len() })
}
