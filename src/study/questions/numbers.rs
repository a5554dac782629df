//! A number of each image of a group, and how it depends on the axes: digests, extremes, changes of
//! sign.

use super::words::{count, listed, number, range, range_words, scope_sentence};
use crate::base::csv::Cell;
use crate::draw::figure::{Mark, Shape as Form};
use crate::experiment::axis::{AXES, AxisId, ENVIRONMENT, Part, SAMPLES};
use crate::experiment::value::Value;
use crate::instrument::environment::BUILTIN_PREFIX;
use crate::study::frame::estimate::{CLUSTERS_MIN, Estimate, Middle, estimate};
use crate::study::frame::{Frame, Row, distinct_in_order, values};
use crate::study::table::Table;

/// Name of the last row and column.
pub const ALL: &str = "all";

/// Groups by their value on an axis, ascending, each with its number.
pub type Along = Vec<(Value, f64)>;

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
    pub fn weighs(&self, row: &Row) -> bool {
        self.evidence()
            .values(ENVIRONMENT)
            .contains(&row.point[ENVIRONMENT])
    }

    /// Whether environments are enough for an interval.
    pub fn is_summed(&self) -> bool {
        self.estimate().is_some_and(|all| all.interval.is_some())
    }

    /// As [`middle_marks`].
    pub fn marks(
        &self,
        series: usize,
        at: impl Fn(f64) -> [f64; 2],
        (name, words): (&str, &dyn Fn(&Estimate) -> String),
    ) -> Vec<Mark> {
        let Some(all) = self.estimate() else {
            return Vec::new();
        };
        middle_marks(&all, series, at, (name, words))
    }

    /// The numbers under measured environments, if these are enough for an interval: formulas then
    /// do not count.
    pub fn evidence(&self) -> Self {
        let measured = self.measured();
        let are_enough = measured >= CLUSTERS_MIN || (self.is_part && measured > 0);
        let is_kept = |row: &Row| !are_enough || !is_formula(&row.point[ENVIRONMENT]);
        Self {
            items: self
                .items
                .iter()
                .copied()
                .filter(|(row, _)| is_kept(row))
                .collect(),
            ..*self
        }
    }

    fn measured(&self) -> usize {
        self.values(ENVIRONMENT)
            .iter()
            .filter(|light| !is_formula(light))
            .count()
    }

    /// Number of environments with a ratio below 1, and of all.
    pub fn wins(&self) -> [usize; 2] {
        let of_each = self.evidence().along(ENVIRONMENT);
        [
            of_each.iter().filter(|(_, ratio)| *ratio < 1.0).count(),
            of_each.len(),
        ]
    }

    /// Number of images with a ratio below 1, and of all.
    pub fn less(&self) -> [usize; 2] {
        [
            self.items.iter().filter(|(_, ratio)| *ratio < 1.0).count(),
            self.items.len(),
        ]
    }

    /// The images with this value on an axis.
    pub fn at(&self, of: AxisId, value: &Value) -> Self {
        self.part(|place| self.items[place].0.point[of] == *value)
    }

    pub fn part(&self, is_own: impl Fn(usize) -> bool) -> Self {
        let own = self
            .items
            .iter()
            .copied()
            .enumerate()
            .filter(|(place, _)| is_own(*place))
            .map(|(_, item)| item);
        Self {
            items: own.collect(),
            is_part: self.is_part || self.measured() >= CLUSTERS_MIN,
            ..*self
        }
    }

    pub fn items(&self) -> &[(&'r Row<'f>, f64)] {
        &self.items
    }

    pub fn rows(&self) -> impl Iterator<Item = &'r Row<'f>> {
        self.items.iter().map(|(row, _)| *row)
    }

    pub fn values(&self, of: AxisId) -> Vec<Value> {
        values(self.rows(), of)
    }

    /// The average with its interval over environments.
    pub fn estimate(&self) -> Option<Estimate> {
        let evidence = self.evidence();
        let values = evidence
            .items
            .iter()
            .map(|(row, number)| (row.point[ENVIRONMENT].clone(), *number));
        estimate(&values.collect::<Vec<_>>(), self.middle)
    }

    /// The average, unless ratios are on both sides of 1.
    pub fn pooled(&self, frame: &Frame) -> Option<Estimate> {
        self.estimate()
            .filter(|_| !self.is_ratio || self.change_of_sign(frame).is_none())
    }

    /// " Over 10 environments, 3 BRDF models, 5 alphas."
    pub fn scope(&self, frame: &Frame) -> String {
        scope_sentence(frame, &self.evidence().rows().collect::<Vec<_>>())
    }

    /// ", under sky" for one environment, else `several`.
    pub fn place(&self, frame: &Frame, several: &str) -> String {
        match self.values(ENVIRONMENT).as_slice() {
            [only] => format!(", under {}", frame.names.short(ENVIRONMENT, only)),
            _ => several.to_owned(),
        }
    }

    /// The average at each value of an axis.
    pub fn along(&self, of: AxisId) -> Along {
        self.values(of)
            .into_iter()
            .map(|value| {
                (
                    value.clone(),
                    self.at(of, &value)
                        .estimate()
                        .map_or(f64::NAN, |all| all.value),
                )
            })
            .collect()
    }

    /// " By alpha it ranges from 16 for alpha 0.5 to 64 for alpha 0.05.": the axis, of the rows or
    /// the environment, along which the number changes most; empty if it changes by less than
    /// `factor` along both.
    pub fn extremes(
        &self,
        frame: &Frame,
        subject: &str,
        factor: f64,
        words: impl Fn(f64) -> String,
    ) -> String {
        let of_axis = |of: AxisId| {
            let mut groups = self.evidence().along(of);
            groups.retain(|(_, number)| !number.is_nan());
            let least = groups
                .iter()
                .cloned()
                .reduce(|a, b| if b.1 < a.1 { b } else { a })?;
            let most = groups
                .into_iter()
                .reduce(|a, b| if b.1 > a.1 { b } else { a })?;
            Some((most.1 / least.1, of, [least, most]))
        };
        let along = distinct_in_order([frame.row_axis(), ENVIRONMENT]);
        let found = along
            .into_iter()
            .filter_map(of_axis)
            .filter(|(change, ..)| *change >= factor);
        let Some((_, of, ends)) = found.reduce(|a, b| if b.0 > a.0 { b } else { a }) else {
            return String::new();
        };
        let [least, most] = ends.map(|(value, number)| {
            format!("{} for {}", words(number), frame.names.one(of, &value))
        });
        format!(
            " By {} {subject} ranges from {least} to {most}.",
            frame.names.name(of)
        )
    }

    /// The first axis of cases with ratios on both sides of 1, and these ratios. Environments are a
    /// sample: they agree if the interval of their mean is on one side of 1.
    pub fn change_of_sign(&self, frame: &Frame) -> Option<(AxisId, Along)> {
        let (below, above) = (1.0 / (1.0 + SAME), 1.0 + SAME);
        let interval = self.estimate().and_then(|all| all.interval);
        let agree = interval.is_some_and(|[lo, hi]| hi < 1.0 || lo > 1.0);
        let first = distinct_in_order([frame.row_axis(), ENVIRONMENT]);
        let others = frame
            .swept(&[Part::Case])
            .into_iter()
            .filter(|of| !first.contains(of));
        let along = first
            .iter()
            .copied()
            .chain(others)
            .filter(|of| *of != ENVIRONMENT || !agree);
        along.map(|of| (of, self.along(of))).find(|(_, groups)| {
            groups.iter().any(|(_, ratio)| *ratio < below)
                && groups.iter().any(|(_, ratio)| *ratio > above)
        })
    }

    /// The average in words; for ratios on both sides of 1 their range.
    pub fn cell(&self, frame: &Frame, words: &dyn Fn(&Estimate) -> String) -> Cell {
        let is_pooled = self.pooled(frame).is_some();
        let both = || range(self.items.iter().map(|(_, number)| *number));
        self.estimate()
            .map(|all| if is_pooled { words(&all) } else { both() })
            .into()
    }

    /// A digest with one row per value of [`Frame::row_axis`], else of the first swept axis of
    /// cases, and the columns of [`by_light`].
    pub fn digest(&self, frame: &Frame, words: &dyn Fn(&Estimate) -> String) -> Table {
        let mut swept = frame.swept(&[Part::Case]);
        swept.retain(|of| *of != ENVIRONMENT);
        let row_axis = Some(frame.row_axis()).filter(|axis| frame.shape.is_swept(*axis));
        let Some(of) = row_axis.or(swept.first().copied()) else {
            return by_light(frame, &[], &[(Vec::new(), self.clone())], words);
        };
        let (values, heads) = (self.values(of), frame.names.heads(&[of]));
        let row = |value: &Value| (frame.names.head_of(of, value), self.at(of, value));
        let mut rows: Vec<(Vec<Cell>, Self)> = values.iter().map(row).collect();
        rows.extend((values.len() > 1).then(|| (all_head(&heads), self.clone())));
        by_light(frame, &heads, &rows, words)
    }
}

