//! Which method errs less in the same frame time?
//!
//! In a case (as in `break-even`) let t(N) be the frame time of a sampling method with N samples over that of a method without samples,
//! the median over rounds timed together, and e(N) its error over the other's. At equal time t(N) = 1, at equal error e(N) = 1. The
//! sampling method wins where its count at equal error lies below that at equal time. Both counts are read off log-log lines between
//! tried counts; a verdict needs their 95 % intervals to part. The interval of t comes from the rounds; that of e from Student's t over
//! point sets, or, with one set, it is the step between the tried counts around the break-even, which holds the crossing of that set.
//!
//! The verdict holds for the device that was timed. Times of a driver that computes on the CPU say nothing about a GPU.

use super::break_even::{self, Case, Pair, pairs};
use super::conditions::by_width_and_light;
use super::words::{count, label, listed, number, short};
use super::{Finding, Question};
use crate::runner::statistics::TOO_FEW_ROUNDS;
use crate::runner::timing_ratios::Ratio;
use crate::runner::value::Value;
use crate::study::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::study::frame::band::{Level, between, crossing_interval};
use crate::study::frame::times::{self, TimeLevel, TimeMatch, ratio_at, time_match};
use crate::study::frame::{Frame, Key, Row, Shape, ascending, axis, distinct_in_order};
use crate::study::table::{Column, Table};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "equal-time",
    asks: "Which method errs less in the same frame time?",
    columns: &[
        Column { name: "sampled", about: "The sampling method." },
        Column { name: "fixed", about: "The method without samples." },
        Column {
            name: "verdict",
            about: "The method that errs less in equal time, `undecided`, or why there is no verdict.",
        },
        Column {
            name: "samples_at_equal_time",
            about: "Sample count whose frame takes as long; 0 where one of the least tried takes longer, inf where the most tried take less.",
        },
        Column { name: "samples_at_equal_time_lo", about: "Lower end of its 95 % interval over rounds." },
        Column { name: "samples_at_equal_time_hi", about: "Upper end of that interval." },
        Column {
            name: "error_ratio",
            about: "Error of the sampling method at that count over that of the other; empty outside the tried counts.",
        },
        Column { name: "error_ratio_lo", about: "Lower end of its 95 % interval, by that of the count." },
        Column { name: "error_ratio_hi", about: "Upper end of that interval." },
        Column {
            name: "samples_at_equal_error",
            about: "Sample count with the other's error, interpolated; empty outside the tried counts.",
        },
        Column { name: "time_ratio", about: "Frame time at that count over that of the other." },
        Column { name: "time_ratio_lo", about: "Lower end of its 95 % interval over rounds." },
        Column { name: "time_ratio_hi", about: "Upper end of that interval." },
    ],
    uses_times: true,
    lacks,
    answer,
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    if shape.has_timing { break_even::lacks(shape) } else { Some("the experiment has no [timing]") }
}

/// Who errs less.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Winner {
    Sampled,
    Fixed,
    /// The intervals overlap.
    Undecided,
    TooFewRounds,
}

/// A case with its times.
struct Timed<'r, 'f> {
    case: Case<'r, 'f>,
    sampled: String,
    fixed: String,
    time: TimeMatch,
    winner: Winner,
    /// Error ratio at equal time with its interval.
    error_ratio: Option<(f64, Option<[f64; 2]>)>,
    /// Count and time ratio at equal error.
    at_equal_error: Option<(f64, (f64, [f64; 2]))>,
}

impl Timed<'_, '_> {
    /// As in tables.
    fn verdict(&self) -> &str {
        match self.winner {
            Winner::Sampled => &self.sampled,
            Winner::Fixed => &self.fixed,
            Winner::Undecided => "undecided",
            Winner::TooFewRounds => TOO_FEW_ROUNDS,
        }
    }
}

