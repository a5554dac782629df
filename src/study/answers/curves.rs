//! Error curves over sample counts, one for each sampling method and case.
//!
//! A *case* is one setting of everything but method, sample count, point set and tone curve. In a case the error of a sampling method
//! falls along its sample counts; the error of a method without samples is one number.

use super::slope::{Slope, slope};
use super::study::{Bin, Row, Study};
use serde::Serialize;

/// One measured point of an error curve.
#[derive(Clone, Debug, Serialize)]
pub struct CurvePoint {
    pub samples: u32,
    /// Geometric mean over the point sets.
    pub error: f64,
    /// Run and cell of the first point set.
    pub run: usize,
    pub cell: String,
    /// Whether the reference's own noise is far below the error of every point set.
    pub is_resolved: bool,
    /// The error of each point set, in the order of the rows.
    #[serde(skip)]
    pub errors: Vec<f64>,
    /// Errors by `n_dot_v` of each point set.
    #[serde(skip)]
    pub bins: Vec<Vec<Bin>>,
}

impl CurvePoint {
    /// The errors of all point sets in the bin that begins at `lo`, with its pixel count.
    pub fn bin(&self, lo: f64) -> (Vec<f64>, f64) {
        let found: Vec<&Bin> = self.bins.iter().filter_map(|of_set| of_set.iter().find(|bin| bin.lo == lo)).collect();
        (found.iter().map(|bin| bin.error).collect(), found.first().map_or(0.0, |bin| bin.pixel_count))
    }
}

/// The curve of one sampling method in one case.
#[derive(Clone, Debug, Serialize)]
pub struct Curve {
    /// Values on the case axes.
    pub key: Vec<String>,
    pub method: String,
    /// By sample count, ascending.
    pub points: Vec<CurvePoint>,
    /// Fitted to the points above the reference's noise only.
    pub slope: Option<Slope>,
    /// Headline error that an exact image would have against this reference.
    pub noise_floor: Option<f64>,
}

/// A method without samples in one case.
#[derive(Clone, Debug)]
pub struct Fixed<'r> {
    pub key: Vec<String>,
    pub method: &'r str,
    pub row: &'r Row,
    pub error: f64,
}

/// exp of the mean of the logarithms; NaN for none. One value is given back bit for bit.
pub fn geometric_mean(values: &[f64]) -> f64 {
    if let [one] = values {
        return *one;
    }
    (values.iter().map(|value| value.ln()).sum::<f64>() / values.len() as f64).exp()
}

/// Values of a row on some axes.
pub fn key(row: &Row, axes: &[usize]) -> Vec<String> {
    axes.iter().map(|&axis| row.axes[axis].clone()).collect()
}

/// Whether two keys agree; an axis that one of the two does not use is unset there and fits any value.
pub fn fits(a: &[String], b: &[String]) -> bool {
    a.iter().zip(b).all(|(a, b)| a == b || a.is_empty() || b.is_empty())
}

/// All curves and all methods without samples, in the order of the rows. Cells that differ in the tone curve only share their errors
/// and count once.
pub fn curves(study: &Study) -> (Vec<Curve>, Vec<Fixed<'_>>) {
    let axes = study.case_axes();
    let mut curves: Vec<Curve> = Vec::new();
    let mut fixed: Vec<Fixed> = Vec::new();
    for row in study.images() {
        let Some(error) = row.error else { continue };
        let (method, key) = (study.value(row, "method"), key(row, &axes));
        let Ok(samples) = study.value(row, "samples").parse::<u32>() else {
            if method != "none" {
                fixed.push(Fixed { key, method, row, error });
            }
            continue;
        };
        let known = curves.iter().position(|curve| curve.method == method && curve.key == key);
        let index = known.unwrap_or_else(|| {
            let noise_floor = row.noise_floor;
            curves.push(Curve { key, method: method.to_owned(), points: Vec::new(), slope: None, noise_floor });
            curves.len() - 1
        });
        let points = &mut curves[index].points;
        let place = points.iter().position(|point| point.samples == samples).unwrap_or_else(|| {
            points.push(CurvePoint {
                samples,
                error: f64::NAN,
                run: row.run,
                cell: row.cell.clone(),
                is_resolved: true,
                errors: Vec::new(),
                bins: Vec::new(),
            });
            points.len() - 1
        });
        let point = &mut points[place];
        point.errors.push(error);
        point.bins.push(row.bins.clone());
        point.is_resolved &= row.is_resolved();
    }
    for curve in &mut curves {
        curve.points.sort_by_key(|point| point.samples);
        curve.points.iter_mut().for_each(|point| point.error = geometric_mean(&point.errors));
        let usable = curve.points.iter().filter(|p| p.is_resolved).map(|p| (f64::from(p.samples), p.error));
        curve.slope = slope(&usable.collect::<Vec<_>>());
    }
    (curves, fixed)
}
