//! Do so many samples a pixel suffice?
//!
//! Two measures of "suffice", at each tried count N. Against the method without samples: the ratio e(N)/f of the two errors in a case
//! (geometric mean over point sets), told as the geometric mean over environments. Where that is below 1 at some values of alpha, or under some
//! environments, and above 1 at others, it is told along them and never averaged over them. To the eye: mean FLIP at the plain tone curve,
//! visible from [`VISIBLE_FROM`] on. Where bias and variance were parted, the share of bias says how much of the error more samples would
//! leave.
//!
//! The sentence is about the count that a renderer takes by default, else the tried count nearest to it by ratio.

use super::break_even::lacks_methods;
use super::prelude::*;
use super::{BIAS_SHARE, FIXED};
use crate::study::frame::curve::{Beside, CurvePoint, beside, mean};

pub const QUESTION: Question = Question {
    name: "sample-count",
    asks: "Do so many samples a pixel suffice?",
    columns: &[
        FIXED,
        column("ratio", "Error over that of the method without samples; below 1 sampling is closer to the reference."),
        column("is_resolved", "1 where both errors stand clear of the reference's noise, else 0."),
        column("flip", "Mean FLIP at the plain tone curve, mean over point sets."),
        column("is_visible", "1 where that is at least 0.05, this project's limit of the visible, else 0."),
        BIAS_SHARE,
    ],
    uses_times: false,
    uses_costs: false,
    lacks: lacks_methods,
    answer,
};

/// One count of a sampling method beside a method without samples in one case.
struct Case<'c, 'r, 'f> {
    of: &'c Beside<'r, 'f>,
    point: &'c CurvePoint<'r, 'f>,
    ratio: f64,
    flip: Option<f64>,
}

impl Case<'_, '_, '_> {
    fn is_visible(&self) -> bool {
        self.flip.is_some_and(|flip| flip >= VISIBLE_FROM)
    }
}

/// The cases of one pair of methods at one count.
struct Level<'c, 'r, 'f> {
    names: [String; 2],
    samples: u32,
    cases: Vec<Case<'c, 'r, 'f>>,
    ratios: Numbers<'r, 'f>,
}

impl Level<'_, '_, '_> {
    /// Mean FLIP under each environment that counts.
    fn flips(&self) -> Vec<f64> {
        let own = self.cases.iter().filter(|case| self.ratios.weighs(case.of.fixed));
        let by_light = grouped(own, |case| case.of.fixed.point[ENVIRONMENT].clone());
        by_light.iter().filter_map(|(_, own)| mean(own.iter().filter_map(|case| case.flip))).collect()
    }

    fn visible(&self) -> usize {
        self.flips().iter().filter(|flip| **flip >= VISIBLE_FROM).count()
    }

    fn bias(&self) -> Option<String> {
        mean(self.cases.iter().filter_map(|case| case.point.bias_share())).map(|share| percent(share.max(0.0)))
    }
}

/// By pair of methods and count, the latter ascending.
fn levels<'c, 'r, 'f>(all: &'c [Beside<'r, 'f>]) -> Vec<Level<'c, 'r, 'f>> {
    let case = |of: &'c Beside<'r, 'f>, point: &'c CurvePoint<'r, 'f>| {
        let (ratio, flip) = (point.error / of.error, mean(point.rows.iter().filter_map(|row| row.flip())));
        ratio.is_finite().then_some(Case { of, point, ratio, flip })
    };
    let cases = all.iter().flat_map(|of| of.curve.points.iter().filter_map(move |point| case(of, point)));
    let mut pairs = grouped(cases, |case| case.of.names());
    pairs.iter_mut().for_each(|(_, own)| own.sort_by_key(|case| case.point.samples));
    let counts = pairs.into_iter().flat_map(|(names, own)| {
        let level = move |(samples, cases): (u32, Vec<Case<'c, 'r, 'f>>)| Level {
            names: names.clone(),
            samples,
            ratios: Numbers::ratios(cases.iter().map(|case| (case.of.fixed, case.ratio))),
            cases,
        };
        grouped(own, |case| case.point.samples).into_iter().map(level)
    });
    counts.collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let (axes, images) = (frame.case_axes(), frame.images());
    let all = beside(frame, &images, &axes);
    let levels = levels(&all);
    let mut table = Table::new(&[&axes[..], &[METHOD, SAMPLES]].concat(), QUESTION.columns);
    for (level, case) in levels.iter().flat_map(|level| level.cases.iter().map(move |case| (level, case))) {
        let mut row: Vec<Cell> = case.of.key.iter().map(Cell::from).collect();
        let is_resolved = case.point.is_resolved && frame.is_resolved(case.of.fixed);
        let [sampled, fixed] = level.names.each_ref().map(String::as_str);
        row.extend(cells![sampled, level.samples, fixed, case.ratio, is_resolved, case.flip]);
        row.extend(cells![case.flip.map(|_| case.is_visible()), case.point.bias_share()]);
        table.row(row);
    }
    let told = told(&levels)?;
    Some(Finding {
        sentence: sentence(frame, &axes, told),
        table,
        digest: Some(digest(frame, &levels, told).without_empty()),
        figure: figure(frame, &axes, &levels),
    })
}

