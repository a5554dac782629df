//! Which method errs less in the same frame time?
//!
//! In a case (as in `break-even`) let t(N) be the frame time of a sampling method with N samples over that of a method without samples,
//! the median over rounds timed together, and e(N) its error over the other's. At equal time t(N) = 1, at equal error e(N) = 1. The
//! sampling method wins where its count at equal error lies below that at equal time. Both counts are read off log-log lines between
//! tried counts; a verdict needs their 95 % intervals to part. The interval of t comes from the rounds; that of e from Student's t over
//! point sets, or, with one set, it is the step between the tried counts around the break-even, which holds the crossing of that set.
//!
//! The verdict holds for the device that was timed. Times of a driver that computes on the CPU say nothing about a GPU.

use super::break_even::{self, Case, pairs};
use super::prelude::*;
use super::{FIXED, SAMPLED};
use crate::run::statistics::TOO_FEW_ROUNDS;
use crate::run::timing_ratios::Ratio;
use crate::study::frame::band::{Level, between, crossing_interval};
use crate::study::frame::curve::beside;
use crate::study::frame::times::{self, TimeLevel, TimeMatch, time_match};

pub const QUESTION: Question = Question {
    name: "equal-time",
    asks: "Which method errs less in the same frame time?",
    columns: &[
        SAMPLED,
        FIXED,
        column("verdict", "The method that errs less in equal time, `undecided`, or why there is no verdict."),
        column(
            "samples_at_equal_time",
            "Count whose frame takes as long; 0 below the least tried, inf above the most.",
        ),
        column("samples_at_equal_time_lo", "Lower end of its 95 % interval over rounds."),
        column("samples_at_equal_time_hi", super::UPPER),
        column("error_ratio", "Error at that count over that of the other; empty outside the tried counts."),
        column("samples_at_equal_error", "Count with the other's error, interpolated; empty outside the tried counts."),
    ],
    uses_times: true,
    uses_costs: false,
    lacks,
    answer,
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    if shape.has_timing { break_even::lacks(shape) } else { Some("the experiment has no [timing]") }
}

const UNDECIDED: &str = "undecided";

/// A case with its times.
struct Timed<'r, 'f> {
    case: Case<'r, 'f>,
    time: TimeMatch,
    /// The method that errs less, or why none is told.
    verdict: String,
    /// Error ratio at equal time.
    error_ratio: Option<f64>,
}

/// 95 % interval of the sample count with equal errors; ends as in [`crossing_interval`].
fn error_interval(frame: &Frame, case: &Case) -> Option<[f64; 2]> {
    let points = &case.of.curve.points;
    let of_sets = points.iter().map(|point| {
        let errors: Vec<f64> = point.rows.iter().filter_map(|row| frame.error(row)).collect();
        Level::of_point_sets(point.samples, &errors, case.of.error)
    });
    if let Some(levels) = of_sets.collect::<Option<Vec<Level>>>() {
        return crossing_interval(&levels);
    }
    let Some(n) = case.break_even else { return Some([case.of.curve.tried()[1].into(), f64::INFINITY]) };
    let before = points.iter().rev().find(|point| point.samples < n);
    Some([before.map_or(0.0, |point| f64::from(point.samples)), f64::from(n)])
}

/// The verdict of two intervals of sample counts: at equal error and at equal time.
fn verdict([sampled, fixed]: [String; 2], error: Option<[f64; 2]>, time: Option<[f64; 2]>) -> String {
    match (error, time) {
        (_, None) => TOO_FEW_ROUNDS.to_owned(),
        (Some([_, hi]), Some([fewest, _])) if hi < fewest => sampled,
        (Some([lo, _]), Some([_, most])) if lo > most => fixed,
        _ => UNDECIDED.to_owned(),
    }
}

fn timed<'r, 'f>(frame: &Frame, ratios: &[Ratio], case: Case<'r, 'f>) -> Option<Timed<'r, 'f>> {
    let (points, fixed) = (&case.of.curve.points, case.of.fixed);
    let levels: Vec<TimeLevel> =
        points.iter().filter_map(|point| times::level(frame, ratios, point.rows[0], fixed)).collect();
    let time = time_match(&levels)?;
    let curve: Vec<(f64, f64)> =
        points.iter().map(|point| (f64::from(point.samples), point.error / case.of.error)).collect();
    let verdict = verdict(case.of.names(), error_interval(frame, &case), time.interval);
    Some(Timed { error_ratio: between(&curve, time.samples), case, time, verdict })
}

