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

use super::by_lookups::{self, SURFACE};
use super::prelude::*;
use super::{FIXED, SAMPLED};
use crate::instrument::metrics::Space;
use crate::run::tables::DISPLAY_HEADLINE;
use crate::study::frame::curve::{Beside, beside, without_samples};
use crate::study::table::Column;

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
    match () {
        () if !shape.methods().any(|method| method.uses_point_set) => {
            Some("axes.method has no sampling method")
        }
        () if shape.methods().all(|method| method.uses_samples) => {
            Some("axes.method has no method without samples")
        }
        () if !shape.is_swept(counts) => Some(too_few),
        () => None,
    }
}

/// The median of a pair under a condition.
pub(super) struct Pair {
    pub(super) metric: &'static str,
    /// On the axes of [`conditions`].
    pub(super) key: Key,
    pub(super) sampled: String,
    pub(super) fixed: String,
    pub(super) crossing: Estimate,
    pub(super) tried: Vec<u32>,
    /// Error over the other method's, lag bias and flicker at each case's largest count; NaN if
    /// unknown.
    pub(super) last: [f64; 3],
}

impl Pair {
    /// "16 (95 % 8 to 32)"; below six environments their range. Nothing in brackets if both ends
    /// are one count.
    fn words(&self) -> String {
        let words = |n: f64| counted(n, &self.tried);
        let (which, ends) = match self.crossing.interval {
            Some(ends) => ("95 %", ends),
            None => (AXES[ENVIRONMENT].plural, self.crossing.ends),
        };
        let [lo, hi] = ends.map(words);
        words(self.crossing.value)
            + &if lo == hi {
                String::new()
            } else {
                format!(" ({which} {lo} to {hi})")
            }
    }
}

/// The axes whose values have their own answers: the row axis, the surface, and parameters of
/// methods and tables.
pub(super) fn conditions(frame: &Frame) -> Vec<AxisId> {
    let ways = frame
        .swept(&[Part::Method, Part::Parameter, Part::Table, Part::Count])
        .into_iter();
    let ways = ways.filter(|of| ![METHOD, frame.along].contains(of));
    let all = std::iter::once(frame.row_axis()).chain(SURFACE).chain(ways);
    distinct_in_order(all.filter(|of| frame.shape.is_swept(*of)))
}

/// The counts, ascending, between the least and the largest that every case tried.
fn tried(cases: &[&Beside]) -> Vec<u32> {
    let ends = cases.iter().map(|case| case.curve.tried());
    let [least, largest] = ends.fold([0, u32::MAX], |[a, b], [from, to]| [a.max(from), b.min(to)]);
    let all = cases
        .iter()
        .flat_map(|case| &case.curve.points)
        .map(|point| point.count);
    let mut counts = distinct_in_order(all.filter(|count| (least..=largest).contains(count)));
    counts.sort_unstable();
    counts
}

/// The crossing, if rounding it up gives the break-even; else the break-even. Infinite above the
/// largest tried count.
fn crossing(case: &Beside, tried: &[u32]) -> f64 {
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
    if up(crossing, tried) == count {
        crossing
    } else {
        count
    }
}

/// Pair by pair, each by condition, ascending.
pub(super) fn pairs(frame: &Frame) -> Vec<Pair> {
    let (images, axes, of) = (frame.images(), frame.case_axes(), conditions(frame));
    let all = beside(frame, &images, &axes)
        .into_iter()
        .filter(|case| case.curve.points.len() > 1);
    let condition = |case: &Beside| -> Key {
        let place = |of: &AxisId| axes.iter().position(|axis| axis == of);
        of.iter()
            .filter_map(|of| Some(case.key[place(of)?].clone()))
            .collect()
    };
    let steps: Vec<Vec<Value>> = of
        .iter()
        .map(|of| ascending(frame.shape.values[*of].clone()))
        .collect();
    let order = |key: &Key| -> Vec<Option<usize>> {
        key.iter()
            .zip(&steps)
            .map(|(value, steps)| steps.iter().position(|step| step == value))
            .collect()
    };
    let mut found = Vec::new();
    for ([sampled, fixed], cases) in grouped(all, |case| case.names()) {
        // Formulas do not count if the pair has enough measured environments.
        let numbers = Numbers::new(cases.iter().map(|case| (case.fixed, 0.0)), Middle::Median);
        let mut keys = distinct_in_order(cases.iter().map(condition));
        keys.sort_by_key(order);
        for key in keys {
            let own = cases
                .iter()
                .filter(|case| condition(case) == key && numbers.weighs(case.fixed));
            let own: Vec<&Beside> = own.collect();
            let tried = tried(&own);
            let crossings = own.iter().map(|case| {
                (
                    case.fixed.point[ENVIRONMENT].clone(),
                    crossing(case, &tried),
                )
            });
            let Some(crossing) = estimate(&crossings.collect::<Vec<_>>(), Middle::Median) else {
                continue;
            };
            let (metric, sampled, fixed) = (frame.metric_name(), sampled.clone(), fixed.clone());
            let last = [0, 1, 2].map(|place| median_of(&own, |case| last(case, place)));
            found.extend((!tried.is_empty()).then_some(Pair {
                metric,
                key,
                sampled,
                fixed,
                crossing,
                tried,
                last,
            }));
        }
    }
    found
}

