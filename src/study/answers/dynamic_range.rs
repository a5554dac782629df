//! Error against the dynamic range of the environment: what its peaks do to each method.
//!
//! The range is log2 of peak over mean luminance, in stops (`environments.csv`). Where `environment_clip_log2` is swept each environment is
//! a series of its own, the same light with lower and lower peaks; else all environments are one series.

use super::slope::{Slope, line};
use super::study::{Row, Study};
use crate::runner::statistics::spread;
use serde::Serialize;

/// The error of one method in light of one dynamic range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RangePoint {
    /// What is followed: the environment whose peaks are cut off, or "all environments".
    pub series: String,
    pub environment: String,
    /// As written; empty for the whole environment.
    pub clip_log2: String,
    /// Stops.
    pub range: f64,
    /// "sampled 16".
    pub method: String,
    /// Over everything else that is swept.
    pub n: usize,
    pub lower_quartile: f64,
    pub median: f64,
    pub upper_quartile: f64,
}

/// How the error of a method grows along a series.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    pub series: String,
    pub method: String,
    /// Whether it is one environment with lower and lower peaks.
    pub is_one_light: bool,
    /// Stops and median error, ascending; three or more.
    pub points: Vec<(f64, f64)>,
    /// ln(error) over stops, of the medians.
    pub fit: Slope,
}

const ALL: &str = "all environments";

/// Every method at every range, ascending by range; empty where fewer than two ranges are known.
pub fn dynamic_range(study: &Study) -> Vec<RangePoint> {
    let is_swept = |name: &str| study.axis(name).is_some_and(|axis| study.axes[axis].values.len() > 1);
    let is_clipped = is_swept("environment_clip_log2");
    if !is_clipped && !is_swept("environment") {
        return Vec::new();
    }
    let mut groups: Vec<(RangePoint, Vec<f64>)> = Vec::new();
    let rows = study.images().into_iter().filter_map(|row| Some((row, row.error?, row.range_stops?)));
    for (row, error, range) in rows {
        let point = point(study, row, range, is_clipped);
        match groups.iter_mut().find(|(known, _)| *known == point) {
            Some((_, errors)) => errors.push(error),
            None => groups.push((point, vec![error])),
        }
    }
    let mut found: Vec<RangePoint> = groups
        .into_iter()
        .filter_map(|(point, errors)| {
            let spread = spread(&errors)?;
            Some(RangePoint {
                n: spread.n,
                lower_quartile: spread.lower_quartile,
                median: spread.median,
                upper_quartile: spread.upper_quartile,
                ..point
            })
        })
        .collect();
    // Stable: methods and series stay in the order of the rows.
    found.sort_by(|a, b| a.range.total_cmp(&b.range));
    let ranges = found.iter().map(|point| point.range);
    if ranges.clone().fold(f64::INFINITY, f64::min) < ranges.fold(f64::NEG_INFINITY, f64::max) { found } else { vec![] }
}

fn point(study: &Study, row: &Row, range: f64, is_clipped: bool) -> RangePoint {
    let environment = study.value(row, "environment").to_owned();
    RangePoint {
        series: if is_clipped { super::study::short("environment", &environment).into_owned() } else { ALL.to_owned() },
        environment,
        clip_log2: study.value(row, "environment_clip_log2").to_owned(),
        range,
        method: study.method_label(row),
        n: 0,
        lower_quartile: 0.0,
        median: 0.0,
        upper_quartile: 0.0,
    }
}

/// Series and methods with their growth, where at least three ranges differ.
pub fn growth(points: &[RangePoint]) -> Vec<Growth> {
    let mut seen: Vec<(&str, &str)> = Vec::new();
    let mut found = Vec::new();
    for name in points.iter().map(|point| (point.series.as_str(), point.method.as_str())) {
        if seen.contains(&name) {
            continue;
        }
        seen.push(name);
        let own = points.iter().filter(|point| (point.series.as_str(), point.method.as_str()) == name);
        let mut points: Vec<(f64, f64)> = own.map(|point| (point.range, point.median)).collect();
        // A clip above the peak changes nothing and is the same light again.
        points.dedup();
        let logs: Vec<(f64, f64)> = points.iter().map(|(range, error)| (*range, error.ln())).collect();
        if let Some(fit) = line(&logs) {
            let (series, method) = (name.0.to_owned(), name.1.to_owned());
            found.push(Growth { is_one_light: series != ALL, series, method, points, fit });
        }
    }
    found
}