/// The first cells of the row over all, under these heads.
pub fn all_head(heads: &[&str]) -> Vec<Cell> {
    let blanks = heads.iter().skip(1).map(|_| Cell::Missing);
    std::iter::once(Cell::from(ALL)).chain(blanks).collect()
}

/// A dot at an average, with its name and words, and a whisker of its interval. `at` places a
/// number.
pub fn middle_marks(
    all: &Estimate,
    series: usize,
    at: impl Fn(f64) -> [f64; 2],
    (name, words): (&str, &dyn Fn(&Estimate) -> String),
) -> Vec<Mark> {
    let lights = count(all.n, "environment", AXES[ENVIRONMENT].plural);
    let whisker = all
        .interval
        .map(|[lo, hi]| Mark::new(Form::Whisker(at(lo), at(hi)), series));
    let dot = Mark::new(Form::Dot(at(all.value)), series)
        .tip(format!("{name}: {} · {lights}", words(all)));
    std::iter::once(dot).chain(whisker).collect()
}

/// "0.25 (0.50) and 0.5 (0.25)": values with ratios below 1, and above.
pub fn sides(frame: &Frame, of: AxisId, groups: &Along) -> [String; 2] {
    let (less, more): (Vec<_>, Vec<_>) = groups.iter().partition(|(_, ratio)| *ratio < 1.0);
    let words =
        |(at, ratio): &(Value, f64)| format!("{} ({})", frame.names.short(of, at), number(*ratio));
    [less, more].map(|own| listed(&own.into_iter().map(words).collect::<Vec<_>>()))
}

