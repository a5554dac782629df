//! The frame: the images of one run as typed rows, and the few ways to group, pair and sum them up.
//!
//! Every question is answered from a frame. A row is one distinct linear image at one tone curve. Statistics are in [`estimate`].

pub mod curve;
pub mod estimate;
pub mod line;
mod shape;

use crate::spelling::Listed;
pub use shape::Shape;

use super::finished::{Bin, Finished, FinishedCell};
use super::names::Names;
use super::table::axis_cells;
use crate::experiment::axis::{
    ALPHA, AXES, BRDF, DIFFUSE_METHOD, ENVIRONMENT, ENVIRONMENT_CLIP, F0, METHOD, Part, Point, SAMPLES, SCENE, index_of,
};
use crate::experiment::value::Value;
use crate::metrics::{HEADLINE, Metric, Space, Verdict, verdict};
use crate::run::tables::DISPLAY_HEADLINE;
use crate::scene::is_design;
use crate::shade::NONE;
use crate::table::csv::Cell;
use indexmap::IndexMap;
use std::collections::{HashMap, HashSet};

/// Mean FLIP from which on a difference counts as visible: a convention of this project, since FLIP's authors give none.
pub const VISIBLE_FROM: f64 = 0.05;

/// Values on some axes; an axis that does not reach the pixels is unset.
pub type Key = Vec<Value>;

/// One image.
#[derive(Clone, Debug)]
pub struct Row<'f> {
    pub cell: &'f FinishedCell,
    /// Other cells with the same pixels, by id.
    pub copies: Vec<&'f str>,
    /// The cell's point with every axis unset that cannot reach its pixels, and equal lights written alike.
    pub point: Point,
}

/// The images of one run.
pub struct Frame<'f> {
    pub run: &'f Finished,
    pub shape: Shape,
    pub rows: Vec<Row<'f>>,
    /// The metric of the run's questions.
    pub metric: &'static dyn Metric,
    pub names: Names,
    /// The axis whose values make the rows of a digest, if the experiment names one.
    by: Option<usize>,
}

/// The axis of that name, as an index of [`AXES`]. For names that this program wrote itself.
pub fn axis(name: &str) -> usize {
    index_of(name).unwrap_or_else(|| panic!("{name} is not an axis"))
}

impl<'f> Frame<'f> {
    /// The frame of a run, judged by the metric of that name, else by the experiment's own.
    pub fn new(run: &'f Finished, metric_name: Option<&str>) -> Self {
        let own = run.config.as_ref().map_or(HEADLINE, |config| config.metric);
        let metric = <dyn Metric>::listed(metric_name.unwrap_or(own));
        let rows = distinct(run);
        Self { shape: Shape::of_rows(run, &rows), run, rows, metric, names: Names::of(run), by: None }
    }

    /// The frame with digests by this axis, if there is one.
    pub fn told_by(self, by: Option<usize>) -> Self {
        Self { by, ..self }
    }

