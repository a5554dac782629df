//! How many samples per pixel does sampling need to beat a method without samples?
//!
//! In a case let e(N) be the error of a sampling method with N samples (geometric mean over point sets) and f the error of the method without
//! samples. The *break-even* is the smallest tried N with e(M) < f for every tried M >= N: a win at one count and a loss at a larger one was
//! luck. The *crossing* is where log e over log N meets log f, interpolated between two tried counts.
//!
//! At grazing views the split sum errs most, so that few samples beat it: on the scene `design` each band of n·v has its own answer, by the
//! mean of its bins. Models and alphas also differ (ggx 256 where beckmann needs 8), so each has its own answer, as has each value of swept
//! tables and parameters: the median crossing over environments, rounded up to a tried count, with "above the largest tried count" last. Its
//! interval is rounded likewise, so it may cover more than 95 %.

use super::prelude::*;
use super::{FIXED, SAMPLED};
use crate::study::finished::Finished;
use crate::study::frame::curve::{Beside, beside};

pub const QUESTION: Question = Question {
    name: "break-even",
    asks: "How many samples per pixel does sampling need to beat a method without samples?",
    columns: &[
        SEEN_FROM,
        SEEN_TO,
        SAMPLED,
        FIXED,
        column("break_even", "Smallest tried count from which sampling errs less; empty above the largest tried."),
        column("largest_tried", "Largest tried sample count."),
        column("crossing", "Sample count at which both errors are equal, interpolated; empty if they never are."),
        column("fixed_error", "Error of the method without samples, in the metric of the question."),
        column("is_resolved", "1 if both errors at the break-even are resolved against the reference's noise, else 0."),
    ],
    lacks,
    answer,
    ..Question::PLAIN
};

pub(super) fn lacks(shape: &Shape) -> Option<&'static str> {
    match () {
        () if !shape.methods().any(|method| method.uses_samples) => Some("axes.method has no sampling method"),
        () if shape.methods().all(|method| method.uses_samples) => Some("axes.method has no method without samples"),
        () if !shape.is_swept(SAMPLES) => Some("axes.samples has fewer than two counts"),
        () => None,
    }
}

/// A case of two methods.
pub(super) struct Case<'r, 'f> {
    pub of: Beside<'r, 'f>,
    /// `None`: above the largest tried count.
    pub break_even: Option<u32>,
}

impl Case<'_, '_> {
    /// Log-log interpolation on the segment that ends at the break-even.
    pub fn crossing(&self) -> Option<f64> {
        let points = &self.of.curve.points;
        let index = points.iter().position(|point| Some(point.samples) == self.break_even)?;
        let (before, after) = (points.get(index.checked_sub(1)?)?, &points[index]);
        let [x0, x1] = [before, after].map(|point| f64::from(point.samples).ln());
        let [y0, y1] = [before, after].map(|point| (point.error / self.of.error).ln());
        Some((x0 + y0 / (y0 - y1) * (x1 - x0)).exp()).filter(|n| n.is_finite())
    }

    /// The crossing, if rounding it up gives the break-even; else the break-even. Infinite above the largest tried count.
    pub fn number(&self, tried: &[u32]) -> f64 {
        let Some(count) = self.break_even.map(f64::from) else { return f64::INFINITY };
        self.crossing().filter(|n| up(*n, tried) == count).unwrap_or(count)
    }

    /// Value on an axis, of the method that uses it.
    fn value(&self, axis: usize) -> Value {
        let [fixed, sampled] = [self.of.fixed, self.of.curve.first()].map(|row| &row.point[axis]);
        if *fixed == Value::Unset { sampled } else { fixed }.clone()
    }

    fn is_resolved(&self, frame: &Frame) -> bool {
        let at = self.break_even.unwrap_or(self.of.curve.tried()[1]);
        let point = self.of.curve.points.iter().find(|point| point.samples == at);
        frame.is_resolved(self.of.fixed) && point.is_some_and(|point| point.is_resolved)
    }
}

/// The cases by pair of methods, in the order of the rows; only curves with several counts.
pub(super) fn pairs<'r, 'f>(all: Vec<Beside<'r, 'f>>) -> Vec<([String; 2], Vec<Case<'r, 'f>>)> {
    let case = |of: Beside<'r, 'f>| {
        let wins = of.curve.points.iter().rev().take_while(|point| point.error < of.error);
        Case { break_even: wins.last().map(|point| point.samples), of }
    };
    grouped(all.into_iter().filter(|of| of.curve.points.len() > 1).map(case), |case| case.of.names())
}

