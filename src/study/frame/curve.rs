//! Error over sample or frame count ([`Frame::along`]): one curve per sampling method and case. A
//! *case* is one setting of everything but method, that count, point set and tone curve.

use super::estimate::geometric_mean;
use super::{Frame, Key, Row, by, distinct_in_order, fits};
use crate::experiment::axis::AxisId;
use crate::experiment::axis::METHOD;
use crate::experiment::value::Value;

/// A sampling method in one case.
#[derive(Clone, Debug)]
pub struct Curve<'r, 'f> {
    pub method: Value,
    /// Values on the axes of cases.
    pub key: Key,
    /// Ascending by count; at least one.
    pub points: Vec<CurvePoint<'r, 'f>>,
}

/// The point sets of one count.
#[derive(Clone, Debug)]
pub struct CurvePoint<'r, 'f> {
    pub count: u32,
    /// Geometric mean over the point sets.
    pub error: f64,
    /// Whether the errors of all point sets are resolved.
    pub is_resolved: bool,
    /// One per point set; at least one.
    pub rows: Vec<&'r Row<'f>>,
}

impl<'r, 'f> Curve<'r, 'f> {
    pub fn first(&self) -> &'r Row<'f> {
        self.points[0].rows[0]
    }

    pub fn tried(&self) -> [u32; 2] {
        [&self.points[0], &self.points[self.points.len() - 1]].map(|point| point.count)
    }
}

/// The curves of these images, without the reference method, which may be rendered for its times.
pub fn curves<'r, 'f>(
    frame: &Frame,
    images: &[&'r Row<'f>],
    axes: &[AxisId],
) -> Vec<Curve<'r, 'f>> {
    let is_tested = |row: &Row| row.text(METHOD) != frame.shape.reference_method;
    let sampled = images
        .iter()
        .copied()
        .filter(|row| row.count(frame.along).is_some() && is_tested(row));
    let sampled: Vec<&Row> = sampled.collect();
    let with_method: Vec<AxisId> = axes.iter().copied().chain([METHOD]).collect();
    let groups = by(&sampled, &with_method).into_iter();
    let curve = |(mut key, own): (Key, Vec<&'r Row<'f>>)| {
        let method = key.pop()?;
        let points = points(frame, &own);
        (!points.is_empty()).then_some(Curve {
            method,
            key,
            points,
        })
    };
    groups.filter_map(curve).collect()
}

pub fn without_samples<'r, 'f>(images: &[&'r Row<'f>]) -> Vec<&'r Row<'f>> {
    images
        .iter()
        .copied()
        .filter(|row| row.samples().is_none() && !row.has_no_method())
        .collect()
}

fn points<'r, 'f>(frame: &Frame, rows: &[&'r Row<'f>]) -> Vec<CurvePoint<'r, 'f>> {
    let mut counts: Vec<u32> =
        distinct_in_order(rows.iter().filter_map(|row| row.count(frame.along)));
    counts.sort_unstable();
    let point = |count: u32| {
        let is_own =
            |row: &&Row| row.count(frame.along) == Some(count) && frame.error(row).is_some();
        let rows: Vec<&'r Row<'f>> = rows.iter().copied().filter(is_own).collect();
        let errors: Vec<f64> = rows.iter().filter_map(|row| frame.error(row)).collect();
        let is_resolved = rows.iter().all(|row| frame.is_resolved(row));
        (!rows.is_empty()).then(|| CurvePoint {
            count,
            error: geometric_mean(&errors),
            is_resolved,
            rows,
        })
    };
    counts.into_iter().filter_map(point).collect()
}

/// A sampling method and one without samples in one case.
#[derive(Clone, Debug)]
pub struct Beside<'r, 'f> {
    /// Values on the axes of cases, from the method that uses them.
    pub key: Key,
    pub curve: Curve<'r, 'f>,
    pub fixed: &'r Row<'f>,
    /// Error of the method without samples.
    pub error: f64,
}

impl Beside<'_, '_> {
    /// The sampling method and the other.
    pub fn names(&self) -> [String; 2] {
        [self.curve.method.to_string(), self.fixed.text(METHOD)]
    }
}

fn united(a: &[Value], b: &[Value]) -> Key {
    a.iter()
        .zip(b)
        .map(|(a, b)| if *a == Value::Unset { b } else { a }.clone())
        .collect()
}

/// Pairs each curve with the images of methods without samples in the same case, in the order of
/// the rows.
pub fn beside<'r, 'f>(
    frame: &Frame,
    images: &[&'r Row<'f>],
    axes: &[AxisId],
) -> Vec<Beside<'r, 'f>> {
    let fixed = without_samples(images);
    let mut found = Vec::new();
    for curve in curves(frame, images, axes) {
        for &row in &fixed {
            let other = row.key(axes);
            let Some(error) = frame.error(row).filter(|_| fits(&other, &curve.key)) else {
                continue;
            };
            found.push(Beside {
                key: united(&curve.key, &other),
                curve: curve.clone(),
                fixed: row,
                error,
            });
        }
    }
    found
}
