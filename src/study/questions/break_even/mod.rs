//! How many samples per pixel does sampling need to beat a method without samples?
//!
//! In a case let e(N) be the error of a sampling method with N samples (geometric mean over point
//! sets) and f the error of the method without samples. The *break-even* is the smallest tried N
//! with e(M) < f for every tried M >= N: a win at one count and a loss at a larger one was luck.
//! The *crossing* is where log e over log N meets log f, interpolated between two tried counts. The
//! reference's noise adds to f and to the samples' error alike, so it moves no crossing.
//!
//! Every pair of methods has its answer, by alpha, model, F0 and each value of swept tables and
//! parameters: the median crossing over environments, rounded up to a tried count. Its interval is
//! rounded likewise, so it may cover more than 95 %. Counts that some case did not reach are
//! unknown: of curves up to 64 and up to 512 samples the largest tried count is 64. The scores are
//! the metric of the run and, if it has pictures, FLIP.

mod digest;
mod sentences;

pub(super) use digest::digest;

use super::by_lookups::{self, SURFACE};
use super::prelude::*;
use super::{FIXED, SAMPLED};
use crate::instrument::metrics::Space;
use crate::run::tables::DISPLAY_HEADLINE;
use crate::study::frame::curve::{Methods, Rivals, rivals};
use crate::study::table::Column;
use sentences::sentences;

pub(super) const METRIC: Column = column("metric", "The score of the errors.");
pub(super) const LO: Column = column(
    "break_even_lo",
    "Lower end of its 95 % interval over environments, rounded up to a tried count; empty if above \
     the largest one, or with fewer than six environments.",
);
pub(super) const HI: Column = column("break_even_hi", super::UPPER);
pub(super) const N: Column = column("n", "Number of environments.");

pub const QUESTION: Question = Question {
    name: "break-even",
    asks: "How many samples per pixel does sampling need to beat a method without samples?",
    columns: &[
        METRIC,
        FIXED,
        SAMPLED,
        column(
            "break_even",
            "Samples from which sampling errs less, median over environments; empty above all \
             tried.",
        ),
        LO,
        HI,
        N,
        column("largest_tried", "Largest sample count tried in every case."),
    ],
    lacks,
    answer,
    ..Question::PLAIN
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    lacks_counts(shape, SAMPLES, "axes.samples has fewer than two counts")
}

/// What a comparison over the counts of an axis lacks.
pub(super) fn lacks_counts(
    shape: &Shape,
    counts: AxisId,
    too_few: &'static str,
) -> Option<&'static str> {
    if !shape.methods().any(|method| method.uses_point_set) {
        Some("axes.method has no sampling method")
    } else if shape.methods().all(|method| method.uses_samples) {
        Some("axes.method has no method without samples")
    } else if !shape.is_swept(counts) {
        Some(too_few)
    } else {
        None
    }
}

/// The counts, ascending, between the least and the largest that every case tried.
pub(super) struct TriedCounts(Vec<u32>);

impl TriedCounts {
    fn new(cases: &[&Rivals]) -> Self {
        let mut least = 0;
        let mut largest = u32::MAX;
        for case in cases {
            let [from, to] = case.curve.count_ends();
            least = least.max(from);
            largest = largest.min(to);
        }
        let points = cases.iter().flat_map(|case| &case.curve.points);
        let counts = points
            .map(|point| point.count)
            .filter(|count| (least..=largest).contains(count));
        let mut counts = distinct_in_order(counts);
        counts.sort_unstable();
        Self(counts)
    }

    pub(super) fn largest(&self) -> Option<u32> {
        self.0.last().copied()
    }

    /// The next tried count; `None` above them.
    fn round_up(&self, n: f64) -> Option<u32> {
        self.0.iter().copied().find(|count| f64::from(*count) >= n)
    }

    /// "16"; "at most 4" if no fewer were tried; "more than 256".
    pub(super) fn number(&self, n: f64) -> Number {
        let least = self.0[0];
        match self.round_up(n) {
            None => Number::MoreThan(self.0[self.0.len() - 1].into()),
            Some(count) if count == least && least > 1 => Number::AtMost(least.into()),
            Some(count) => Number::Count(count.into()),
        }
    }
}

/// The comparison at each case's largest count, the median over environments; NaN if unknown.
pub(super) struct AtLargest {
    /// Error over the other method's.
    pub(super) ratio: f64,
    pub(super) lag_bias: f64,
    pub(super) flicker: f64,
}

/// The median of a pair under a condition.
pub(super) struct Pair {
    pub(super) metric: &'static str,
    /// On the axes of [`conditions`].
    pub(super) key: Key,
    pub(super) methods: Methods,
    pub(super) crossing: Estimate,
    /// Never empty.
    pub(super) tried: TriedCounts,
    pub(super) at_largest: AtLargest,
}