/// Ratio of errors, lag bias and flicker of the first image at the largest count of a case.
fn last(case: &Beside, place: usize) -> Option<f64> {
    let point = case.curve.points.last()?;
    if place == 0 {
        Some(point.error / case.error)
    } else {
        Some(point.rows[0].cell.steadiness?[place - 1])
    }
}

/// The median of a number over environments; NaN if a case has none.
fn median_of(cases: &[&Beside], number: impl Fn(&Beside) -> Option<f64>) -> f64 {
    let all = cases
        .iter()
        .map(|case| Some((case.fixed.point[ENVIRONMENT].clone(), number(case)?)));
    let all = all
        .collect::<Option<Vec<_>>>()
        .and_then(|all| estimate(&all, Middle::Median));
    all.map_or(f64::NAN, |all| all.value)
}

fn answer(frame: &Frame) -> Option<Finding> {
    let has_flip = frame.leads && frame.metric.space == Space::Linear && frame.run.has_pictures();
    let of_pictures = has_flip.then(|| frame.like(frame.run, DISPLAY_HEADLINE));
    let all: Vec<Pair> = std::iter::once(frame)
        .chain(&of_pictures)
        .flat_map(pairs)
        .collect();
    let axes = conditions(frame);
    let table = table(frame, &axes, QUESTION.columns, &all, |_| Vec::new());
    let figure = by_lookups::figure(of_pictures.as_ref().unwrap_or(frame));
    Some(Finding {
        sentence: sentence(frame, &axes, &all)?,
        digest: Some(digest(frame, &axes, &all, "samples per pixel")),
        table,
        figure,
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
    let of = distinct_in_order(SURFACE.into_iter().chain(axes.iter().copied()));
    let mut table = Table::new(&of, columns);
    for own in all {
        let value = |of: &AxisId| match axes.iter().position(|axis| axis == of) {
            Some(place) => own.key[place].clone(),
            None => frame.shape.values[*of]
                .first()
                .cloned()
                .unwrap_or(Value::Unset),
        };
        let count = |n: f64| Some(up(n, &own.tried)).filter(|n| n.is_finite());
        let [lo, hi] = own
            .crossing
            .interval
            .map_or([None; 2], |ends| ends.map(count));
        let head = cells![own.metric, own.fixed.as_str(), own.sampled.as_str()];
        let numbers = cells![
            count(own.crossing.value),
            lo,
            hi,
            own.crossing.n,
            own.tried.last().copied()
        ];
        let key: Key = of.iter().map(value).collect();
        table.row([axis_cells(&of, &key), head, numbers, more(own)].concat());
    }
    table
}

/// The next tried count; infinity above them.
pub(super) fn up(n: f64, tried: &[u32]) -> f64 {
    tried
        .iter()
        .map(|count| f64::from(*count))
        .find(|count| *count >= n)
        .unwrap_or(f64::INFINITY)
}

/// "16"; "at most 4" if no fewer were tried; "more than 256".
pub(super) fn counted(n: f64, tried: &[u32]) -> String {
    let (least, largest) = (tried[0], tried[tried.len() - 1]);
    match up(n, tried) {
        n if n.is_infinite() => format!("more than {largest}"),
        n if n == f64::from(least) && least > 1 => format!("at most {least}"),
        n => n.to_string(),
    }
}

/// The least and the largest of these medians.
pub(super) fn ends<'p>(own: &[&'p Pair]) -> Option<[&'p Pair; 2]> {
    let least = own.iter().copied().reduce(|a, b| {
        if b.crossing.value < a.crossing.value {
            b
        } else {
            a
        }
    })?;
    let most = own.iter().copied().reduce(|a, b| {
        if b.crossing.value > a.crossing.value {
            b
        } else {
            a
        }
    })?;
    Some([least, most])
}

