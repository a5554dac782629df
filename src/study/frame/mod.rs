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
use crate::experiment::axis::{
    ALPHA, AXES, AxisId, BRDF, DIFFUSE_METHOD, ENVIRONMENT, F0, METHOD, Part, PerAxis, Point,
    SAMPLES, SCENE,
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
    pub by: Option<AxisId>,
    /// The axis along which curves have their points: samples, or frames.
    pub along: AxisId,
    /// Whether no other frame of the run comes before it, under another weight of views.
    pub leads: bool,
}

impl<'f> Frame<'f> {
    /// The frame of a run with the metric of that name, else the experiment's own.
    pub fn new(run: &'f Finished, metric_name: Option<&str>) -> Self {
        let own = run.config.as_ref().map_or(HEADLINE, |config| config.metric);
        let metric = Metric::listed(metric_name.unwrap_or(own));
        let rows = distinct(run);
        Self {
            shape: Shape::of_rows(run, &rows),
            run,
            rows,
            metric,
            names: Names::of(run),
            by: None,
            along: SAMPLES,
            leads: true,
        }
    }

    /// A frame of another run or metric with the same rows of digests.
    pub fn like<'g>(&self, run: &'g Finished, metric: &str) -> Frame<'g> {
        Frame {
            by: self.by,
            along: self.along,
            leads: self.leads,
            ..Frame::new(run, Some(metric))
        }
    }

    /// The axis of the rows of digests and the steps of figures: alpha, unless the experiment names
    /// another one.
    pub fn row_axis(&self) -> AxisId {
        self.by.unwrap_or(ALPHA)
    }

    pub fn metric_name(&self) -> &'static str {
        self.metric.name
    }

    /// The error of a row ([`Metric::error`]): lower is better. `None` for a failed cell.
    pub fn error(&self, row: &Row) -> Option<f64> {
        Some(self.metric.error(self.score(row)?))
    }

    pub fn score(&self, row: &Row) -> Option<f64> {
        row.score(self.metric_name())
    }

    /// Expected score of an exact image.
    pub fn noise_floor(&self, row: &Row) -> Option<f64> {
        row.cell.noise_floors.get(self.metric_name())
    }

    /// Whether the error is resolved against the reference's noise; always, for metrics without a
    /// noise floor.
    pub fn is_resolved(&self, row: &Row) -> bool {
        match (self.score(row), self.noise_floor(row)) {
            (Some(error), Some(floor)) => verdict(self.metric, error, floor) == Verdict::Resolved,
            (error, _) => error.is_some(),
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
        let own = self.swept(&[
            Part::Case,
            Part::Parameter,
            Part::Table,
            Part::Method,
            Part::Count,
        ]);
        own.into_iter()
            .filter(|axis| ![METHOD, self.along].contains(axis))
            .collect()
    }

    /// The axes of answer tables: axes of cases, and the most important axes even with one value.
    pub fn table_axes(&self) -> Vec<AxisId> {
        let (own, always) = (self.case_axes(), [ENVIRONMENT, BRDF, ALPHA, F0]);
        AXES.ids()
            .filter(|axis| own.contains(axis) || always.contains(axis))
            .collect()
    }

    /// Scenes without meaning for the metric: beside a design, pictures in a metric of radiance,
    /// since they prefer parts of the map; the design in a metric of display images, since it is
    /// not a picture.
    fn silent_scenes(&self) -> Vec<Value> {
        let scenes = distinct_in_order(self.rows.iter().map(|row| row.point[SCENE].clone()));
        let (designs, pictures): (Vec<_>, Vec<_>) = scenes
            .into_iter()
            .partition(|scene| is_design(&scene.to_string()));
        match (designs.is_empty() || pictures.is_empty(), self.metric.space) {
            (true, _) => Vec::new(),
            (false, Space::Linear) => pictures,
            (false, Space::Display) => designs,
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
        let silent = self.silent_scenes();
        let linear = |row: &Row| -> Key {
            AXES.iter()
                .zip(&row.point.0)
                .filter(|(axis, _)| axis.changes_radiance())
                .map(|(_, v)| v.clone())
                .collect()
        };
        let mut images: IndexMap<Key, &Row<'f>> = IndexMap::new();
        let is_counted =
            |row: &&Row| row.cell.scores.is_some() && !silent.contains(&row.point[SCENE]);
        for row in self.rows.iter().filter(is_counted) {
            let known = images.entry(linear(row)).or_insert(row);
            if row.has_plain_curve() {
                *known = row;
            }
        }
        images.into_values().collect()
    }

    /// The run as seen at each band of n·v, if all images are of designs: with a camera n·v is tied
    /// to a place on the map.
    pub fn views(&self, images: &[&Row]) -> Vec<([f64; 2], Finished)> {
        let is_asked = images.iter().all(|row| is_design(&row.text(SCENE)));
        let seen = |seen: &[f64; 2]| Some((*seen, self.run.seen_at(*seen)?));
        VIEWS.iter().filter(|_| is_asked).filter_map(seen).collect()
    }

    /// A remark on times of a CPU driver; else empty.
    pub fn cpu_words(&self) -> &'static str {
        if self.run.is_cpu_timed() {
            " on this CPU driver"
        } else {
            ""
        }
    }

    /// The axes of [`Frame::way`]: method and sample count; without any specular term, the diffuse
    /// method.
    pub fn way_axes(&self) -> Vec<AxisId> {
        if self.shape.methods().next().is_some() {
            vec![METHOD, SAMPLES]
        } else {
            vec![DIFFUSE_METHOD]
        }
    }

    /// Whether a row has none of the compared terms.
    pub fn is_nothing(&self, row: &Row) -> bool {
        self.way(row) == NONE
    }

    /// How the image of a row is made: "sampled 16", "split-sum".
    pub fn way(&self, row: &Row) -> String {
        let texts: Vec<String> = self
            .way_axes()
            .into_iter()
            .map(|axis| row.text(axis))
            .collect();
        texts.join(" ").trim_end().to_owned()
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

    /// `None` for a failed cell.
    pub fn score(&self, metric: &str) -> Option<f64> {
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
        let values = AXES.iter().zip(&self.point.0);
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

/// Whether two keys agree; an unset value fits any value.
pub fn fits(a: &[Value], b: &[Value]) -> bool {
    a.iter()
        .zip(b)
        .all(|(a, b)| a == b || *a == Value::Unset || *b == Value::Unset)
}

/// Groups rows that agree on some axes ([`rows`](crate::run::rows::rows)).
pub fn by<'r, 'f>(rows: &[&'r Row<'f>], axes: &[AxisId]) -> Vec<(Key, Vec<&'r Row<'f>>)> {
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
    let run: PerAxis<Vec<Value>> = AXES
        .ids()
        .map(|of| distinct_in_order(set_values(rows, of)))
        .collect();
    let usual = |of: AxisId, row: &Row| {
        let default = row.point.default_of(of);
        if run[of].contains(&default) {
            Some(default)
        } else {
            run[of].first().cloned()
        }
    };
    let agrees = |a: &Row, b: &Row| {
        AXES.ids().all(|i| {
            let (x, y) = (&a.point.0[i], &b.point.0[i]);
            let may_default = AXES[i].part != Part::Count;
            let replaces = |unset: &Value, of: &Row| {
                may_default && *unset == Value::Unset && usual(i, of) == Some(of.point.0[i].clone())
            };
            i == axis || !AXES[i].changes_radiance() || x == y || replaces(x, b) || replaces(y, a)
        })
    };
    let bases: Vec<&&Row> = rows
        .iter()
        .filter(|row| row.point.0[axis] == *base)
        .collect();
    let others = rows
        .iter()
        .filter(|row| row.point.0[axis] != *base && row.point.0[axis] != Value::Unset);
    others
        .filter_map(|row| Some((*row, **bases.iter().find(|other| agrees(row, other))?)))
        .collect()
}

fn set_values(rows: &[&Row], axis: AxisId) -> Vec<Value> {
    rows.iter()
        .map(|row| row.point.0[axis].clone())
        .filter(|value| *value != Value::Unset)
        .collect()
}

/// Each value once, in order of appearance.
pub fn distinct_in_order<T: Eq + std::hash::Hash>(values: impl IntoIterator<Item = T>) -> Vec<T> {
    values
        .into_iter()
        .collect::<IndexSet<T>>()
        .into_iter()
        .collect()
}

/// Groups items with equal keys, in order of appearance.
pub fn grouped<T, K: Eq + std::hash::Hash>(
    items: impl IntoIterator<Item = T>,
    key: impl Fn(&T) -> K,
) -> Vec<(K, Vec<T>)> {
    let mut groups: IndexMap<K, Vec<T>> = IndexMap::new();
    items
        .into_iter()
        .for_each(|item| groups.entry(key(&item)).or_default().push(item));
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
    of: AxisId,
    row: impl Fn(&T) -> &'r Row<'f>,
) -> Vec<(Value, Vec<T>)> {
    let mut groups = grouped(items, |item| row(item).point[of].clone());
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
    let mut rows: IndexMap<PerAxis<Value>, Row> = IndexMap::new();
    for cell in &run.cells {
        // Without methods, any parameter may change the pixels.
        let is_whole = [METHOD, DIFFUSE_METHOD]
            .iter()
            .all(|&axis| cell.point[axis] != Value::Unset);
        let point = if is_whole {
            cell.point.of_pixels()
        } else {
            cell.point.clone()
        };
        if let Some(known) = rows.get_mut(&point.0) {
            let is_better = known.cell.scores.is_none() && cell.scores.is_some();
            let other = if is_better {
                std::mem::replace(&mut known.cell, cell)
            } else {
                cell
            };
            known.copies.push(&other.id);
        } else {
            rows.insert(
                point.0.clone(),
                Row {
                    cell,
                    copies: Vec::new(),
                    point,
                },
            );
        }
    }
    rows.into_values().collect()
}