/// 95 % interval of the sample count with equal errors; ends as in [`crossing_interval`].
fn error_interval(frame: &Frame, case: &Case) -> Option<[f64; 2]> {
    let points = &case.curve.points;
    let of_sets = points.iter().map(|point| {
        let errors: Vec<f64> = point.rows.iter().filter_map(|row| frame.error(row)).collect();
        Level::of_point_sets(point.samples, &errors, case.fixed_error)
    });
    if let Some(levels) = of_sets.collect::<Option<Vec<Level>>>() {
        return crossing_interval(&levels);
    }
    let [_, last] = case.curve.tried();
    let Some(n) = case.break_even else { return Some([f64::from(last), f64::INFINITY]) };
    let before = points.iter().rev().find(|point| point.samples < n);
    Some([before.map_or(0.0, |point| f64::from(point.samples)), f64::from(n)])
}

/// The verdict of two intervals of sample counts: at equal error and at equal time.
fn winner(at_equal_error: Option<[f64; 2]>, at_equal_time: Option<[f64; 2]>) -> Winner {
    match (at_equal_error, at_equal_time) {
        (_, None) => Winner::TooFewRounds,
        (Some([_, hi]), Some([fewest, _])) if hi < fewest => Winner::Sampled,
        (Some([lo, _]), Some([_, most])) if lo > most => Winner::Fixed,
        _ => Winner::Undecided,
    }
}

fn timed<'r, 'f>(frame: &Frame, ratios: &[Ratio], case: Case<'r, 'f>, names: [&str; 2]) -> Option<Timed<'r, 'f>> {
    let points = &case.curve.points;
    let levels: Vec<TimeLevel> =
        points.iter().filter_map(|point| times::level(frame, ratios, point.rows[0], case.fixed)).collect();
    let time = time_match(&levels)?;
    let curve: Vec<(f64, f64)> =
        points.iter().map(|point| (f64::from(point.samples), point.error / case.fixed_error)).collect();
    let error_ratio = between(&curve, time.samples).map(|ratio| {
        let ends = time.interval.and_then(|[lo, hi]| Some([between(&curve, lo)?, between(&curve, hi)?]));
        (ratio, ends.map(|[a, b]| [a.min(b), a.max(b)]))
    });
    let at_equal_error = case.crossing().and_then(|samples| Some((samples, ratio_at(&levels, samples)?)));
    let winner = winner(error_interval(frame, &case), time.interval);
    let [sampled, fixed] = names.map(str::to_owned);
    Some(Timed { sampled, fixed, case, time, winner, error_ratio, at_equal_error })
}

fn timed_pair<'r, 'f>(frame: &Frame, ratios: &[Ratio], pair: Pair<'r, 'f>) -> Vec<Timed<'r, 'f>> {
    let names = [pair.sampled.as_str(), pair.fixed.as_str()];
    pair.cases.into_iter().filter_map(|case| timed(frame, ratios, case, names)).collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let axes = frame.case_axes();
    let ratios = times::pairs(frame);
    let images = frame.images();
    let pairs: Vec<Vec<Timed>> = pairs(frame, &images, &axes)
        .into_iter()
        .map(|pair| timed_pair(frame, &ratios, pair))
        .filter(|cases| !cases.is_empty())
        .collect();
    let lead = pairs.first()?;
    let mut table = Table::new(&axes, QUESTION.columns);
    for one in pairs.iter().flatten() {
        table.row(row(&axes, one));
    }
    Some(Finding {
        sentence: sentence(frame, lead),
        table,
        digest: Some(digest(frame, lead)),
        figure: figure(frame, &axes, &pairs),
    })
}