/// A digest with one row per group, one column per environment and one over all. If environments
/// are enough for an interval, their columns are replaced by their range.
pub fn by_light(
    frame: &Frame,
    names: &[&str],
    rows: &[(Vec<Cell>, Numbers)],
    words: &dyn Fn(&Estimate) -> String,
) -> Table {
    let of = |groups: &[Numbers]| values(groups.iter().flat_map(|own| own.rows()), ENVIRONMENT);
    let lights = of(&rows.iter().map(|(_, own)| own.clone()).collect::<Vec<_>>());
    let evidence = of(&rows
        .iter()
        .map(|(_, own)| own.evidence())
        .collect::<Vec<_>>());
    let beside: Vec<Value> = lights
        .iter()
        .filter(|light| !evidence.contains(light))
        .cloned()
        .collect();
    let is_summed = rows.iter().any(|(_, own)| own.is_summed());
    let shown = if is_summed { &beside } else { &lights };
    let has_all = lights.len() > 1;
    let heads = shown.iter().map(|light| match beside.contains(light) {
        true => format!("{} (formula)", frame.names.short(ENVIRONMENT, light)),
        false => frame.names.short(ENVIRONMENT, light),
    });
    let all = if is_summed {
        count(evidence.len(), "", AXES[ENVIRONMENT].plural)
    } else {
        ALL.to_owned()
    };
    let names = names
        .iter()
        .map(|name| name.to_string())
        .chain(heads)
        .chain(has_all.then_some(all));
    let mut table = Table::with_names(names.chain(is_summed.then(|| "their range".to_owned())));
    let plain = |end: f64| {
        words(&Estimate {
            value: end,
            interval: None,
            prediction: None,
            n: 1,
            ends: [end; 2],
        })
    };
    for (head, own) in rows {
        let cells = shown
            .iter()
            .map(|light| own.at(ENVIRONMENT, light).cell(frame, words));
        let all = has_all.then(|| match own.pooled(frame) {
            None if is_summed && own.is_ratio => Cell::from("mixed"),
            all => all.as_ref().map(words).into(),
        });
        let range = is_summed.then(|| {
            own.estimate()
                .map(|all| range_words(all.ends, plain))
                .into()
        });
        table.row(
            head.iter()
                .cloned()
                .chain(cells)
                .chain(all)
                .chain(range)
                .collect(),
        );
    }
    table.without_empty()
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
