//! A number of each image of a group, and how it depends on the axes: digests, extremes, changes of
//! sign.

use super::words::{count, number, scope_statement};
use crate::base::csv::Cell;
use crate::draw::figure::{Mark, Shape as Form};
use crate::draw::words::{Extent, Statement, statement};
use crate::experiment::axis::{AXES, AxisId, ENVIRONMENT, Part, SAMPLES};
use crate::experiment::value::Value;
use crate::instrument::environment::BUILTIN_PREFIX;
use crate::study::frame::estimate::{CLUSTERS_MIN, Estimate, Middle, estimate};
use crate::study::frame::{Frame, Row, distinct_in_order, grouped_ascending, values};
use crate::study::table::Table;

/// Name of the last row and column.
pub const ALL: &str = "all";

/// The number at a value of an axis.
#[derive(Clone, Debug)]
pub struct AtValue {
    pub value: Value,
    pub number: f64,
}

/// An axis along which ratios are on both sides of 1, and the ratio at each value, ascending.
pub struct SignChange {
    pub axis: AxisId,
    pub ratios: Vec<AtValue>,
}

/// How many of some cases have a ratio below 1.
#[derive(Clone, Copy)]
pub struct Wins {
    pub below: usize,
    pub all: usize,
}

/// The least and the largest number along an axis.
struct Spread {
    axis: AxisId,
    least: AtValue,
    most: AtValue,
}

impl Spread {
    fn factor(&self) -> f64 {
        self.most.number / self.least.number
    }
}

/// A number of each image, averaged over any group of them.
#[derive(Clone)]
pub struct Numbers<'r, 'f> {
    items: Vec<(&'r Row<'f>, f64)>,
    middle: Middle,
    /// Whether 1 separates better from worse.
    is_ratio: bool,
    /// Whether it is part of a group in which formulas do not count.
    is_part: bool,
}

impl<'r, 'f> Numbers<'r, 'f> {
    pub fn new(items: impl IntoIterator<Item = (&'r Row<'f>, f64)>, middle: Middle) -> Self {
        Self {
            items: items.into_iter().collect(),
            middle,
            is_ratio: false,
            is_part: false,
        }
    }

    /// Ratios, averaged by their geometric mean, but never over a change of sign.
    pub fn ratios(items: impl IntoIterator<Item = (&'r Row<'f>, f64)>) -> Self {
        Self {
            is_ratio: true,
            ..Self::new(items, Middle::GeometricMean)
        }
    }

    /// Whether the environment of a row counts; see [`Self::evidence`].
    pub fn counts(&self, row: &Row) -> bool {
        self.evidence()
            .values(ENVIRONMENT)
            .contains(&row.point[ENVIRONMENT])
    }

    /// Whether environments are enough for an interval.
    pub fn has_interval(&self) -> bool {
        self.estimate().is_some_and(|all| all.interval.is_some())
    }

    /// As [`middle_marks`].
    pub fn marks(
        &self,
        series: usize,
        name: &str,
        position: impl Fn(f64) -> [f64; 2],
        words: &dyn Fn(&Estimate) -> String,
    ) -> Vec<Mark> {
        let Some(all) = self.estimate() else {
            return Vec::new();
        };
        middle_marks(&all, series, name, position, words)
    }

    /// The numbers under measured environments, if these are enough for an interval: formulas then
    /// do not count.
    pub fn evidence(&self) -> Self {
        let measured = self.measured_count();
        let are_enough = measured >= CLUSTERS_MIN || (self.is_part && measured > 0);
        let items = self.items.iter().copied();
        Self {
            items: items
                .filter(|(row, _)| !are_enough || !is_formula(&row.point[ENVIRONMENT]))
                .collect(),
            ..*self
        }
    }

    /// Number of environments that are measured and not formulas.
    fn measured_count(&self) -> usize {
        self.values(ENVIRONMENT)
            .iter()
            .filter(|light| !is_formula(light))
            .count()
    }

    /// Environments with a ratio below 1.
    pub fn winning_environments(&self) -> Wins {
        let by_light = self.evidence().by_value(ENVIRONMENT);
        Wins {
            below: by_light.iter().filter(|light| light.number < 1.0).count(),
            all: by_light.len(),
        }
    }