fn row(axes: &[usize], one: &Timed) -> Vec<Cell> {
    let own = axes.iter().zip(&one.case.key).map(|(&axis, value)| match value {
        Value::Unset => one.case.fixed.text(axis),
        value => value.to_string(),
    });
    let ends =
        |interval: Option<[f64; 2]>| interval.filter(|ends| !ends[0].is_nan()).map_or([None; 2], |ends| ends.map(Some));
    let mut row: Vec<Cell> = own.map(Cell::Text).collect();
    row.extend([&*one.sampled, &*one.fixed, one.verdict()].map(Cell::from));
    row.push(one.time.samples.into());
    row.extend(ends(one.time.interval).map(Cell::from));
    row.push(one.error_ratio.map(|(ratio, _)| ratio).into());
    row.extend(ends(one.error_ratio.and_then(|(_, ends)| ends)).map(Cell::from));
    row.extend([one.at_equal_error.map(|(n, _)| n), one.at_equal_error.map(|(_, (ratio, _))| ratio)].map(Cell::from));
    row.extend(ends(one.at_equal_error.map(|(_, (_, ends))| ends)).map(Cell::from));
    row
}

fn sentence(frame: &Frame, cases: &[Timed]) -> String {
    let Some(Timed { sampled, fixed, .. }) = cases.first() else { return String::new() };
    let number_of = |winner: Winner| cases.iter().filter(|one| one.winner == winner).count();
    let on = if QUESTION.rests_on_cpu_times(frame) { " on this CPU driver" } else { "" };
    let metric = frame.metric_name();
    let [few, n] = [number_of(Winner::TooFewRounds), cases.len()];
    if few == n {
        return format!(
            "Too few rounds were timed to say whether `{sampled}` or `{fixed}` errs less in equal frame time{on}."
        );
    }
    let [by_fixed, by_sampled, open] = [Winner::Fixed, Winner::Sampled, Winner::Undecided].map(number_of);
    let mut text = match cases {
        [one] if one.winner == Winner::Undecided => {
            format!("In equal frame time{on} neither `{sampled}` nor `{fixed}` is told to err less in {metric}.")
        }
        [one] => {
            let loser = if one.winner == Winner::Fixed { sampled } else { fixed };
            format!("In equal frame time{on} `{}` errs less than `{loser}` in {metric}.", one.verdict())
        }
        _ => {
            let open = if open + few > 0 { format!(", {} undecided", open + few) } else { String::new() };
            format!(
                "In equal frame time{on} `{fixed}` errs less in {metric} in {by_fixed} of {}, `{sampled}` in {by_sampled}{open}.",
                count(n, "case", "cases")
            )
        }
    };
    text += &where_it_turns(cases);
    text + &affordable(cases)
}

/// The conditions of the sampling method's wins, where both win somewhere: along the first axis of alpha and environment that parts them.
fn where_it_turns(cases: &[Timed]) -> String {
    let wins = |winner: Winner| cases.iter().filter(move |one| one.winner == winner);
    if wins(Winner::Sampled).count() == 0 || wins(Winner::Fixed).count() == 0 {
        return String::new();
    }
    let parting = ["alpha", "environment", "brdf"].map(axis).into_iter().find_map(|axis| {
        let of =
            |winner: Winner| ascending(distinct_in_order(wins(winner).map(|one| one.case.fixed.point.0[axis].clone())));
        let (sampled, fixed) = (of(Winner::Sampled), of(Winner::Fixed));
        let parts = !sampled.iter().any(|value| fixed.contains(value));
        let words = |values: &[Value]| listed(&values.iter().map(|value| short(axis, value)).collect::<Vec<_>>());
        let name = if axis == crate::study::frame::axis("alpha") { "alpha " } else { "" };
        parts.then(|| (format!("{name}{}", words(&sampled)), format!("{name}{}", words(&fixed))))
    });
    match (parting, cases.first()) {
        (Some((sampled, fixed)), Some(one)) => {
            format!(" `{}` wins at {sampled}, `{}` at {fixed}.", one.sampled, one.fixed)
        }
        _ => String::new(),
    }
}