/// The level that the sentence is about.
fn told<'l, 'c, 'r, 'f>(levels: &'l [Level<'c, 'r, 'f>]) -> Option<&'l Level<'c, 'r, 'f>> {
    let lead = levels.iter().filter(|level| level.names == levels[0].names);
    lead.reduce(|a, b| if from_usual(b.samples) < from_usual(a.samples) { b } else { a })
}

fn sentence(frame: &Frame, axes: &[usize], told: &Level) -> String {
    let ([sampled, fixed], metric, lights) = (&told.names, frame.metric_name(), AXES[ENVIRONMENT].plural);
    let at = format!("At **{} samples a pixel** `{sampled}`", told.samples);
    let mut parts = match told.ratios.change_of_sign(frame) {
        Some((of, groups)) => {
            let ([less, more], along) = (sides(of, &groups), AXES[of].name);
            vec![
                format!("{at} has less `{metric}` than `{fixed}` at {along} {less}."),
                format!("It has more at {along} {more}."),
            ]
        }
        None => {
            let times = |ratio: Estimate| format!("{} times{}", number(ratio.value), interval_words(&ratio, number));
            let times = told.ratios.estimate().map_or_else(String::new, times);
            let [wins, n] = told.ratios.wins();
            let wins = format!("; it wins under {wins} of {n} {lights}");
            vec![format!("{at} has {times} the `{metric}` of `{fixed}`{}.", told.ratios.place(&wins))]
        }
    };
    if let Some(flip) = mean(told.flips()).map(number) {
        let (visible, n) = (told.visible(), told.flips().len());
        let seen = match n {
            1 => if visible > 0 { "visible" } else { "hidden" }.to_owned(),
            n => format!("visible under {visible} of {n} {lights}"),
        };
        parts.push(format!("The difference from the reference is {seen} (mean FLIP {flip})."));
    }
    if let Some(share) = told.bias() {
        parts.push(format!("More samples do not help against {share} of its square error, which is bias."));
    }
    parts.push(told.ratios.scope(axes).trim().to_owned());
    parts.retain(|part| !part.is_empty());
    parts.truncate(super::SENTENCES_MAX);
    parts.join(" ")
}

/// By method and count: the ratio at each value of the axis along which it changes its sign, over all where it keeps it, then wins, FLIP and
/// bias.
fn digest(frame: &Frame, levels: &[Level], told: &Level) -> Table {
    let usual = [ALPHA, ENVIRONMENT].into_iter().find(|of| frame.shape.is_swept(*of));
    let of = told.ratios.change_of_sign(frame).map(|(of, _)| of).or(usual);
    let rows = || levels.iter().flat_map(|level| &level.cases).map(|case| case.of.fixed);
    let columns: Vec<(usize, Value)> =
        of.into_iter().flat_map(|of| values(rows(), of).into_iter().map(move |value| (of, value))).collect();
    let heads = columns.iter().map(|(of, value)| heading(*of, value));
    // What all have in common is in the sentence.
    let has_rivals = levels.iter().any(|level| level.names[1] != told.names[1]);
    let beside = has_rivals.then_some("beside");
    let names =
        [AXES[METHOD].name].into_iter().chain(beside).chain([AXES[SAMPLES].name]).map(str::to_owned).chain(heads);
    let last = [ALL, "wins under", "mean FLIP", "visible under", "bias share"].map(str::to_owned);
    let mut table = Table::with_names(names.chain(last));
    let words = |estimate: &Estimate| number(estimate.value);
    for level in levels {
        let [sampled, fixed] = level.names.each_ref().map(String::as_str);
        let mut row = cells![sampled];
        row.extend(has_rivals.then(|| Cell::from(fixed)));
        row.push(level.samples.into());
        row.extend(columns.iter().map(|(of, value)| level.ratios.at(*of, value).cell(frame, &words)));
        row.push(level.ratios.pooled(frame).map(|pooled| with_interval(&pooled)).into());
        let [wins, n] = level.ratios.wins();
        let flips = level.flips();
        let visible = (!flips.is_empty()).then(|| format!("{} of {}", level.visible(), flips.len()));
        row.extend(cells![format!("{wins} of {n}"), mean(flips).map(number), visible, level.bias()]);
        table.row(row);
    }
    table
}