    /// Images with a ratio below 1.
    pub fn winning_images(&self) -> Wins {
        Wins {
            below: self.items.iter().filter(|(_, ratio)| *ratio < 1.0).count(),
            all: self.items.len(),
        }
    }

    /// The images with this value on an axis.
    pub fn with_value(&self, axis: AxisId, value: &Value) -> Self {
        let items = self.items.iter().copied();
        self.part(items.filter(|(row, _)| row.point[axis] == *value).collect())
    }

    /// The images at each value of an axis, ascending.
    pub fn parts(&self, axis: AxisId) -> Vec<(Value, Self)> {
        let whole = self.part(Vec::new());
        let by_value = grouped_ascending(self.items.iter().copied(), axis, |(row, _)| *row);
        let parts = by_value.into_iter().map(|(value, items)| {
            let part = Self { items, ..whole };
            (value, part)
        });
        parts.collect()
    }

    /// Some of these images, as a part.
    fn part(&self, items: Vec<(&'r Row<'f>, f64)>) -> Self {
        Self {
            items,
            is_part: self.is_part || self.measured_count() >= CLUSTERS_MIN,
            ..*self
        }
    }

    pub fn items(&self) -> &[(&'r Row<'f>, f64)] {
        &self.items
    }

    pub fn rows(&self) -> impl Iterator<Item = &'r Row<'f>> {
        self.items.iter().map(|(row, _)| *row)
    }

    pub fn values(&self, axis: AxisId) -> Vec<Value> {
        values(self.rows(), axis)
    }

    /// The average with its interval over environments.
    pub fn estimate(&self) -> Option<Estimate> {
        let evidence = self.evidence();
        let items = evidence.items.iter();
        let by_light: Vec<_> = items
            .map(|(row, number)| (row.point[ENVIRONMENT].clone(), *number))
            .collect();
        estimate(&by_light, self.middle)
    }

    /// The average, unless ratios are on both sides of 1.
    pub fn pooled(&self, frame: &Frame) -> Option<Estimate> {
        self.estimate()
            .filter(|_| !self.is_ratio || self.change_of_sign(frame).is_none())
    }

    /// "Over 10 environments, 3 BRDF models, 5 alphas."
    pub fn scope(&self, frame: &Frame) -> Option<Statement> {
        scope_statement(frame, &self.evidence().rows().collect::<Vec<_>>())
    }

    /// ", under sky" for one environment, else `several`.
    pub fn light(&self, frame: &Frame, several: &str) -> Statement {
        match self.values(ENVIRONMENT).as_slice() {
            [only] => statement![", under ", frame.names.short_phrase(ENVIRONMENT, only)],
            _ => several.into(),
        }
    }

    /// The average at each value of an axis, ascending.
    pub fn by_value(&self, axis: AxisId) -> Vec<AtValue> {
        let parts = self.parts(axis).into_iter();
        parts
            .map(|(value, part)| AtValue {
                value,
                number: part.estimate().map_or(f64::NAN, |all| all.value),
            })
            .collect()
    }

    /// "By alpha it ranges from 16 for alpha 0.5 to 64 for alpha 0.05.": the axis, of the rows or
    /// the environment, along which the number changes most; `None` if it changes by less than
    /// `factor` along both.
    pub fn extremes(
        &self,
        frame: &Frame,
        subject: &str,
        factor: f64,
        written: impl Fn(f64) -> Statement,
    ) -> Option<Statement> {
        let spread = distinct_in_order([frame.row_axis(), ENVIRONMENT])
            .into_iter()
            .filter_map(|axis| self.spread(axis))
            .filter(|spread| spread.factor() >= factor)
            .reduce(|a, b| if b.factor() > a.factor() { b } else { a })?;
        let end = |end: &AtValue| {
            let value = frame.names.phrase(spread.axis, &end.value);
            statement![written(end.number), " for ", value]
        };
        Some(statement![
            format!(
                "By {} {subject} ranges from ",
                frame.names.name(spread.axis)
            ),
            end(&spread.least),
            " to ",
            end(&spread.most),
            "."
        ])
    }