    /// The frame of another run or metric with the digests of this one.
    pub fn like<'g>(&self, run: &'g Finished, metric: &str) -> Frame<'g> {
        Frame::new(run, Some(metric)).told_by(self.by)
    }

    /// The axis whose values make the rows of digests and the steps of figures: alpha, unless the experiment names another one.
    pub fn row_axis(&self) -> usize {
        self.by.unwrap_or(ALPHA)
    }

    /// The name of the metric: a column of every table.
    pub fn metric_name(&self) -> &'static str {
        self.metric.description().name
    }

    /// The error of a row ([`Metric::error`]): lower is better, whatever the metric. Nothing for a failed cell.
    pub fn error(&self, row: &Row) -> Option<f64> {
        Some(self.metric.error(self.score(row)?))
    }

    /// The score of a row, as the metric defines it.
    pub fn score(&self, row: &Row) -> Option<f64> {
        row.score(self.metric_name())
    }

    /// The score that an exact image would have against the row's reference.
    pub fn noise_floor(&self, row: &Row) -> Option<f64> {
        row.cell.noise_floors.get(self.metric_name())
    }

    /// Whether the error stands clear of the reference's own noise. Metrics without a floor are taken at their word.
    pub fn is_resolved(&self, row: &Row) -> bool {
        match (self.score(row), self.noise_floor(row)) {
            (Some(error), Some(floor)) => verdict(self.metric, error, floor) == Verdict::Resolved,
            (error, _) => error.is_some(),
        }
    }

    /// The error over the pixels of a bin.
    pub fn bin_error(&self, bin: &Bin) -> Option<f64> {
        Some(self.metric.error(bin.scores.get(self.metric_name())?))
    }

    /// Swept axes that play one of these parts, in the order of [`AXES`].
    pub fn swept(&self, parts: &[Part]) -> Vec<usize> {
        (0..AXES.len()).filter(|&i| parts.contains(&AXES[i].part) && self.shape.is_swept(i)).collect()
    }

    /// Swept axes that tell cases apart for a comparison of methods: all but method, samples, point sets and the tone curve.
    pub fn case_axes(&self) -> Vec<usize> {
        let own = self.swept(&[Part::Case, Part::Parameter, Part::Table, Part::Method]);
        own.into_iter().filter(|axis| *axis != METHOD).collect()
    }

    /// The axes of every answer's table, swept or not: those that tell cases apart, and what an error depends on most.
    pub fn table_axes(&self) -> Vec<usize> {
        let (own, always) = (self.case_axes(), [ENVIRONMENT, BRDF, ALPHA, F0]);
        (0..AXES.len()).filter(|axis| own.contains(axis) || always.contains(axis)).collect()
    }

    /// Scenes that tell nothing in the metric of the questions: beside a design, pictures in a metric of radiance, since they prefer parts
    /// of the map; the design in a metric of what is seen, since its pixels are no picture.
    fn silent_scenes(&self) -> Vec<Value> {
        let scenes = distinct_in_order(self.rows.iter().map(|row| row.point[SCENE].clone()));
        let (designs, pictures): (Vec<_>, Vec<_>) = scenes.into_iter().partition(|scene| is_design(&scene.to_string()));
        match (designs.is_empty() || pictures.is_empty(), self.metric.description().space) {
            (true, _) => Vec::new(),
            (false, Space::Linear) => pictures,
            (false, Space::Display) => designs,
        }
    }

    /// Whether the metric is of what is seen, and every scene a design.
    pub fn has_no_picture(&self) -> bool {
        self.metric.description().space == Space::Display
            && self.rows.iter().all(|row| is_design(&row.point[SCENE].to_string()))
    }

    /// Rows with scores, each linear image once: of rows that differ in the tone curve only, the one with the plain curve, else the first.
    pub fn images(&self) -> Vec<&Row<'f>> {
        let silent = self.silent_scenes();
        let mut places: HashMap<Key, usize> = HashMap::new();
        let linear = |row: &Row| -> Key {
            AXES.iter().zip(&row.point.0).filter(|(axis, _)| axis.changes_radiance()).map(|(_, v)| v.clone()).collect()
        };
        let mut images: Vec<&Row<'f>> = Vec::new();
        let is_told = |row: &&Row| row.cell.scores.is_some() && !silent.contains(&row.point[SCENE]);
        for row in self.rows.iter().filter(is_told) {
            match places.get(&linear(row)) {
                Some(&place) if row.has_plain_curve() => images[place] = row,
                Some(_) => {}
                None => {
                    places.insert(linear(row), images.len());
                    images.push(row);
                }
            }
        }
        images
    }

    /// What is said beside times of a driver that computes on the CPU; empty for others.
    pub fn cpu_words(&self) -> &'static str {
        if self.run.is_cpu_timed() { " on this CPU driver" } else { "" }
    }

    /// The axes of [`Frame::way`]: method and sample count; where no row has a specular term, the diffuse method.
    pub fn way_axes(&self) -> Vec<usize> {
        if self.shape.methods().next().is_some() { vec![METHOD, SAMPLES] } else { vec![DIFFUSE_METHOD] }
    }

    /// Whether a row shows none of the terms that [`Frame::way`] tells of: it is there for scale.
    pub fn is_nothing(&self, row: &Row) -> bool {
        self.way(row) == NONE
    }

    /// How the image of a row is made: "sampled 16", "split-sum"; where no row has a specular term, the diffuse method.
    pub fn way(&self, row: &Row) -> String {
        let texts: Vec<String> = self.way_axes().into_iter().map(|axis| row.text(axis)).collect();
        texts.join(" ").trim_end().to_owned()
    }
}