/// The range of the first pair, by each metric. Then the places of its ends, or the ranges against
/// the method without samples that errs least.
fn sentence(frame: &Frame, axes: &[AxisId], all: &[Pair]) -> Option<String> {
    let images = frame.images();
    let fixed = without_samples(&images);
    let mean = |own: &[&Row]| {
        geometric_mean(
            &own.iter()
                .filter_map(|row| frame.error(row))
                .collect::<Vec<_>>(),
        )
    };
    let by_method = grouped(fixed.iter().copied(), |row| row.text(METHOD));
    let (best, _) = by_method
        .iter()
        .min_by(|a, b| mean(&a.1).total_cmp(&mean(&b.1)))?;
    let first = all.first()?;
    let is_like = |own: &&Pair| {
        own.sampled == first.sampled && own.fixed == first.fixed && own.metric == first.metric
    };
    let own: Vec<&Pair> = all.iter().filter(is_like).collect();
    let is_one = own.len() == 1;
    // "**8 to 16 samples per pixel** to beat `split-sum` in `relmse` and 4 in `flip`".
    let against = |fixed: &str, unit: &str, beat: &str| {
        let own = all
            .iter()
            .filter(|own| own.sampled == first.sampled && own.fixed == fixed);
        let ranges = grouped(own, |own| own.metric)
            .into_iter()
            .enumerate()
            .filter_map(|(place, (metric, own))| {
                let range = range_words(ends(&own)?.map(|own| own.crossing.value), |n| {
                    counted(n, &own[0].tried)
                });
                let unit = if range == "1" {
                    unit.trim_end_matches('s').to_owned()
                } else {
                    unit.to_owned()
                };
                let interval = if is_one {
                    own[0].words().split_off(range.len())
                } else {
                    String::new()
                };
                Some(match place {
                    0 => format!("**{range}{unit}**{interval}{beat} in `{metric}`"),
                    _ => format!("{range}{interval} in `{metric}`"),
                })
            });
        ranges.collect::<Vec<_>>().join(" and ")
    };
    let [least, most] = ends(&own)?;
    let at = |own: &Pair| {
        format!(
            "{} at {}",
            own.words(),
            frame.names.label(axes, &own.key).replace(" · ", ", ")
        )
    };
    let more = match () {
        () if *best != first.fixed => {
            format!(
                " To beat `{best}`, which errs least, it needs {}.",
                against(best, "", "")
            )
        }
        () if counted(least.crossing.value, &least.tried)
            == counted(most.crossing.value, &most.tried) =>
        {
            String::new()
        }
        () => format!(" Fewest: {}; most: {}.", at(least), at(most)),
    };
    let needs = against(
        &first.fixed,
        " samples per pixel",
        &format!(" to beat `{}`", first.fixed),
    );
    let (place, scope) = match first.crossing.n {
        1 => (
            format!(
                ", under {}",
                frame
                    .names
                    .short(ENVIRONMENT, &fixed.first()?.point[ENVIRONMENT])
            ),
            String::new(),
        ),
        n => (
            String::new(),
            format!(" Medians over {n} {}.", AXES[ENVIRONMENT].plural),
        ),
    };
    Some(format!(
        "`{}` needs {needs}{place}.{more}{scope}",
        first.sampled
    ))
}

/// One row per metric, condition and pair, one column per value of [`Frame::row_axis`], else one of
/// what is `counted`.
pub(super) fn digest(frame: &Frame, axes: &[AxisId], all: &[Pair], counted: &str) -> Table {
    let of = frame.row_axis();
    let others: Vec<usize> = (0..axes.len()).filter(|place| axes[*place] != of).collect();
    let width = |own: &Pair| {
        axes.iter()
            .position(|axis| *axis == of)
            .map(|place| own.key[place].clone())
    };
    let widths = ascending(distinct_in_order(all.iter().filter_map(width)));
    let heads = widths.iter().map(|width| frame.names.heading(of, width));
    let heads: Vec<String> = if widths.is_empty() {
        vec![counted.to_owned()]
    } else {
        heads.collect()
    };
    let names = others.iter().map(|place| frame.names.name(axes[*place]));
    let names = std::iter::once("metric")
        .chain(names)
        .chain(["without samples", "sampling"]);
    let mut table = Table::with_names(names.map(str::to_owned).chain(heads));
    let rest = |own: &Pair| -> Key { others.iter().map(|place| own.key[*place].clone()).collect() };
    let blocks = grouped(all, |own| (own.metric, rest(own)));
    for ((metric, rest), own) in blocks {
        for ((fixed, sampled), own) in grouped(own, |own| (own.fixed.clone(), own.sampled.clone()))
        {
            let rest = others
                .iter()
                .zip(&rest)
                .map(|(place, value)| Cell::from(frame.names.short(axes[*place], value)));
            let words = |own: Option<&&Pair>| Cell::from(own.map(|own| own.words()));
            let cells = widths
                .iter()
                .map(|at| words(own.iter().find(|own| width(own).as_ref() == Some(at))));
            let only = widths.is_empty().then(|| words(own.first()));
            let head = cells![metric]
                .into_iter()
                .chain(rest)
                .chain(cells![fixed, sampled]);
            table.row(head.chain(cells).chain(only).collect());
        }
    }
    table
}