fn answer(frame: &Frame) -> Option<Finding> {
    let (axes, images, ratios) = (frame.case_axes(), frame.images(), times::pairs(frame));
    let cases = pairs(beside(frame, &images, &axes)).into_iter().flat_map(|(_, cases)| cases);
    let all: Vec<Timed> = cases.filter_map(|case| timed(frame, &ratios, case)).collect();
    let mut table = Table::new(&axes, QUESTION.columns);
    for one in &all {
        let key = one.case.of.key.iter().map(Cell::from);
        let [lo, hi] = one.time.interval.filter(|ends| !ends[0].is_nan()).map_or([None; 2], |ends| ends.map(Some));
        let own = cells![one.verdict.as_str(), one.time.samples, lo, hi, one.error_ratio, one.case.crossing()];
        table.row(key.chain(one.case.of.names().map(Cell::from)).chain(own).collect());
    }
    let by_pair = grouped(&all, |one| one.case.of.names());
    let (names, lead) = by_pair.first()?;
    Some(Finding {
        sentence: sentence(frame, names, lead),
        table,
        digest: Some(digest(frame, &by_pair).without_empty()),
        figure: figure(frame, &axes, &all),
    })
}

/// Environments under which every case has this verdict.
fn agreed(cases: &[&Timed], verdict: &str) -> usize {
    let by_light = grouped(cases, |one| one.case.of.fixed.point[ENVIRONMENT].clone());
    by_light.iter().filter(|(_, own)| own.iter().all(|one| one.verdict == verdict)).count()
}

/// By pair of methods and alpha: the median count at equal time, the error there, and who errs less under how many environments.
fn digest(frame: &Frame, by_pair: &[([String; 2], Vec<&Timed>)]) -> Table {
    let mut table = Table::with_names([
        "first",
        "second",
        AXES[ALPHA].name,
        ROUGHNESS,
        "samples a pixel in equal time",
        "error there over the second's",
        "first errs less under",
        "second errs less under",
        AXES[ENVIRONMENT].plural,
    ]);
    for ([sampled, fixed], own) in by_pair {
        for alpha in values(own.iter().map(|one| one.case.of.fixed), ALPHA) {
            let at: Vec<&Timed> = own.iter().copied().filter(|one| one.case.of.fixed.point[ALPHA] == alpha).collect();
            let counts = Numbers::new(at.iter().map(|one| (one.case.of.fixed, one.time.samples)), Middle::Median);
            let counts = counts.estimate();
            let ratios = Numbers::ratios(at.iter().filter_map(|one| Some((one.case.of.fixed, one.error_ratio?))));
            let counts = counts.filter(|all| all.value.is_finite()).map(|all| number(all.value));
            let mut row = cells![sampled.as_str(), fixed.as_str(), short(ALPHA, &alpha), roughness(&alpha), counts];
            row.push(ratios.cell(frame, &with_interval));
            row.extend([sampled, fixed].map(|name| agreed(&at, name).into()));
            row.push(values(at.iter().map(|one| one.case.of.fixed), ENVIRONMENT).len().into());
            table.row(row);
        }
    }
    table
}

fn sentence(frame: &Frame, [sampled, fixed]: &[String; 2], cases: &[&Timed]) -> String {
    let (on, metric) = (frame.cpu_words(), frame.metric_name());
    if cases.iter().all(|one| one.verdict == TOO_FEW_ROUNDS) {
        return format!(
            "Too few rounds were timed to say whether `{sampled}` or `{fixed}` errs less in equal frame time{on}."
        );
    }
    let lights = values(cases.iter().map(|one| one.case.of.fixed), ENVIRONMENT).len();
    let [first, second] = [sampled, fixed].map(|name| agreed(cases, name));
    let under = |n: usize| format!("{n} of {}", count(lights, "environment", AXES[ENVIRONMENT].plural));
    let open = ["", " The rest is mixed or undecided."][usize::from(first + second < lights)];
    format!(
        "In equal frame time{on} `{fixed}` errs less in `{metric}` in every case under {}, `{sampled}` under {first}.{open}",
        under(second)
    )
}

/// The error ratio at equal time of each case, one row a case.
fn figure(frame: &Frame, axes: &[usize], all: &[Timed]) -> Option<Figure> {
    let name = |one: &Timed| label(axes, &one.case.of.key);
    let rows = distinct_in_order(all.iter().map(name));
    let panel = |([sampled, fixed], own): ([String; 2], Vec<&Timed>)| {
        let marks = own.into_iter().filter_map(|one| {
            let (ratio, y) = (one.error_ratio?, step(&rows, &name(one)));
            let tip = format!("{}: {} times the error, {}", name(one), number(ratio), one.verdict);
            Some(dot([ratio, y], 0, tip, one.case.of.fixed))
        });
        let rule = Mark::neutral(Form::VerticalRule(1.0));
        (format!("{sampled} over {fixed}"), std::iter::once(rule).chain(marks).collect::<Vec<_>>())
    };
    let mut panels: Vec<_> = grouped(all, |one| one.case.of.names()).into_iter().map(panel).collect();
    panels.retain(|(_, marks)| marks.len() > 1);
    Chart {
        title: "Error of sampling over that of the other in the same frame time",
        note: format!("{}; above 1 sampling errs more{}", frame.metric_name(), frame.cpu_words()),
        x: Along::Log("error ratio at equal frame time"),
        y: Along::Steps("", rows.clone()),
        panels: Some(panels).filter(|panels| !panels.is_empty())?,
        series: vec!["error ratio".to_owned()],
    }
    .figure()
}
