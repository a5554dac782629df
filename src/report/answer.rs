//! The answer in words: one headline sentence with its numbers, and what qualifies it.

use super::analysis::{Analysis, Pair};
use super::study::{FrameTime, Role, Row, Study};
use crate::experiment::break_even::BreakEven;
use crate::table::markdown::significant;
use serde::Serialize;
use std::collections::BTreeMap;

/// Digits of an error in a sentence.
const ERROR_DIGITS: usize = 2;
/// Digits of a time or a ratio in a sentence.
const TIME_DIGITS: usize = 3;

/// The answer, largest part first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// The number that answers, short enough for large type; empty when no one number does.
    pub number: String,
    /// What the number counts.
    pub unit: String,
    /// The answer as a sentence with its numbers and interval.
    pub sentence: String,
    /// Further facts, one sentence each.
    pub facts: Vec<String>,
}

/// Writes the answer for joined runs.
pub fn answer(study: &Study, analysis: &Analysis) -> Answer {
    let pair = analysis.pairs.iter().find_map(|pair| Some((pair, pair.quartiles()?)));
    match pair {
        Some((pair, quartiles)) => from_pair(study, analysis, pair, quartiles),
        None => from_variants(study),
    }
}

fn from_pair(study: &Study, analysis: &Analysis, pair: &Pair, [lower, middle, upper]: [BreakEven; 3]) -> Answer {
    let (sampled, fixed) = (&pair.sampled, &pair.fixed);
    let count = pair.cases.len();
    let breadth = breadth(study, analysis);
    let interval = if lower == upper { lower.to_string() } else { format!("{lower} to {upper}") };
    let sentence = match middle {
        BreakEven::From(n) => format!(
            "From {n} {} a pixel on, {sampled} is closer to the reference than {fixed}: the median of {count} {}{breadth}. \
             The middle half of them breaks even at {interval} samples.",
            plural(n as usize, "sample"),
            plural(count, "case"),
        ),
        BreakEven::Above(n) => format!(
            "Up to {n} samples a pixel, {sampled} does not beat {fixed} in the median of {count} {}{breadth}. \
             The middle half of them breaks even at {interval} samples.",
            plural(count, "case"),
        ),
    };
    let mut facts = Vec::new();
    if let Some([best, worst]) = pair.extremes().filter(|[best, worst]| best != worst) {
        facts.push(format!("The easiest case breaks even at {best} samples, the hardest at {worst}."));
    }
    let mut crossings: Vec<f64> = pair.cases.iter().filter_map(|case| case.crossing).collect();
    crossings.sort_by(f64::total_cmp);
    if crossings.len() * 2 > count && crossings.len() > 2 {
        let at = |p: f64| significant(crossings[(p * (crossings.len() - 1) as f64).round() as usize], ERROR_DIGITS);
        facts.push(format!(
            "Between the tried counts, the curves cross at {} samples in the median ({} to {} for the middle half of the {} \
             cases that cross; log-log interpolation).",
            at(0.5),
            at(0.25),
            at(0.75),
            crossings.len()
        ));
    }
    if let BreakEven::From(n) = middle {
        facts.extend(time_fact(study, sampled, n, fixed));
    }
    Answer {
        number: middle.to_string(),
        unit: format!("samples a pixel for {sampled} to beat {fixed}"),
        sentence,
        facts,
    }
}

/// What a frame costs at break-even against the method without samples.
fn time_fact(study: &Study, sampled: &str, samples: u32, fixed: &str) -> Option<String> {
    let times = |method: &str, samples: &str| -> Vec<FrameTime> {
        let of_method = |row: &&Row| study.value(row, "method") == method && study.value(row, "samples") == samples;
        study.rows.iter().filter(of_method).filter_map(|row| row.frame_ms).collect()
    };
    let [at_break_even, without] = [times(sampled, &samples.to_string()), times(fixed, "")].map(|times| {
        let mut medians: Vec<f64> = times.iter().map(|time| time.median).collect();
        medians.sort_by(f64::total_cmp);
        medians.get(medians.len() / 2).copied()
    });
    let (at_break_even, without) = (at_break_even?, without?);
    Some(format!(
        "A frame then takes {} ms against {} ms for {fixed}: {} times as long.",
        significant(at_break_even, TIME_DIGITS),
        significant(without, TIME_DIGITS),
        significant(at_break_even / without, ERROR_DIGITS)
    ))
}

/// ` (2 environments, 3 brdfs, 5 alphas)` or nothing.
fn breadth(study: &Study, analysis: &Analysis) -> String {
    let axes = study.axes.iter().filter(|axis| analysis.case_axes.contains(&axis.name));
    let counts: Vec<String> = axes
        .map(|axis| {
            let count = axis.values.iter().filter(|value| !value.is_empty()).count();
            format!("{count} × {}", axis.name)
        })
        .collect();
    if counts.is_empty() { String::new() } else { format!(" ({})", counts.join(", ")) }
}

/// Without a pair to break even: which way of making the image has the lowest median error.
fn from_variants(study: &Study) -> Answer {
    let axes: Vec<usize> = (0..study.axes.len()).filter(|&axis| study.axes[axis].role == Role::Variant).collect();
    let mut errors: BTreeMap<Vec<&str>, Vec<f64>> = BTreeMap::new();
    // The image without a specular term is there for scale; it is no way to make one.
    for row in study.rows.iter().filter(|row| study.value(row, "method") != "none") {
        if let Some(error) = row.error {
            errors.entry(axes.iter().map(|&axis| row.axes[axis].as_str()).collect()).or_default().push(error);
        }
    }
    let mut ranked: Vec<(f64, String, Vec<f64>)> = errors
        .into_iter()
        .map(|(words, mut errors)| {
            errors.sort_by(f64::total_cmp);
            let words: Vec<&str> = words.into_iter().filter(|word| !word.is_empty()).collect();
            (errors[errors.len() / 2], words.join(" "), errors)
        })
        .collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some((error, name, errors)) = ranked.first() else {
        return Answer {
            number: String::new(),
            unit: String::new(),
            sentence: "No cell is done yet, so there is no answer.".to_owned(),
            facts: Vec::new(),
        };
    };
    let text = |error: f64| significant(error, ERROR_DIGITS);
    let at = |p: f64| text(errors[(p * (errors.len() - 1) as f64).round() as usize]);
    let spread = if errors.first() != errors.last() {
        format!(" (median of {} cells, the middle half from {} to {})", errors.len(), at(0.25), at(0.75))
    } else {
        String::new()
    };
    let facts = ranked.iter().skip(1).take(3).map(|(e, n, _)| format!("Next: {n} with {}.", text(*e)));
    Answer {
        number: text(*error),
        unit: format!("relative squared error of {name}, the lowest of {}", ranked.len()),
        sentence: format!("{name} comes closest to the reference: relMSE {}{spread}.", text(*error)),
        facts: facts.collect(),
    }
}

fn plural(count: usize, word: &str) -> String {
    if count == 1 { word.to_owned() } else { format!("{word}s") }
}