impl Pair {
    /// `None` if no count was tried in every case.
    fn new(frame: &Frame, methods: &Methods, key: Key, cases: &[&Rivals]) -> Option<Self> {
        let tried = TriedCounts::new(cases);
        tried.largest()?;
        let crossings: Vec<(Value, f64)> = cases
            .iter()
            .map(|case| {
                let light = case.fixed.point[ENVIRONMENT].clone();
                (light, crossing(case, &tried))
            })
            .collect();
        Some(Self {
            metric: frame.metric_name(),
            key,
            methods: methods.clone(),
            crossing: estimate(&crossings, Middle::Median)?,
            tried,
            at_largest: AtLargest {
                ratio: median_of(cases, last_ratio),
                lag_bias: median_of(cases, |case| Some(last_steadiness(case)?[0])),
                flicker: median_of(cases, |case| Some(last_steadiness(case)?[1])),
            },
        })
    }

    /// The crossing, rounded up to a tried count.
    pub(super) fn number(&self) -> Number {
        self.tried.number(self.crossing.value)
    }

    /// The 95 % interval; below six environments the range of all.
    fn interval(&self) -> Interval {
        let (coverage, ends) = match self.crossing.interval {
            Some(ends) => (Coverage::Confidence, ends),
            None => (Coverage::All(AXES[ENVIRONMENT].plural), self.crossing.ends),
        };
        Interval {
            extent: Extent {
                least: self.tried.number(ends[0]),
                most: self.tried.number(ends[1]),
            },
            coverage,
        }
    }

    /// "16 (95 % 8 to 32)".
    fn quantity(&self) -> Quantity {
        Quantity::new(self.number()).interval(Some(self.interval()))
    }

    /// "16 (95 % 8 to 32) at alpha 0.1, ggx".
    fn statement(&self, frame: &Frame, axes: &[AxisId]) -> Statement {
        let condition = frame.names.comma_phrases(axes, &self.key);
        statement![self.quantity(), " at ", condition]
    }

    /// The value under which the pair was compared, if the axis is one of the conditions.
    fn value(&self, axes: &[AxisId], axis: AxisId) -> Option<&Value> {
        let index = axes.iter().position(|known| *known == axis)?;
        Some(&self.key[index])
    }
}

/// The axes whose values have their own answers: the row axis, the surface, and parameters of
/// methods and tables.
pub(super) fn conditions(frame: &Frame) -> Vec<AxisId> {
    let mut parameters = frame.swept(&[Part::Method, Part::Parameter, Part::Table, Part::Count]);
    parameters.retain(|axis| ![METHOD, frame.curve_axis].contains(axis));
    let axes = std::iter::once(frame.row_axis())
        .chain(SURFACE)
        .chain(parameters);
    distinct_in_order(axes.filter(|axis| frame.shape.is_swept(*axis)))
}

/// The crossing, if rounding it up gives the break-even; else the break-even. Infinite above the
/// largest tried count.
fn crossing(case: &Rivals, tried: &TriedCounts) -> f64 {
    let points = &case.curve.points;
    let wins = points
        .iter()
        .rev()
        .take_while(|point| point.error < case.error)
        .count();
    let Some(after) = points.iter().rev().take(wins).next_back() else {
        return f64::INFINITY;
    };
    let count = f64::from(after.count);
    let Some(before) = points.iter().rev().nth(wins) else {
        return count;
    };
    let [x0, x1] = [before, after].map(|point| f64::from(point.count).ln());
    let [y0, y1] = [before, after].map(|point| (point.error / case.error).ln());
    let crossing = (x0 + y0 / (y0 - y1) * (x1 - x0)).exp();
    if tried.round_up(crossing) == Some(after.count) {
        crossing
    } else {
        count
    }
}

/// Pair by pair, each by condition, ascending.
pub(super) fn pairs(frame: &Frame) -> Vec<Pair> {
    let images = frame.images();
    let case_axes = frame.case_axes();
    let axes = conditions(frame);
    let condition = |case: &Rivals| condition(case, &case_axes, &axes);
    let mut all = rivals(frame, &images, &case_axes);
    all.retain(|case| case.curve.points.len() > 1);
    let mut pairs = Vec::new();
    for (methods, cases) in grouped(all, Rivals::methods) {
        // Formulas do not count if the pair has enough measured environments.
        let numbers = Numbers::new(cases.iter().map(|case| (case.fixed, 0.0)), Middle::Median);
        let mut keys = distinct_in_order(cases.iter().map(condition));
        keys.sort_by_key(|key| order(frame, &axes, key));
        for key in keys {
            let cases: Vec<&Rivals> = cases
                .iter()
                .filter(|case| condition(case) == key && numbers.counts(case.fixed))
                .collect();
            pairs.extend(Pair::new(frame, &methods, key, &cases));
        }
    }
    pairs
}

