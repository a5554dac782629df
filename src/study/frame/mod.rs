//! The images of one run as typed rows, and ways to group and pair them.
//!
//! Every question is answered from a frame. A row is one distinct linear image at one tone curve.

pub mod curve;
pub mod estimate;
pub mod line;
mod shape;

use crate::base::names::Listed;
pub use crate::run::rows::Key;
pub use shape::Shape;

use super::finished::{Finished, FinishedCell};
use super::names::Names;
use super::table::axis_cells;
use crate::base::csv::Cell;
use crate::draw::variant::Variant;
use crate::experiment::axis::{
    ALPHA, AXES, AxisId, BRDF, DIFFUSE_METHOD, ENVIRONMENT, F0, METHOD, Part, PerAxis, Point,
    Points, SAMPLES, SCENE,
};
use crate::experiment::value::Value;
use crate::instrument::metrics::{HEADLINE, Metric, Space, VIEWS, Verdict, verdict};
use crate::instrument::scene::is_design;
use crate::instrument::shade::NONE;
use crate::run::tables::DISPLAY_HEADLINE;
use indexmap::{IndexMap, IndexSet};

/// Mean FLIP of a visible difference: a convention of this project, since FLIP's authors give none.
pub const VISIBLE_FROM: f64 = 0.05;

#[derive(Clone, Debug)]
pub struct Row<'f> {
    pub cell: &'f FinishedCell,
    /// Other cells with the same pixels, by id.
    pub copies: Vec<&'f str>,
    /// The cell's point without axes that cannot change its pixels, and with equal lights written
    /// alike.
    pub point: Point,
}

/// The images of one run.
pub struct Frame<'f> {
    pub run: &'f Finished,
    pub shape: Shape,
    pub rows: Vec<Row<'f>>,
    pub metric: &'static Metric,
    pub names: Names,
    /// The axis of the rows of a digest, if the experiment names one.
    pub digest_axis: Option<AxisId>,
    /// The axis along which curves have their points: samples, or frames.
    pub curve_axis: AxisId,
    /// Whether no other frame of the run comes before it, under another weight of views.
    pub is_first: bool,
}

impl<'f> Frame<'f> {
    /// The frame of a run with the metric of that name, else the experiment's own.
    pub fn new(run: &'f Finished, metric_name: Option<&str>) -> Self {
        let experiment_metric = run.config.as_ref().map_or(HEADLINE, |config| config.metric);
        let metric = Metric::listed(metric_name.unwrap_or(experiment_metric));
        let rows = distinct(run);
        Self {
            shape: Shape::of_rows(run, &rows),
            run,
            rows,
            metric,
            names: Names::new(run),
            digest_axis: None,
            curve_axis: SAMPLES,
            is_first: true,
        }
    }