impl Row<'_> {
    /// Its values on these axes.
    pub fn key(&self, axes: &[usize]) -> Key {
        axes.iter().map(|&axis| self.point[axis].clone()).collect()
    }

    /// Its values on these axes, as cells of a table.
    pub fn cells(&self, axes: &[usize]) -> Vec<Cell> {
        axis_cells(axes, &self.key(axes))
    }

    /// The value on an axis, as text for tables.
    pub fn text(&self, axis: usize) -> String {
        self.point[axis].to_string()
    }

    /// The score in a metric; nothing for a failed cell.
    pub fn score(&self, metric: &str) -> Option<f64> {
        self.cell.scores.as_ref()?.get(metric)
    }

    /// Samples a pixel, for a method that draws some.
    pub fn samples(&self) -> Option<u32> {
        match self.point[SAMPLES] {
            Value::Count(count) => Some(count),
            _ => None,
        }
    }

    /// Whether the axes of the tone curve stand at their defaults.
    pub fn has_plain_curve(&self) -> bool {
        let values = AXES.iter().zip(&self.point.0);
        values.filter(|(axis, _)| axis.part == Part::Display).all(|(axis, value)| *value == (axis.default)())
    }

    /// Mean FLIP of the image after its tone curve.
    pub fn flip(&self) -> Option<f64> {
        self.score(DISPLAY_HEADLINE)
    }

    /// Whether the row has no specular term.
    pub fn has_no_method(&self) -> bool {
        self.text(METHOD) == NONE
    }

    /// Bias squared over bias squared plus variance, where both were estimated.
    pub fn bias_share(&self) -> Option<f64> {
        let [bias, variance] = self.cell.bias_variance?;
        Some(bias / (bias + variance)).filter(|share| share.is_finite())
    }
}

/// Whether two keys agree; an axis that one of the two does not use fits any value.
pub fn fits(a: &[Value], b: &[Value]) -> bool {
    a.iter().zip(b).all(|(a, b)| a == b || *a == Value::Unset || *b == Value::Unset)
}

/// Rows that agree on some axes, each group with its key, in the order of the rows. A row that does not use an axis stands in every group
/// that it does not contradict.
pub fn by<'r, 'f>(rows: &[&'r Row<'f>], axes: &[usize]) -> Vec<(Key, Vec<&'r Row<'f>>)> {
    let mut groups: Vec<(Key, Vec<usize>)> = grouped(0..rows.len(), |&row| rows[row].key(axes));
    // The keys with the same unset axes, by their other values: what lies within a key is looked up, since a run may have a key a row.
    let mut partial: HashMap<Vec<bool>, HashMap<Vec<&Value>, usize>> = HashMap::new();
    for (place, (key, _)) in groups.iter().enumerate() {
        let is_set: Vec<bool> = key.iter().map(|value| *value != Value::Unset).collect();
        let values = key.iter().filter(|value| **value != Value::Unset).collect();
        partial.entry(is_set).or_default().insert(values, place);
    }
    partial.retain(|is_set, _| is_set.contains(&false));
    let within = |(of, (key, _)): (usize, &(Key, Vec<usize>))| {
        let own = partial.iter().filter_map(|(is_set, places)| {
            let values: Vec<&Value> = key.iter().zip(is_set).filter(|(_, is)| **is).map(|(value, _)| value).collect();
            places.get(&values).copied()
        });
        own.filter(|&place| place != of).collect()
    };
    let within: Vec<Vec<usize>> = groups.iter().enumerate().map(within).collect();
    let is_part: HashSet<usize> = within.iter().flatten().copied().collect();
    for (of, parts) in within.iter().enumerate().filter(|(_, parts)| !parts.is_empty()) {
        let more: Vec<usize> = parts.iter().flat_map(|&part| groups[part].1.clone()).collect();
        groups[of].1.extend(more);
    }
    let whole = groups.into_iter().enumerate().filter(|(place, _)| !is_part.contains(place));
    let group = |(_, (key, mut own)): (usize, (Key, Vec<usize>))| {
        own.sort_unstable();
        own.dedup();
        (key, own.into_iter().map(|row| rows[row]).collect())
    };
    whole.map(group).collect()
}