/// The values of a case on the axes of [`conditions`].
fn condition(case: &Rivals, case_axes: &[AxisId], axes: &[AxisId]) -> Key {
    let index = |axis: &AxisId| case_axes.iter().position(|known| known == axis);
    axes.iter()
        .filter_map(index)
        .map(|index| case.key[index].clone())
        .collect()
}

/// Sorts keys by the ascending values of the experiment.
fn order(frame: &Frame, axes: &[AxisId], key: &Key) -> Vec<Option<usize>> {
    key.iter()
        .zip(axes)
        .map(|(value, axis)| {
            ascending(frame.shape.values[*axis].clone())
                .iter()
                .position(|step| step == value)
        })
        .collect()
}

/// The ratio of errors at the largest count of a case.
fn last_ratio(case: &Rivals) -> Option<f64> {
    Some(case.curve.points.last()?.error / case.error)
}

/// Lag bias and flicker of the first image at the largest count of a case.
fn last_steadiness(case: &Rivals) -> Option<[f64; 2]> {
    case.curve.points.last()?.rows[0].cell.steadiness
}

/// The median of a number over environments; NaN if a case has none.
fn median_of(cases: &[&Rivals], number: impl Fn(&Rivals) -> Option<f64>) -> f64 {
    let by_light: Option<Vec<(Value, f64)>> = cases
        .iter()
        .map(|case| Some((case.fixed.point[ENVIRONMENT].clone(), number(case)?)))
        .collect();
    by_light
        .and_then(|by_light| estimate(&by_light, Middle::Median))
        .map_or(f64::NAN, |all| all.value)
}

fn answer(frame: &Frame) -> Option<Finding> {
    let has_flip =
        frame.is_first && frame.metric.space == Space::Linear && frame.run.has_pictures();
    let of_pictures = has_flip.then(|| frame.like(frame.run, DISPLAY_HEADLINE));
    let all: Vec<Pair> = std::iter::once(frame)
        .chain(&of_pictures)
        .flat_map(pairs)
        .collect();
    let axes = conditions(frame);
    Some(Finding {
        sentences: sentences(frame, &axes, &all)?,
        table: table(frame, &axes, QUESTION.columns, &all, |_| Vec::new()),
        digest: Some(digest(frame, &axes, &all, "samples per pixel")),
        figure: by_lookups::figure(of_pictures.as_ref().unwrap_or(frame)),
    })
}

/// One row per pair and condition, and `more` cells of each.
pub(super) fn table(
    frame: &Frame,
    axes: &[AxisId],
    columns: &[Column],
    all: &[Pair],
    more: impl Fn(&Pair) -> Vec<Cell>,
) -> Table {
    let table_axes = distinct_in_order(SURFACE.into_iter().chain(axes.iter().copied()));
    let mut table = Table::new(&table_axes, columns);
    for pair in all {
        let value = |axis: &AxisId| match pair.value(axes, *axis) {
            Some(value) => value.clone(),
            None => frame.shape.values[*axis]
                .first()
                .cloned()
                .unwrap_or(Value::Unset),
        };
        let key: Key = table_axes.iter().map(value).collect();
        let count = |n: f64| pair.tried.round_up(n).map(f64::from);
        let [lo, hi] = match pair.crossing.interval {
            Some(ends) => ends.map(count),
            None => [None; 2],
        };
        let mut row = axis_cells(&table_axes, &key);
        row.extend(cells![
            pair.metric,
            &Variant::new(&pair.methods.fixed),
            &Variant::new(&pair.methods.sampled),
            count(pair.crossing.value),
            lo,
            hi,
            pair.crossing.n,
            pair.tried.largest()
        ]);
        row.extend(more(pair));
        table.row(row);
    }
    table
}

/// The pair with the least crossing, and the one with the largest.
pub(super) struct Ends<'p> {
    pub(super) least: &'p Pair,
    pub(super) most: &'p Pair,
}

impl<'p> Ends<'p> {
    pub(super) fn find(pairs: &[&'p Pair]) -> Option<Self> {
        let pairs = || pairs.iter().copied();
        Some(Self {
            least: pairs().reduce(|a, b| {
                if b.crossing.value < a.crossing.value {
                    b
                } else {
                    a
                }
            })?,
            most: pairs().reduce(|a, b| {
                if b.crossing.value > a.crossing.value {
                    b
                } else {
                    a
                }
            })?,
        })
    }

    pub(super) fn extent(&self) -> Extent {
        Extent {
            least: self.least.number(),
            most: self.most.number(),
        }
    }
}