/// How many samples fit into the other's frame time.
fn affordable(cases: &[Timed]) -> String {
    let Some(Timed { sampled, fixed, case, .. }) = cases.first() else { return String::new() };
    let counts = || cases.iter().map(|one| one.time.samples);
    let (lo, hi) = (counts().fold(f64::INFINITY, f64::min), counts().fold(0.0, f64::max));
    let [least, most] = case.curve.tried();
    match () {
        () if hi == 0.0 => format!(
            " A frame of `{sampled}` takes longer than one of `{fixed}` even with {}.",
            count(least as usize, "sample", "samples")
        ),
        () if lo == f64::INFINITY => {
            format!(" A frame of `{sampled}` takes less than one of `{fixed}` even with {most} samples.")
        }
        () if lo == 0.0 || hi == f64::INFINITY => String::new(),
        () if number(lo) == number(hi) => {
            format!(" `{sampled}` affords {} samples in the frame time of `{fixed}`.", number(lo))
        }
        () => format!(" `{sampled}` affords {} to {} samples in the frame time of `{fixed}`.", number(lo), number(hi)),
    }
}

/// Verdicts of a pair by alpha, one column an environment.
fn digest(frame: &Frame, cases: &[Timed]) -> Table {
    by_width_and_light(frame, cases, |one| one.case.fixed, |own| Cell::Text(verdicts(own)))
}

/// "split-sum 3, undecided 1".
fn verdicts(cases: &[&Timed]) -> String {
    let kinds = distinct_in_order(cases.iter().map(|one| one.verdict().to_owned()));
    let number_of = |kind: &String| cases.iter().filter(|one| one.verdict() == kind).count();
    let words =
        kinds.iter().map(|kind| if cases.len() == 1 { kind.clone() } else { format!("{kind} {}", number_of(kind)) });
    words.collect::<Vec<_>>().join(", ")
}

/// One panel a pair: the error ratio at equal time of each case, one row a case.
fn figure(frame: &Frame, axes: &[usize], pairs: &[Vec<Timed>]) -> Option<Figure> {
    let key = |one: &Timed| -> Key { axes.iter().map(|&axis| one.case.fixed.point.0[axis].clone()).collect() };
    let mut panels = Vec::new();
    for pair in pairs {
        let rows = distinct_in_order(pair.iter().filter(|one| one.error_ratio.is_some()).map(key));
        let mut marks = vec![Mark::neutral(Form::VerticalRule(1.0))];
        let mut values = vec![1.0];
        for one in pair {
            let Some((ratio, ends)) = one.error_ratio.filter(|(ratio, _)| ratio.is_finite() && *ratio > 0.0) else {
                continue;
            };
            let y = rows.iter().position(|row| *row == key(one))? as f64;
            values.push(ratio);
            if let Some([lo, hi]) = ends {
                values.extend([lo, hi]);
                marks.push(Mark::new(Form::Whisker([lo, y], [hi, y]), 0));
            }
            let tip = format!("{}: {} times the error, {}", label(axes, &key(one)), number(ratio), one.verdict());
            let row: &Row = one.case.fixed;
            marks.push(Mark::new(Form::Dot([ratio, y]), 0).tip(tip).cell(&row.cell.id));
        }
        if values.len() > 1 {
            panels.push(Panel {
                title: format!("{} over {}", pair[0].sampled, pair[0].fixed),
                x: Scale::log("error ratio at equal frame time", values)?,
                y: Scale::steps("", rows.iter().map(|row| label(axes, row)).collect()),
                marks,
            });
        }
    }
    let on = if QUESTION.rests_on_cpu_times(frame) { "; times of a CPU driver" } else { "" };
    (!panels.is_empty()).then(|| Figure {
        title: "Error of sampling over that of the other in the same frame time".to_owned(),
        note: format!("{}; above 1 sampling errs more{on}", frame.metric_name()),
        panels,
        series: vec![Series { name: "error ratio".to_owned(), is_dashed: false }],
        ramp: None,
    })
}