    /// A frame of another run or metric with the same rows of digests.
    pub fn like<'g>(&self, run: &'g Finished, metric: &str) -> Frame<'g> {
        Frame {
            digest_axis: self.digest_axis,
            curve_axis: self.curve_axis,
            is_first: self.is_first,
            ..Frame::new(run, Some(metric))
        }
    }

    /// The axis of the rows of digests and the steps of figures: alpha, unless the experiment names
    /// another one.
    pub fn row_axis(&self) -> AxisId {
        self.digest_axis.unwrap_or(ALPHA)
    }

    pub fn metric_name(&self) -> &'static str {
        self.metric.name
    }

    /// The error of a row ([`Metric::error`]): lower is better. `None` for a failed cell.
    pub fn error(&self, row: &Row) -> Option<f64> {
        Some(self.metric.error(self.score(row)?))
    }

    /// The score of a row, without noise if answers take it off ([`Finished::score`]).
    pub fn score(&self, row: &Row) -> Option<f64> {
        self.run.score(row.cell, self.metric)
    }

    /// Expected score of an exact image.
    pub fn noise_floor(&self, row: &Row) -> Option<f64> {
        row.cell.noise_floors.get(self.metric_name())
    }

    /// Whether the error is resolved against the reference's noise; always, for metrics without a
    /// noise floor.
    pub fn is_resolved(&self, row: &Row) -> bool {
        let noise_use = self.run.noise_use();
        match (row.score(self.metric_name()), self.noise_floor(row)) {
            (Some(score), Some(floor)) => {
                verdict(self.metric, score, floor, noise_use) == Verdict::Resolved
            }
            (score, _) => score.is_some(),
        }
    }

    /// Swept axes that play one of these parts, in the order of [`AXES`].
    pub fn swept(&self, parts: &[Part]) -> Vec<AxisId> {
        AXES.ids()
            .filter(|&i| parts.contains(&AXES[i].part) && self.shape.is_swept(i))
            .collect()
    }

    /// Swept axes that distinguish cases: all but method, points of a curve, point sets and the
    /// tone curve.
    pub fn case_axes(&self) -> Vec<AxisId> {
        let mut axes = self.swept(&[
            Part::Case,
            Part::Parameter,
            Part::Table,
            Part::Method,
            Part::Count,
        ]);
        axes.retain(|axis| ![METHOD, self.curve_axis].contains(axis));
        axes
    }

    /// The axes of answer tables: axes of cases, and the most important axes even with one value.
    pub fn table_axes(&self) -> Vec<AxisId> {
        let case_axes = self.case_axes();
        let always = [ENVIRONMENT, BRDF, ALPHA, F0];
        AXES.ids()
            .filter(|axis| case_axes.contains(axis) || always.contains(axis))
            .collect()
    }

    /// Scenes without meaning for the metric: beside a design, pictures in a metric of radiance,
    /// since they prefer parts of the map; the design in a metric of display images, since it is
    /// not a picture.
    fn excluded_scenes(&self) -> Vec<Value> {
        let scenes = distinct_in_order(self.rows.iter().map(|row| row.point[SCENE].clone()));
        let (designs, pictures): (Vec<Value>, Vec<Value>) = scenes
            .into_iter()
            .partition(|scene| is_design(&scene.to_string()));
        if designs.is_empty() || pictures.is_empty() {
            return Vec::new();
        }
        match self.metric.space {
            Space::Linear => pictures,
            Space::Display => designs,
        }
    }

    /// Whether the metric needs pictures but every scene is a design.
    pub fn has_no_picture(&self) -> bool {
        self.metric.space == Space::Display
            && self
                .rows
                .iter()
                .all(|row| is_design(&row.point[SCENE].to_string()))
    }

    /// Rows with scores, each linear image once: with the default tone curve, else the first.
    pub fn images(&self) -> Vec<&Row<'f>> {
        let excluded = self.excluded_scenes();
        let mut rows: Vec<&Row<'f>> = self.rows.iter().collect();
        rows.retain(|row| row.cell.scores.is_some() && !excluded.contains(&row.point[SCENE]));
        let axes = varying(
            &rows,
            AXES.ids().filter(|axis| AXES[*axis].changes_radiance()),
        );
        let mut images: IndexMap<Key, &Row<'f>> = IndexMap::new();
        for row in rows {
            let known = images.entry(row.key(&axes)).or_insert(row);
            if row.has_plain_curve() {
                *known = row;
            }
        }
        images.into_values().collect()
    }

    /// The run under each band of n·v alone, if all images are of designs: with a camera n·v is
    /// tied to a place on the map.
    pub fn runs_by_n_dot_v(&self, images: &[&Row]) -> Vec<([f64; 2], Finished)> {
        if !images.iter().all(|row| is_design(&row.text(SCENE))) {
            return Vec::new();
        }
        let bands = VIEWS.iter();
        bands
            .filter_map(|band| Some((*band, self.run.within_n_dot_v(*band)?)))
            .collect()
    }

    /// A remark on times of a CPU driver; else empty.
    pub fn cpu_words(&self) -> &'static str {
        if self.run.is_cpu_timed() {
            " on this CPU driver"
        } else {
            ""
        }
    }

    /// The axes of [`Frame::variant`]: method and sample count; without any specular term, the
    /// diffuse method.
    pub fn variant_axes(&self) -> Vec<AxisId> {
        if self.shape.methods().next().is_some() {
            vec![METHOD, SAMPLES]
        } else {
            vec![DIFFUSE_METHOD]
        }
    }

    /// Whether a row has none of the compared terms.
    pub fn is_nothing(&self, row: &Row) -> bool {
        self.variant(row).method == NONE
    }

    /// The method of a row with its sample count; without any specular term its diffuse method.
    pub fn variant(&self, row: &Row) -> Variant {
        let axes = self.variant_axes();
        Variant {
            method: row.text(axes[0]),
            samples: row.samples().filter(|_| axes.contains(&SAMPLES)),
        }
    }
}