/// The ratio over the sample count, coloured by alpha: one panel a pair of methods and environment with one line a case; one panel a pair,
/// where environments are summed up.
fn figure(frame: &Frame, axes: &[usize], levels: &[Level]) -> Option<Figure> {
    let cases = || levels.iter().flat_map(|level| level.cases.iter().map(move |case| (level, case)));
    let widths = values(cases().map(|(_, case)| case.of.fixed), ALPHA);
    let is_by_alpha = frame.shape.is_swept(ALPHA);
    let mark = |(_, case): &(&Level, &Case)| {
        let samples = count(case.point.samples as usize, "sample", "samples");
        let tip = format!("{samples}: {} times · {}", number(case.ratio), label(axes, &case.of.key));
        let series = widths.iter().position(|width| *width == case.of.fixed.point[ALPHA]).unwrap_or(0);
        dot([f64::from(case.point.samples), case.ratio], series, tip, case.point.rows[0])
    };
    let title = |(level, case): &(&Level, &Case)| {
        let of = level.names.join(" over ");
        let light = Some(&case.of.fixed.point[ENVIRONMENT]).filter(|_| frame.shape.is_swept(ENVIRONMENT));
        light.map_or(of.clone(), |light| format!("{of}, {}", short(ENVIRONMENT, light)))
    };
    let panel = |(title, own): (String, Vec<(&Level, &Case)>)| {
        let lines = grouped(own, |(_, case)| case.of.key.clone());
        let dots = lines.iter().flat_map(|(_, line)| joined(line.iter().map(mark).collect()));
        (title, std::iter::once(Mark::neutral(Form::HorizontalRule(1.0))).chain(dots).collect())
    };
    let shown = cases().filter(|(_, case)| case.ratio > 0.0);
    let is_summed = levels.iter().all(|level| level.ratios.is_summed());
    let sum = |(names, own): ([String; 2], Vec<&Level>)| {
        let line = |(series, width): (usize, &Value)| {
            let dots = own.iter().flat_map(|level| {
                let samples = count(level.samples as usize, "sample", "samples");
                let name = format!("{samples}, {}", label(&[ALPHA], std::slice::from_ref(width)));
                let at = |ratio: f64| [f64::from(level.samples), ratio];
                level.ratios.at(ALPHA, width).marks(series, at, (&name, &with_interval))
            });
            joined(dots.collect())
        };
        let lines = widths.iter().enumerate().flat_map(line);
        (names.join(" over "), std::iter::once(Mark::neutral(Form::HorizontalRule(1.0))).chain(lines).collect())
    };
    let panels = match is_summed {
        true => grouped(levels, |level| level.names.clone()).into_iter().map(sum).collect(),
        false => grouped(shown, title).into_iter().map(panel).collect(),
    };
    Chart {
        title: "Error of sampling over that of the method without samples",
        note: format!(
            "{}; below 1 sampling is closer to the reference{}",
            frame.metric_name(),
            if is_summed { INTERVAL } else { "" }
        ),
        x: Along::Log("samples a pixel"),
        y: Along::Log("ratio of errors"),
        panels,
        series: match is_by_alpha {
            true => widths.iter().map(|width| heading(ALPHA, width)).collect(),
            false => vec!["ratio".to_owned()],
        },
    }
    .figure()
}