/// Each row with another value on an axis beside the row that has the base there and agrees on all other axes. An axis that one of the two
/// does not use stands at its default in the other, or at its first value where the default was not run; sample counts must be equal.
pub fn pair<'r, 'f>(rows: &[&'r Row<'f>], axis: usize, base: &Value) -> Vec<(&'r Row<'f>, &'r Row<'f>)> {
    let run: Vec<Vec<Value>> = (0..AXES.len()).map(|of| distinct_in_order(set_values(rows, of))).collect();
    let usual = |of: usize, row: &Row| {
        let default = row.point.default_of(of);
        if run[of].contains(&default) { Some(default) } else { run[of].first().cloned() }
    };
    let agrees = |a: &Row, b: &Row| {
        (0..AXES.len()).all(|i| {
            let (x, y) = (&a.point.0[i], &b.point.0[i]);
            let may_default = AXES[i].part != Part::Count;
            let stands_for = |unset: &Value, of: &Row| {
                may_default && *unset == Value::Unset && usual(i, of) == Some(of.point.0[i].clone())
            };
            i == axis || !AXES[i].changes_radiance() || x == y || stands_for(x, b) || stands_for(y, a)
        })
    };
    let bases: Vec<&&Row> = rows.iter().filter(|row| row.point.0[axis] == *base).collect();
    let others = rows.iter().filter(|row| row.point.0[axis] != *base && row.point.0[axis] != Value::Unset);
    others.filter_map(|row| Some((*row, **bases.iter().find(|other| agrees(row, other))?))).collect()
}

/// The values of rows on an axis, without the unset ones.
fn set_values(rows: &[&Row], axis: usize) -> Vec<Value> {
    rows.iter().map(|row| row.point.0[axis].clone()).filter(|value| *value != Value::Unset).collect()
}

/// Each value once, in the order of its first appearance.
pub fn distinct_in_order<T: Clone + Eq + std::hash::Hash>(values: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut seen = HashSet::new();
    values.into_iter().filter(|value| seen.insert(value.clone())).collect()
}

/// Items with equal keys together, in the order of their first appearance.
pub fn grouped<T, K: Eq + std::hash::Hash>(
    items: impl IntoIterator<Item = T>,
    key: impl Fn(&T) -> K,
) -> Vec<(K, Vec<T>)> {
    let mut groups: IndexMap<K, Vec<T>> = IndexMap::new();
    items.into_iter().for_each(|item| groups.entry(key(&item)).or_default().push(item));
    groups.into_iter().collect()
}

/// The different values of some rows on an axis: numbers ascending, anything else in the order of the rows.
pub fn values<'r, 'f: 'r>(rows: impl IntoIterator<Item = &'r Row<'f>>, axis: usize) -> Vec<Value> {
    ascending(distinct_in_order(rows.into_iter().map(|row| row.point[axis].clone())))
}

/// Numbers ascending, anything else in the order given.
pub fn ascending(mut values: Vec<Value>) -> Vec<Value> {
    values.sort_by(|a, b| a.size().partial_cmp(&b.size()).unwrap_or(std::cmp::Ordering::Equal));
    values
}

/// Groups by the value of their rows on an axis, ascending.
pub fn grouped_ascending<'r, 'f: 'r, T>(
    items: impl IntoIterator<Item = T>,
    of: usize,
    row: impl Fn(&T) -> &'r Row<'f>,
) -> Vec<(Value, Vec<T>)> {
    let mut groups = grouped(items, |item| row(item).point[of].clone());
    groups.sort_by(|(a, _), (b, _)| a.size().partial_cmp(&b.size()).unwrap_or(std::cmp::Ordering::Equal));
    groups
}

/// The cells with each distinct image once. Of equal images the first with a score stands for all.
fn distinct(run: &Finished) -> Vec<Row<'_>> {
    // Two clips above the peak leave the same light: the first stands for both.
    let mut clips: HashMap<(Value, [u64; 2]), Value> = HashMap::new();
    let mut places: HashMap<Key, usize> = HashMap::new();
    let mut rows: Vec<Row> = Vec::new();
    for cell in &run.cells {
        let light = run.light(&cell.point);
        // What only lights use is unset already where there are none.
        // Without its methods nothing is known of what reaches the pixels.
        let is_whole = [METHOD, DIFFUSE_METHOD].iter().all(|&axis| cell.point[axis] != Value::Unset);
        let mut point = if is_whole { cell.point.of_pixels(true) } else { cell.point.clone() };
        if let Some(light) = light {
            let key = (point[ENVIRONMENT].clone(), [light.mean.to_bits(), light.peak.to_bits()]);
            point[ENVIRONMENT_CLIP] = clips.entry(key).or_insert_with(|| cell.point[ENVIRONMENT_CLIP].clone()).clone();
        }
        match places.get(&point.0) {
            Some(&place) => {
                let known = &mut rows[place];
                let other = if known.cell.scores.is_none() && cell.scores.is_some() {
                    std::mem::replace(&mut known.cell, cell)
                } else {
                    cell
                };
                known.copies.push(&other.id);
            }
            None => {
                places.insert(point.0.clone(), rows.len());
                rows.push(Row { cell, copies: Vec::new(), point });
            }
        }
    }
    rows
}