impl Row<'_> {
    pub fn key(&self, axes: &[AxisId]) -> Key {
        axes.iter().map(|&axis| self.point[axis].clone()).collect()
    }

    pub fn cells(&self, axes: &[AxisId]) -> Vec<Cell> {
        axis_cells(axes, &self.key(axes))
    }

    pub fn text(&self, axis: AxisId) -> String {
        self.point[axis].to_string()
    }

    /// The score as measured; `None` for a failed cell.
    fn score(&self, metric: &str) -> Option<f64> {
        self.cell.scores.as_ref()?.get(metric)
    }

    /// Samples per pixel of a sampled method.
    pub fn samples(&self) -> Option<u32> {
        self.count(SAMPLES)
    }

    /// A count on an axis, if its method uses the axis.
    pub fn count(&self, axis: AxisId) -> Option<u32> {
        if let Value::Count(count) = self.point[axis] {
            Some(count)
        } else {
            None
        }
    }

    /// Whether the tone curve is the default.
    pub fn has_plain_curve(&self) -> bool {
        let values = AXES.iter().zip(self.point.values());
        values
            .filter(|(axis, _)| axis.part == Part::Display)
            .all(|(axis, value)| *value == (axis.default)())
    }

    /// Mean FLIP of the image after its tone curve.
    pub fn flip(&self) -> Option<f64> {
        self.score(DISPLAY_HEADLINE)
    }

    pub fn has_no_method(&self) -> bool {
        self.text(METHOD) == NONE
    }
}

/// Whether two keys agree; an unset value agrees with any value.
pub fn agree(a: &[Value], b: &[Value]) -> bool {
    a.iter()
        .zip(b)
        .all(|(a, b)| a == b || *a == Value::Unset || *b == Value::Unset)
}

/// The axes on which some rows differ. The others do not part rows, and need no room in their keys.
pub fn varying(rows: &[&Row], axes: impl IntoIterator<Item = AxisId>) -> Vec<AxisId> {
    let Some((first, rest)) = rows.split_first() else {
        return Vec::new();
    };
    axes.into_iter()
        .filter(|axis| {
            rest.iter()
                .any(|row| row.point[*axis] != first.point[*axis])
        })
        .collect()
}

/// Groups rows that agree on some axes ([`rows`](crate::run::rows::rows)).
pub fn group_by_axes<'r, 'f>(
    rows: &[&'r Row<'f>],
    axes: &[AxisId],
) -> Vec<(Key, Vec<&'r Row<'f>>)> {
    crate::run::rows::rows(rows, |row| row.key(axes))
}

/// Pairs each row with the row that has the base value on an axis and agrees on all others. If only
/// one of two rows uses an axis, it must have the default there, or the first value if the default
/// was not run; sample counts must be equal.
pub fn pair<'r, 'f>(
    rows: &[&'r Row<'f>],
    axis: AxisId,
    base: &Value,
) -> Vec<(&'r Row<'f>, &'r Row<'f>)> {
    let matching = Matching {
        axis,
        values: AXES
            .ids()
            .map(|axis| distinct_in_order(set_values(rows, axis)))
            .collect(),
    };
    let mut bases = Vec::new();
    let mut others = Vec::new();
    for row in rows {
        if row.point[axis] == *base {
            bases.push(*row);
        } else if row.point[axis] != Value::Unset {
            others.push(*row);
        }
    }
    let partner = |row: &'r Row<'f>| bases.iter().find(|base| matching.is_pair(row, base));
    others
        .into_iter()
        .filter_map(|row| Some((row, *partner(row)?)))
        .collect()
}

/// Decides which rows are paired ([`pair`]).
struct Matching {
    /// The axis on which paired rows differ.
    axis: AxisId,
    /// The values of all rows.
    values: PerAxis<Vec<Value>>,
}

