//! Error over sample or frame count ([`Frame::curve_axis`]): one curve per sampling method and
//! case. A *case* is one setting of everything but method, that count, point set and tone curve.

use super::estimate::geometric_mean;
use super::{Frame, Key, Row, agree, distinct_in_order, group_by_axes};
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

    /// The least and the largest count.
    pub fn count_ends(&self) -> [u32; 2] {
        [&self.points[0], &self.points[self.points.len() - 1]].map(|point| point.count)
    }
}

/// The curves of these images, without the reference method, which may be rendered for its times.
pub fn curves<'r, 'f>(
    frame: &Frame,
    images: &[&'r Row<'f>],
    axes: &[AxisId],
) -> Vec<Curve<'r, 'f>> {
    let mut sampled = images.to_vec();
    sampled.retain(|row| {
        row.count(frame.curve_axis).is_some() && row.text(METHOD) != frame.shape.reference_method
    });
    let with_method: Vec<AxisId> = axes.iter().copied().chain([METHOD]).collect();
    let mut curves = Vec::new();
    for (mut key, rows) in group_by_axes(&sampled, &with_method) {
        let method = key.pop().expect("a key has a value for each axis");
        let points = points(frame, &rows);
        if !points.is_empty() {
            curves.push(Curve {
                method,
                key,
                points,
            });
        }
    }
    curves
}

/// The images of methods without samples, but for images without a method.
pub fn without_samples<'r, 'f>(images: &[&'r Row<'f>]) -> Vec<&'r Row<'f>> {
    images
        .iter()
        .copied()
        .filter(|row| row.samples().is_none() && !row.has_no_method())
        .collect()
}

fn points<'r, 'f>(frame: &Frame, rows: &[&'r Row<'f>]) -> Vec<CurvePoint<'r, 'f>> {
    let mut counts: Vec<u32> =
        distinct_in_order(rows.iter().filter_map(|row| row.count(frame.curve_axis)));
    counts.sort_unstable();
    counts
        .into_iter()
        .filter_map(|count| point(frame, rows, count))
        .collect()
}

fn point<'r, 'f>(frame: &Frame, rows: &[&'r Row<'f>], count: u32) -> Option<CurvePoint<'r, 'f>> {
    let mut rows = rows.to_vec();
    rows.retain(|row| row.count(frame.curve_axis) == Some(count) && frame.error(row).is_some());
    if rows.is_empty() {
        return None;
    }
    let errors: Vec<f64> = rows.iter().filter_map(|row| frame.error(row)).collect();
    Some(CurvePoint {
        count,
        error: geometric_mean(&errors),
        is_resolved: rows.iter().all(|row| frame.is_resolved(row)),
        rows,
    })
}

/// A sampling method and one without samples in one case.
#[derive(Clone, Debug)]
pub struct Rivals<'r, 'f> {
    /// Values on the axes of cases, from the method that uses them.
    pub key: Key,
    pub curve: Curve<'r, 'f>,
    pub fixed: &'r Row<'f>,
    /// Error of the method without samples.
    pub error: f64,
}

impl Rivals<'_, '_> {
    pub fn methods(&self) -> Methods {
        Methods {
            sampled: self.curve.method.to_string(),
            fixed: self.fixed.text(METHOD),
        }
    }
}

/// The code names of a sampling method and of one without samples.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Methods {
    pub sampled: String,
    pub fixed: String,
}

/// The values of `a`, and of `b` where `a` has none.
fn united(a: &[Value], b: &[Value]) -> Key {
    a.iter()
        .zip(b)
        .map(|(a, b)| if *a == Value::Unset { b } else { a }.clone())
        .collect()
}

/// Pairs each curve with the images of methods without samples in the same case, in the order of
/// the rows.
pub fn rivals<'r, 'f>(
    frame: &Frame,
    images: &[&'r Row<'f>],
    axes: &[AxisId],
) -> Vec<Rivals<'r, 'f>> {
    let fixed = without_samples(images);
    let mut found = Vec::new();
    for curve in curves(frame, images, axes) {
        for &row in &fixed {
            let other = row.key(axes);
            let Some(error) = frame.error(row).filter(|_| agree(&other, &curve.key)) else {
                continue;
            };
            found.push(Rivals {
                key: united(&curve.key, &other),
                curve: curve.clone(),
                fixed: row,
                error,
            });
        }
    }
    found
}
