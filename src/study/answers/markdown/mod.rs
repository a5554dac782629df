//! The answers as sections of `summary.md`.

mod break_even;
mod light;
mod parameters;

use super::heat::HeatError;
use super::study::Study;
use super::{Answers, grouped, heat, short};
use crate::runner::axis::REFERENCE;
use crate::runner::tables::HEADLINE;
use crate::table::markdown::{Align, MarkdownTable, significant};
use std::fmt::Write;

/// Digits of a score in the summary; the CSV has all.
const DIGITS: usize = 3;
/// Digits of an estimate with an interval.
const ESTIMATE_DIGITS: usize = 2;
/// Stands after a score that the reference's own noise reaches.
const NOISE_MARK: &str = " ~";

/// Stands after the name of a reference that is under test.
const OWN_POINTS: &str = " \\*";
const OWN_POINTS_NOTE: &str = "\\*: an independent render with points of its own, never the reference that judges it. What it shows is the noise of \
     both, half of it the judge's where the two have the same number of samples; it is no error of the method.\n\n";

/// All sections that the experiment has the axes for.
pub fn sections(study: &Study, answers: &Answers) -> String {
    let mut text: String = answers.pairs.iter().map(|pair| break_even::break_even(study, answers, pair)).collect();
    if answers.pairs.is_empty() {
        text += &errors(study);
    }
    text += &slopes(answers);
    text += &error_by_n_dot_v(answers);
    text += &parameters::sufficiency(answers);
    text += &light::visibility(answers);
    text += &light::dynamic_range(answers);
    text += &light::energy(answers);
    text += &parameters::sizes(answers);
    text += &parameters::effects(answers);
    text
}

fn words(axes: &[String], key: &[String]) -> Vec<String> {
    axes.iter().zip(key).map(|(axis, value)| short(axis, value).into_owned()).collect()
}

fn scored(error: f64, is_resolved: bool) -> String {
    format!("{}{}", significant(error, DIGITS), if is_resolved { "" } else { NOISE_MARK })
}

fn noise_note(text: &str) -> &'static str {
    if text.contains(NOISE_MARK) {
        "`~`: within ten times what the reference's own noise would give; more reference samples would change it.\n\n"
    } else {
        ""
    }
}

/// Stands where no pixel of the image is in a bin.
const NO_PIXELS: &str = "–";

fn no_pixels_note(text: &str) -> &'static str {
    if text.contains(NO_PIXELS) { "–: no pixel of the image is in the bin.\n\n" } else { "" }
}

fn table(header: &[(String, Align)]) -> MarkdownTable {
    MarkdownTable::new(&header.iter().map(|(name, align)| (name.as_str(), *align)).collect::<Vec<_>>())
}

fn left(names: &[String]) -> Vec<(String, Align)> {
    names.iter().map(|name| (name.clone(), Align::Left)).collect()
}

/// The headline error of every method in every row.
fn errors(study: &Study) -> String {
    let axes = study.case_axes();
    let names: Vec<String> = axes.iter().map(|&axis| study.axes[axis].name.clone()).collect();
    let mut labels: Vec<String> = Vec::new();
    for label in study.rows.iter().filter(|row| row.error.is_some()).map(|row| study.method_label(row)) {
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    if labels.is_empty() {
        return String::new();
    }
    let mut header = left(&names);
    let is_reference = |label: &String| label.split(' ').next() == Some(REFERENCE);
    let title = |label: &String| if is_reference(label) { format!("{label}{OWN_POINTS}") } else { label.clone() };
    header.extend(labels.iter().map(|label| (title(label), Align::Right)));
    let mut rows = table(&header);
    for (key, own) in grouped(study, &axes) {
        let mut cells = words(&names, &key);
        for label in &labels {
            let of_label = own.iter().filter(|row| study.method_label(row) == *label);
            let mut errors = of_label.clone().filter_map(|row| row.error);
            let is_resolved = of_label.clone().all(|row| row.is_resolved());
            cells.push(errors.next().map_or_else(String::new, |error| scored(error, is_resolved)));
        }
        rows.row(&cells);
    }
    let mut note = noise_note(&rows.to_string()).to_owned();
    if labels.iter().any(is_reference) {
        note += OWN_POINTS_NOTE;
    }
    format!("## Errors\n\n{HEADLINE} by method and sample count:\n\n{rows}\n{note}")
}

fn slopes(answers: &Answers) -> String {
    let curves: Vec<_> = answers.curves.iter().filter(|curve| curve.points.len() > 2).collect();
    if curves.is_empty() {
        return String::new();
    }
    let mut header = left(&answers.case_axes);
    header.push(("method".to_owned(), Align::Left));
    header.push(("slope".to_owned(), Align::Right));
    header.push(("95 %".to_owned(), Align::Left));
    header.push(("points".to_owned(), Align::Right));
    let mut rows = table(&header);
    for curve in curves {
        let mut cells = words(&answers.case_axes, &curve.key);
        let number = |x: f64| format!("{x:.2}");
        cells.push(curve.method.clone());
        cells.push(curve.slope.map_or_else(|| "no fit".to_owned(), |slope| number(slope.value)));
        cells.push(
            curve.slope.map_or_else(String::new, |slope| format!("{} to {}", number(slope.lo), number(slope.hi))),
        );
        let used = curve.points.iter().filter(|point| point.is_resolved).count();
        cells.push(format!("{used} of {}", curve.points.len()));
        rows.row(&cells);
    }
    format!(
        "## Convergence\n\nSlope of ln({HEADLINE}) over ln(samples), fitted to the points that lie above the reference's noise; plain Monte Carlo \
         has -1. A filtered method flattens at its bias.\n\n{rows}\n"
    )
}

/// `0.016 (0.008–0.032)`; the number alone without an interval.
fn ranged(number: f64, interval: Option<[f64; 2]>) -> String {
    let text = |x: f64| significant(x, ESTIMATE_DIGITS);
    let interval = interval.map_or_else(String::new, |[lo, hi]| format!(" ({}–{})", text(lo), text(hi)));
    format!("{}{interval}", text(number))
}

fn error_by_n_dot_v(answers: &Answers) -> String {
    if answers.heat.is_empty() {
        return String::new();
    }
    let has_intervals = answers.heat.iter().flat_map(|table| table.errors.iter().flatten().flatten());
    let intervals = match has_intervals.into_iter().any(|error| error.interval.is_some()) {
        true => "; in brackets the interval that holds it with 95 %",
        false => "",
    };
    let mut text = format!(
        "## Error by alpha and n_dot_v\n\nMedian {HEADLINE} over the cases{intervals}; grazing angles on the left.\n\n"
    );
    for one in heat::shown(&answers.heat) {
        let mut header = vec![("alpha".to_owned(), Align::Right)];
        header.extend(one.bins.iter().map(|(lo, hi)| (format!("{lo} to {}", hi.min(1.0)), Align::Right)));
        let mut rows = table(&header);
        for (alpha, errors) in one.alphas.iter().zip(&one.errors) {
            let number = |e: HeatError| ranged(e.median, e.interval);
            let cells = errors.iter().map(|error| error.map_or_else(|| NO_PIXELS.to_owned(), number));
            let alpha = short("alpha", &alpha.to_string()).into_owned();
            rows.row(&[alpha].into_iter().chain(cells).collect::<Vec<_>>());
        }
        let note = no_pixels_note(&rows.to_string());
        let _ = write!(text, "`{}`:\n\n{rows}\n{note}", one.label());
    }
    text
}