impl Matching {
    fn is_pair(&self, a: &Row, b: &Row) -> bool {
        AXES.ids().all(|axis| {
            axis == self.axis
                || !AXES[axis].changes_radiance()
                || a.point[axis] == b.point[axis]
                || self.is_substitute(axis, a, b)
                || self.is_substitute(axis, b, a)
        })
    }

    /// Whether `unset` does not use the axis, and the other row has the usual value there.
    fn is_substitute(&self, axis: AxisId, unset: &Row, row: &Row) -> bool {
        AXES[axis].part != Part::Count
            && unset.point[axis] == Value::Unset
            && self.usual(axis, row).as_ref() == Some(&row.point[axis])
    }

    /// The default of a row on an axis if it was run, else the first value.
    fn usual(&self, axis: AxisId, row: &Row) -> Option<Value> {
        let default = row.point.default_of(axis);
        if self.values[axis].contains(&default) {
            Some(default)
        } else {
            self.values[axis].first().cloned()
        }
    }
}

fn set_values(rows: &[&Row], axis: AxisId) -> Vec<Value> {
    rows.iter()
        .map(|row| row.point[axis].clone())
        .filter(|value| *value != Value::Unset)
        .collect()
}

/// Each value once, in order of appearance.
pub fn distinct_in_order<T: Eq + std::hash::Hash>(values: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut distinct = IndexSet::new();
    // One by one: `extend` and `collect` reserve room for as many as there are values.
    for value in values {
        distinct.insert(value);
    }
    distinct.into_iter().collect()
}

/// Groups items with equal keys, in order of appearance.
pub fn grouped<T, K: Eq + std::hash::Hash>(
    items: impl IntoIterator<Item = T>,
    key: impl Fn(&T) -> K,
) -> Vec<(K, Vec<T>)> {
    let mut groups: IndexMap<K, Vec<T>> = IndexMap::new();
    for item in items {
        groups.entry(key(&item)).or_default().push(item);
    }
    groups.into_iter().collect()
}

/// The distinct values of rows on an axis, as [`ascending`].
pub fn values<'r, 'f: 'r>(rows: impl IntoIterator<Item = &'r Row<'f>>, axis: AxisId) -> Vec<Value> {
    ascending(distinct_in_order(
        rows.into_iter().map(|row| row.point[axis].clone()),
    ))
}

/// Numbers ascending, anything else in the order given.
pub fn ascending(mut values: Vec<Value>) -> Vec<Value> {
    values.sort_by(by_size);
    values
}

/// Groups items by the value of their row on an axis, ascending.
pub fn grouped_ascending<'r, 'f: 'r, T>(
    items: impl IntoIterator<Item = T>,
    axis: AxisId,
    row: impl Fn(&T) -> &'r Row<'f>,
) -> Vec<(Value, Vec<T>)> {
    let mut groups = grouped(items, |item| row(item).point[axis].clone());
    groups.sort_by(|(a, _), (b, _)| by_size(a, b));
    groups
}

fn by_size(a: &Value, b: &Value) -> std::cmp::Ordering {
    a.size()
        .partial_cmp(&b.size())
        .unwrap_or(std::cmp::Ordering::Equal)
}

/// Each distinct image once; of equal images the first with a score.
fn distinct(run: &Finished) -> Vec<Row<'_>> {
    let mut rows: IndexMap<Point, Row> = IndexMap::new();
    let mut points = Points::default();
    for cell in &run.cells {
        // Without methods, any parameter may change the pixels.
        let is_whole = [METHOD, DIFFUSE_METHOD]
            .iter()
            .all(|&axis| cell.point[axis] != Value::Unset);
        let point = if is_whole {
            points.shared(&cell.point.of_pixels())
        } else {
            cell.point.clone()
        };
        if let Some(known) = rows.get_mut(&point) {
            let is_better = known.cell.scores.is_none() && cell.scores.is_some();
            let other = if is_better {
                std::mem::replace(&mut known.cell, cell)
            } else {
                cell
            };
            known.copies.push(&other.id);
        } else {
            rows.insert(
                point.clone(),
                Row {
                    cell,
                    copies: Vec::new(),
                    point,
                },
            );
        }
    }
    let mut rows: Vec<Row> = rows.into_values().collect();
    // The vector has the room of the map's entries.
    rows.shrink_to_fit();
    rows
}
