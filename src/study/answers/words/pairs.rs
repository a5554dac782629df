//! From how many samples on a sampling method wins.

use super::times::time_fact;
use super::{Answer, ERROR_DIGITS, plural};
use crate::runner::statistics::TOO_FEW_ROUNDS;
use crate::study::answers::Answers;
use crate::study::answers::break_even::BreakEven;
use crate::study::answers::cases::{Pair, Winner};
use crate::study::answers::study::Study;
use crate::table::markdown::significant;
use std::collections::BTreeSet;

pub(super) fn from_pair(
    study: &Study,
    answers: &Answers,
    pair: &Pair,
    [lower, middle, upper]: [BreakEven; 3],
) -> Answer {
    let (sampled, fixed) = (&pair.sampled, &pair.fixed);
    let count = pair.cases.len();
    let breadth = breadth(answers, pair);
    let middle_half = if lower == upper { lower.to_string() } else { format!("{lower} to {upper}") };
    let interval = pair.median_interval().map_or_else(String::new, |([lo, hi], _)| format!(", 95 % {lo} to {hi}"));
    let sentence = match middle {
        BreakEven::From(n) => format!(
            "From {n} {} a pixel on{censored}, {sampled} is closer to the reference than {fixed}: the median of {count} {}{breadth}{interval}. \
             The middle half of them breaks even at {middle_half} samples.",
            plural(n as usize, "sample"),
            plural(count, "case"),
            // Fewer were not tried, so the answer is an upper bound.
            censored = if n == pair.tried()[0] { " at the latest, the fewest that were tried" } else { "" },
        ),
        BreakEven::Above(n) => format!(
            "Up to {n} samples a pixel, {sampled} does not beat {fixed} in the median of {count} {}{breadth}{interval}. \
             The middle half of them breaks even at {middle_half} samples.",
            plural(count, "case"),
        ),
    };
    let mut facts: Vec<String> = equal_time_fact(pair).into_iter().collect();
    let (of_time, short) = equal_time(pair).unwrap_or_default();
    if let Some([best, worst]) = pair.extremes().filter(|[best, worst]| best != worst) {
        facts.push(format!("The easiest case breaks even at {best} samples, the hardest at {worst}."));
    }
    facts.extend(crossing_fact(pair));
    if let BreakEven::From(n) = middle {
        facts.extend(time_fact(study, answers, sampled, n, fixed));
    }
    Answer {
        number: middle.to_string(),
        unit: format!("samples a pixel for {sampled} to beat {fixed} at equal error{short}"),
        sentence: sentence + &of_time,
        facts,
    }
}

/// Where the curves cross between the tried counts; nothing where most do not.
fn crossing_fact(pair: &Pair) -> Option<String> {
    let crossings = pair.crossings();
    let between = crossings.iter().filter(|crossing| **crossing > 0.0 && crossing.is_finite()).count();
    if between * 2 <= crossings.len() || between <= 2 {
        return None;
    }
    let [least, most] = pair.tried();
    let text = |crossing: f64| match crossing {
        0.0 => format!("< {least}"),
        f64::INFINITY => format!("> {most}"),
        crossing => significant(crossing, ERROR_DIGITS),
    };
    let at = |p: f64| text(crossings[(p * (crossings.len() - 1) as f64).round() as usize]);
    let interval = pair.median_interval().map_or_else(String::new, |(_, ends)| {
        format!("95 % {}, which takes the cases for independent draws; ", ends.map(text).join(" to "))
    });
    Some(format!(
        "Between the tried counts, the curves cross at {} samples in the median ({interval}{} to {} for the middle half; log-log interpolation).",
        at(0.5),
        at(0.25),
        at(0.75),
    ))
}

/// What follows the sentence and the unit on equal time; nothing where no time was taken.
fn equal_time(pair: &Pair) -> Option<(String, String)> {
    let count = |wanted: &[Winner]| pair.cases.iter().filter(|case| wanted.contains(&case.whole.at_equal_time)).count();
    let timed = pair.cases.len() - count(&[Winner::NotTimed]);
    let (sampled, fixed) = (count(&[Winner::Sampled]), count(&[Winner::Fixed]));
    let told = match () {
        () if timed == 0 => return None,
        () if count(&[Winner::TooFewRounds]) == timed => {
            (" At equal time nothing is decided.".to_owned(), "not decided".to_owned())
        }
        () if fixed == timed => (
            format!(" At equal time it is never closer: {} errs less in {fixed} of {timed} cases.", pair.fixed),
            "never".to_owned(),
        ),
        () => (
            format!(" At equal time it is closer in {sampled} of {timed} cases, and {} in {fixed}.", pair.fixed),
            format!("in {sampled} of {timed} cases"),
        ),
    };
    Some((told.0, format!("; at equal time {}", told.1)))
}

/// Who errs less in equal time, over the cases.
fn equal_time_fact(pair: &Pair) -> Option<String> {
    let timed: Vec<Winner> =
        pair.cases.iter().map(|case| case.whole.at_equal_time).filter(|winner| *winner != Winner::NotTimed).collect();
    let count = |wanted: Winner| timed.iter().filter(|winner| **winner == wanted).count();
    (!timed.is_empty()).then(|| {
        let few = count(Winner::TooFewRounds);
        if few == timed.len() {
            return format!("Who errs less in equal frame time is not decided: {TOO_FEW_ROUNDS}.");
        }
        format!(
            "In equal frame time {} errs less in {} of {} cases and {} in {}; {} are undecided{}.",
            pair.sampled,
            count(Winner::Sampled),
            timed.len(),
            pair.fixed,
            count(Winner::Fixed),
            count(Winner::Undecided),
            if few > 0 { format!(", {few} have {TOO_FEW_ROUNDS}") } else { String::new() }
        )
    })
}

/// ` (2 environments, 3 BRDF models, 5 alphas)` or nothing: the values among the cases, which need not have every combination.
fn breadth(answers: &Answers, pair: &Pair) -> String {
    let counts = answers.case_axes.iter().enumerate().filter_map(|(axis, name)| {
        let values: BTreeSet<&str> = pair.cases.iter().map(|case| case.key[axis].as_str()).collect();
        let count = values.iter().filter(|value| !value.is_empty()).count();
        (count > 1).then(|| format!("{count} {}", several(name)))
    });
    let counts: Vec<String> = counts.collect();
    if counts.is_empty() { String::new() } else { format!(" ({})", counts.join(", ")) }
}

/// Several values of an axis, as people say it.
fn several(axis: &str) -> String {
    match axis {
        "brdf" => "BRDF models".to_owned(),
        "environment" | "alpha" | "scene" | "albedo" => format!("{axis}s"),
        other => format!("values of {other}"),
    }
}