fn answer(frame: &Frame) -> Option<Finding> {
    let (axes, images) = (frame.case_axes(), frame.images());
    let pairs = pairs(beside(frame, &images, &axes));
    let mut table = Table::new(&frame.table_axes(), QUESTION.columns);
    add_cases(frame, &pairs, [0.0, 1.0], &mut table);
    let (names, cases) = pairs.first()?;
    let tried = tried(cases);
    let numbers = numbers(cases);
    let scope = numbers.scope(frame);
    let groups = by_condition(frame, cases);
    let views = views(frame, &images, &axes, &mut table);
    let words = |middle: &Estimate| counted_words(middle, &tried);
    let of: Vec<usize> = conditions(frame).collect();
    let heads = frame.names.heads(&of);
    let rows: Vec<(Vec<Cell>, Numbers)> =
        groups.iter().map(|(key, own)| (frame.names.head(&of, key), own.clone())).collect();
    let digest = if views.is_empty() {
        by_light(frame, &heads, &rows, &words)
    } else {
        let names = heads.iter().map(|head| head.to_string()).chain(views.iter().map(|one| view(one.seen)));
        let mut digest = Table::with_names(names.chain(["all n·v".to_owned()]));
        for ((key, _), (head, own)) in groups.iter().zip(rows) {
            let by_view = views.iter().map(|view| Cell::from(view.median(key).map(|n| counted(n, &tried))));
            let all = own.estimate().map(|all| words(&all));
            digest.row(head.into_iter().chain(by_view).chain([all.into()]).collect());
        }
        digest
    };
    let pooled = sentence(frame, names, &groups, &words)?;
    Some(Finding {
        sentence: view_sentence(frame, names, &views, &tried)
            .map_or(pooled + &scope, |text| text + &scope.replacen("Over", "Medians over", 1)),
        digest: Some(digest),
        table,
        figure: view_figure(frame, &views, &tried).or_else(|| figure(frame, &axes, &pairs)),
    })
}

fn add_cases(frame: &Frame, pairs: &[([String; 2], Vec<Case>)], seen: [f64; 2], table: &mut Table) {
    for ([sampled, fixed], case) in pairs.iter().flat_map(|(names, cases)| cases.iter().map(move |case| (names, case)))
    {
        let mut row = case.of.cells(&frame.table_axes());
        row.extend(cells![seen[0], seen[1], sampled.as_str(), fixed.as_str(), case.break_even]);
        row.extend(cells![case.of.curve.tried()[1], case.crossing(), case.of.error, case.is_resolved(frame)]);
        table.row(row);
    }
}

struct View {
    seen: [f64; 2],
    /// Medians over environments by condition.
    medians: Vec<(Key, f64)>,
}

impl View {
    fn median(&self, key: &Key) -> Option<f64> {
        self.medians.iter().find(|(own, _)| own == key).map(|(_, median)| *median)
    }

    /// The least and the largest median.
    fn ends(&self) -> [f64; 2] {
        let medians = || self.medians.iter().map(|(_, median)| *median);
        [medians().fold(f64::INFINITY, f64::min), medians().fold(0.0, f64::max)]
    }
}

/// The answers by n·v; their cases are added to the table.
fn views(frame: &Frame, images: &[&Row], axes: &[usize], table: &mut Table) -> Vec<View> {
    let view = |(seen, run): ([f64; 2], Finished)| {
        let own = frame.like(&run, frame.metric_name());
        let images = own.images();
        let pairs = pairs(beside(&own, &images, axes));
        add_cases(frame, &pairs, seen, table);
        let (_, cases) = pairs.first()?;
        let medians = by_condition(&own, cases).into_iter();
        let medians = medians.filter_map(|(key, own)| Some((key, own.estimate()?.value))).collect();
        Some(View { seen, medians })
    };
    frame.views(images).into_iter().filter_map(view).collect()
}

/// Most lines of a panel.
const LINES: usize = 4;