    fn spread(&self, axis: AxisId) -> Option<Spread> {
        let mut groups = self.evidence().by_value(axis);
        groups.retain(|group| !group.number.is_nan());
        let least = groups
            .iter()
            .reduce(|a, b| if b.number < a.number { b } else { a })?;
        let most = groups
            .iter()
            .reduce(|a, b| if b.number > a.number { b } else { a })?;
        Some(Spread {
            axis,
            least: least.clone(),
            most: most.clone(),
        })
    }

    /// The first axis of cases with ratios on both sides of 1. Environments are a sample: they
    /// agree if the interval of their mean is on one side of 1.
    pub fn change_of_sign(&self, frame: &Frame) -> Option<SignChange> {
        let interval = self.estimate().and_then(|all| all.interval);
        let lights_agree = interval.is_some_and(|[lo, hi]| hi < 1.0 || lo > 1.0);
        let first = [frame.row_axis(), ENVIRONMENT];
        distinct_in_order(first.into_iter().chain(frame.swept(&[Part::Case])))
            .into_iter()
            .filter(|axis| *axis != ENVIRONMENT || !lights_agree)
            .map(|axis| SignChange {
                axis,
                ratios: self.by_value(axis),
            })
            .find(SignChange::has_both_sides)
    }

    /// The average in words; for ratios on both sides of 1 their range.
    pub fn cell(&self, frame: &Frame, words: &dyn Fn(&Estimate) -> String) -> Cell {
        let Some(all) = self.estimate() else {
            return Cell::Missing;
        };
        if self.pooled(frame).is_some() {
            Cell::quantity(words(&all))
        } else {
            Extent::from_values(self.items.iter().map(|(_, number)| *number)).into()
        }
    }

    /// A digest with one row per value of [`Frame::row_axis`], else of the first swept axis of
    /// cases, and the columns of [`by_light`].
    pub fn digest(&self, frame: &Frame, words: &dyn Fn(&Estimate) -> String) -> Table {
        let mut swept = frame.swept(&[Part::Case]);
        swept.retain(|axis| *axis != ENVIRONMENT);
        let row_axis = Some(frame.row_axis()).filter(|axis| frame.shape.is_swept(*axis));
        let Some(axis) = row_axis.or(swept.first().copied()) else {
            let row = DigestRow {
                head: Vec::new(),
                numbers: self.clone(),
            };
            return by_light(frame, &[], &[row], words);
        };
        let heads = frame.names.heads(&[axis]);
        let mut rows: Vec<DigestRow> = self
            .parts(axis)
            .into_iter()
            .map(|(value, numbers)| DigestRow {
                head: frame.names.head_of(axis, &value),
                numbers,
            })
            .collect();
        if rows.len() > 1 {
            rows.push(DigestRow {
                head: all_head(&heads),
                numbers: self.clone(),
            });
        }
        by_light(frame, &heads, &rows, words)
    }
}

impl SignChange {
    fn has_both_sides(&self) -> bool {
        self.ratios.iter().any(|at| at.number < 1.0 / (1.0 + SAME))
            && self.ratios.iter().any(|at| at.number > 1.0 + SAME)
    }
}

/// The first cells of the row over all, under these heads.
pub fn all_head(heads: &[&str]) -> Vec<Cell> {
    let blanks = heads.iter().skip(1).map(|_| Cell::Missing);
    std::iter::once(Cell::from(ALL)).chain(blanks).collect()
}

/// A dot at an average, with its name and words as a tip, and a whisker of its interval.
/// `position` places a number.
pub fn middle_marks(
    all: &Estimate,
    series: usize,
    name: &str,
    position: impl Fn(f64) -> [f64; 2],
    words: &dyn Fn(&Estimate) -> String,
) -> Vec<Mark> {
    let whisker = all
        .interval
        .map(|[lo, hi]| Mark::new(Form::Whisker(position(lo), position(hi)), series));
    let dot = middle_dot(all, series, name, position(all.value), words);
    std::iter::once(dot).chain(whisker).collect()
}