/// One panel per value of [`Frame::row_axis`], one line per other condition, or the other way round if those are many: the
/// median over environments by n·v.
fn view_figure(frame: &Frame, views: &[View], tried: &[u32]) -> Option<Figure> {
    let of: Vec<usize> = conditions(frame).collect();
    let keys = &views.first()?.medians;
    let label =
        |key: &Key, is_row: bool| frame.names.label_where(&of, key, |axis| (axis == frame.row_axis()) == is_row);
    let distinct = |is_row: bool| distinct_in_order(keys.iter().map(|(key, _)| label(key, is_row)));
    let has_few_others = distinct(false).len() <= LINES;
    let series = distinct(!has_few_others);
    let row = of.iter().position(|axis| *axis == frame.row_axis()).filter(|_| has_few_others);
    let title =
        |key: &Key| row.map_or_else(|| label(key, has_few_others), |row| frame.names.heading(of[row], &key[row]));
    let largest = f64::from(*tried.last()?);
    let line = |key: &Key| {
        let dot = |one: &View| {
            let median = one.median(key)?;
            let tip =
                format!("{}: {} samples · {}", view(one.seen), counted(median, tried), frame.names.label(&of, key));
            let at = [(one.seen[0] + one.seen[1].min(1.0)) / 2.0, up(median, tried).min(2.0 * largest)];
            Some(Mark::new(Form::Dot(at), step(&series, &label(key, !has_few_others)) as usize).tip(tip))
        };
        joined(views.iter().filter_map(dot).collect())
    };
    let panel = |(name, own): (String, Vec<&(Key, f64)>)| {
        let band = [Mark::neutral(Form::BeyondY(largest))];
        (name, band.into_iter().chain(own.into_iter().flat_map(|(key, _)| line(key))).collect())
    };
    Chart {
        title: "Samples per pixel that sampling needs to win",
        note: format!(
            "{}, median environment. Higher is better for the method without samples. Hatched: more than the largest tried count",
            frame.metric_name()
        ),
        x: Along::Linear("n·v, from grazing (0) to facing (1) views"),
        y: Along::Log("samples per pixel"),
        panels: grouped(keys, |(key, _)| title(key)).into_iter().map(panel).collect(),
        series,
    }
    .figure()
}

/// The answer at the most grazing and at the steepest views.
fn view_sentence(frame: &Frame, [sampled, fixed]: &[String; 2], views: &[View], tried: &[u32]) -> Option<String> {
    let told = |view: &View| {
        let [low, high] = view.ends().map(|n| counted(n, tried));
        if low == high { low } else { format!("{low} to {high}") }
    };
    let (first, last) = (views.first()?, views.last()?);
    Some(format!(
        "At n·v below {}, `{sampled}` needs **{} per pixel** to beat `{fixed}` (`{}`); at n·v above {}, **{}**.",
        first.seen[1],
        samples(&told(first)),
        frame.metric_name(),
        last.seen[0],
        told(last),
    ))
}

/// The surface axes that matter most.
pub(super) const SURFACE: [usize; 3] = [ALPHA, BRDF, F0];

/// The axes whose values have their own answers: the row axis, the surface, and parameters of methods and tables.
pub(super) fn conditions(frame: &Frame) -> impl Iterator<Item = usize> {
    let ways = frame.swept(&[Part::Method, Part::Parameter, Part::Table]).into_iter().filter(|of| *of != METHOD);
    let all = std::iter::once(frame.row_axis()).chain(SURFACE).chain(ways);
    distinct_in_order(all.filter(|of| frame.shape.is_swept(*of))).into_iter()
}

/// The cases at each value of these axes, ascending.
pub(super) fn by_condition<'r, 'f>(frame: &Frame, cases: &[Case<'r, 'f>]) -> Vec<(Key, Numbers<'r, 'f>)> {
    let part = |groups: Vec<(Key, Vec<usize>)>, of: usize| {
        let parts = groups.into_iter().flat_map(|(key, own)| {
            let values = ascending(distinct_in_order(own.iter().map(|case| cases[*case].value(of))));
            let at = |value: Value| {
                let is_own = |case: &usize| cases[*case].value(of) == value;
                (own.iter().copied().filter(is_own).collect::<Vec<_>>(), value)
            };
            let with = |(own, value): (Vec<usize>, Value)| ([&key[..], &[value]].concat(), own);
            values.into_iter().map(at).map(with).collect::<Vec<_>>()
        });
        parts.collect()
    };
    let groups = conditions(frame).fold(vec![(Vec::new(), (0..cases.len()).collect())], part);
    let all = numbers(cases);
    groups.into_iter().map(|(key, own)| (key, all.part(|case| own.contains(&case)))).collect()
}

pub(super) fn numbers<'r, 'f>(cases: &[Case<'r, 'f>]) -> Numbers<'r, 'f> {
    let tried = tried(cases);
    Numbers::new(cases.iter().map(|case| (case.of.fixed, case.number(&tried))), Middle::Median)
}

/// Every tried count, ascending.
pub(super) fn tried(cases: &[Case]) -> Vec<u32> {
    let mut counts: Vec<u32> = cases.iter().flat_map(|case| &case.of.curve.points).map(|point| point.samples).collect();
    counts.sort_unstable();
    counts.dedup();
    counts
}

/// The next tried count; infinity above them.
pub(super) fn up(n: f64, tried: &[u32]) -> f64 {
    tried.iter().map(|count| f64::from(*count)).find(|count| *count >= n).unwrap_or(f64::INFINITY)
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

/// [`counted`] with its interval.
pub(super) fn counted_words(all: &Estimate, tried: &[u32]) -> String {
    counted(all.value, tried) + &interval_words(all, |n| counted(n, tried))
}

/// "1 sample", "16 samples".
fn samples(count: &str) -> String {
    format!("{count} {}", if count == "1" { "sample" } else { "samples" })
}

/// The answer; if conditions differ, the least and the most with their place.
fn sentence(
    frame: &Frame,
    [sampled, fixed]: &[String; 2],
    groups: &[(Key, Numbers)],
    words: &dyn Fn(&Estimate) -> String,
) -> Option<String> {
    let of: Vec<usize> = conditions(frame).collect();
    let at = |key: &Key| frame.names.label(&of, key).replace(" · ", ", ");
    let all = || groups.iter().filter_map(|(key, own)| Some((at(key), own.estimate()?)));
    let least = all().reduce(|a, b| if b.1.value < a.1.value { b } else { a })?;
    let most = all().reduce(|a, b| if b.1.value > a.1.value { b } else { a })?;
    let place = groups[0].1.place(frame, ", in the median environment");
    let to_beat = format!("to beat `{fixed}` (`{}`){place}", frame.metric_name());
    let [low, high] = [&least, &most].map(|(_, middle)| words(&Estimate { interval: None, ..*middle }));
    if low == high {
        let interval = if groups.len() == 1 { words(&least.1).split_off(low.len()) } else { String::new() };
        return Some(format!("`{sampled}` needs **{} per pixel**{interval} {to_beat}.", samples(&low)));
    }
    Some(format!(
        "`{sampled}` needs **{low} to {high} samples per pixel** {to_beat}. Fewest: {} at {}; most: {} at {}.",
        words(&least.1),
        least.0,
        words(&most.1),
        most.0
    ))
}

/// One panel per pair of methods, coloured by model; one row per case, or per condition if environments are averaged.
fn figure(frame: &Frame, axes: &[usize], pairs: &[([String; 2], Vec<Case>)]) -> Option<Figure> {
    let models = if frame.shape.is_swept(BRDF) { &frame.shape.values[BRDF][..] } else { &[] };
    let is_summed = pairs.iter().all(|(_, cases)| numbers(cases).is_summed());
    let is_named = |of: usize| match is_summed {
        true => of != BRDF && conditions(frame).any(|condition| condition == of),
        false => models.is_empty() || of != BRDF,
    };
    let name = |case: &Case| frame.names.label_where(axes, &case.of.key, is_named);
    let rows = distinct_in_order(pairs.iter().flat_map(|(_, cases)| cases).map(name));
    let panel = |([sampled, fixed], cases): &([String; 2], Vec<Case>)| {
        let tried = tried(cases);
        let largest = f64::from(tried[tried.len() - 1]);
        let mut marks = vec![Mark::neutral(Form::BeyondX(largest))];
        let place = |row: &Row| models.iter().position(|model| *model == row.point[BRDF]).unwrap_or(0);
        if is_summed {
            let words = |all: &Estimate| counted_words(all, &tried);
            let of: Vec<usize> = conditions(frame).collect();
            for (key, own) in by_condition(frame, cases) {
                let Some(first) = cases.iter().find(|case| case.of.fixed.key(&of) == key) else { continue };
                let at = |n: f64| [up(n, &tried).min(2.0 * largest), step(&rows, &name(first))];
                let tip = frame.names.label(&of, &key);
                marks.extend(own.marks(place(first.of.fixed), at, (&tip, &words)));
            }
            return (format!("{sampled} over {fixed}"), marks);
        }
        marks.extend(cases.iter().map(|case| {
            let x = case.break_even.map_or(2.0 * largest, f64::from);
            let label = frame.names.label(axes, &case.of.key);
            let tip = format!("{label}: {} samples", counted(case.number(&tried), &tried));
            dot([x, step(&rows, &name(case))], place(case.of.fixed), tip, case.of.fixed)
        }));
        (format!("{sampled} over {fixed}"), marks)
    };
    Chart {
        title: "Samples per pixel that sampling needs to win",
        note: format!(
            "{}{}; hatched: more than the largest tried count",
            frame.metric_name(),
            if is_summed { ", median environment; whiskers: 95 %" } else { "" }
        ),
        panels: pairs.iter().map(panel).collect(),
        x: Along::Log("samples per pixel"),
        y: Along::Steps("", rows.clone()),
        series: match models {
            [] => vec![QUESTION.name.to_owned()],
            models => models.iter().map(|model| frame.names.one(BRDF, model)).collect(),
        },
    }
    .figure()
}