/// The dot of [`middle_marks`].
pub fn middle_dot(
    all: &Estimate,
    series: usize,
    name: &str,
    position: [f64; 2],
    words: &dyn Fn(&Estimate) -> String,
) -> Mark {
    let lights = count(all.n, "environment", AXES[ENVIRONMENT].plural);
    Mark::new(Form::Dot(position), series).tip(format!("{name}: {} · {lights}", words(all)))
}

/// "0.25 (0.50) and 0.5 (0.25)": values with ratios below 1, and above.
pub fn sides(frame: &Frame, change: &SignChange) -> [Statement; 2] {
    let (less, more): (Vec<&AtValue>, Vec<&AtValue>) =
        change.ratios.iter().partition(|at| at.number < 1.0);
    [less, more].map(|side| {
        let items = side.into_iter().map(|at| {
            let value = frame.names.short_phrase(change.axis, &at.value);
            statement![value, format!(" ({})", number(at.number))]
        });
        Statement::listed(items.collect())
    })
}

/// A row of [`by_light`]: its first cells, and its numbers.
pub struct DigestRow<'r, 'f> {
    pub head: Vec<Cell>,
    pub numbers: Numbers<'r, 'f>,
}

/// A digest with one row per group, one column per environment and one over all. If environments
/// are enough for an interval, their columns are replaced by their range.
pub fn by_light(
    frame: &Frame,
    names: &[&str],
    rows: &[DigestRow],
    words: &dyn Fn(&Estimate) -> String,
) -> Table {
    let lights = values(rows.iter().flat_map(|row| row.numbers.rows()), ENVIRONMENT);
    let evidence: Vec<Numbers> = rows.iter().map(|row| row.numbers.evidence()).collect();
    let counted = values(evidence.iter().flat_map(Numbers::rows), ENVIRONMENT);
    let uncounted: Vec<Value> = lights
        .iter()
        .filter(|light| !counted.contains(light))
        .cloned()
        .collect();
    let is_summed = rows.iter().any(|row| row.numbers.has_interval());
    let has_all = lights.len() > 1;
    let shown = if is_summed { &uncounted } else { &lights };

    let mut heads: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    for light in shown {
        let name = frame.names.short(ENVIRONMENT, light);
        if uncounted.contains(light) {
            heads.push(format!("{name} (formula)"));
        } else {
            heads.push(name);
        }
    }
    if has_all && is_summed {
        heads.push(count(counted.len(), "", AXES[ENVIRONMENT].plural));
    } else if has_all {
        heads.push(ALL.to_owned());
    }
    if is_summed {
        heads.push("their range".to_owned());
    }

    let mut table = Table::with_names(heads);
    for DigestRow { head, numbers } in rows {
        let mut cells = head.clone();
        for light in shown {
            cells.push(numbers.with_value(ENVIRONMENT, light).cell(frame, words));
        }
        if has_all {
            cells.push(match numbers.pooled(frame) {
                None if is_summed && numbers.is_ratio => Cell::from("mixed"),
                all => all.map(|all| Cell::quantity(words(&all))).into(),
            });
        }
        if is_summed {
            let ends = numbers.estimate().map(|all| all.ends);
            cells.push(
                ends.map(|ends| Cell::quantity(range_in_words(ends, words)))
                    .into(),
            );
        }
        table.row(cells);
    }
    table.without_empty()
}

/// "8.1 to 17", or one number if both ends read alike.
fn range_in_words(ends: [f64; 2], words: &dyn Fn(&Estimate) -> String) -> String {
    let [least, most] = ends.map(|end| {
        words(&Estimate {
            value: end,
            interval: None,
            prediction: None,
            n: 1,
            ends: [end; 2],
        })
    });
    if least == most {
        least
    } else {
        format!("{least} to {most}")
    }
}

/// Whether a light is a built-in formula.
pub fn is_formula(light: &Value) -> bool {
    light.to_string().starts_with(BUILTIN_PREFIX)
}

/// Distance of a sample count from the default, by ratio.
pub fn from_usual(samples: u32) -> f64 {
    (f64::from(samples) / f64::from((AXES[SAMPLES].default)().count()))
        .ln()
        .abs()
}

/// Ratios this close to 1 are on neither side of it.
const SAME: f64 = 0.05;
