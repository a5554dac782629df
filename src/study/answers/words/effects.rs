//! What a parameter of a method changes.

use super::{Answer, ERROR_DIGITS, FACTS_OF_A_KIND, TIME_DIGITS, plural};
use crate::runner::statistics::median;
use crate::study::answers::Answers;
use crate::study::answers::effects::Effect;
use crate::study::answers::study::{Study, preset, short};
use crate::table::markdown::significant;
use std::collections::BTreeMap;

/// Axes that choose an estimator. An experiment that sweeps one asks about it, whatever it sweeps beside.
pub(super) const ESTIMATORS: [&str; 2] = ["method", "diffuse"];

/// In how many cases an effect errs less than its base: the headline where the interval does not tell.
fn better(effect: &Effect) -> String {
    format!("{} of {}", effect.better, effect.n)
}

pub(super) fn from_effects(study: &Study, answers: &Answers, sizes_are_asked: bool) -> Option<Answer> {
    // Where sizes of tables are what is asked they have an answer of their own, which does not set tables side by side that are too
    // small in another way.
    let is_size = |effect: &Effect| sizes_are_asked && answers.enough.iter().any(|one| one.axis == effect.axis);
    let mut all: Vec<&Effect> =
        answers.effects.iter().filter(|effect| effect.alpha.is_none() && !is_size(effect)).collect();
    // Estimators before their parameters, what is decided first, then the strongest, whichever its direction.
    let is_parameter = |effect: &Effect| !ESTIMATORS.contains(&effect.axis.as_str());
    let strength = |effect: &Effect| effect.ratio.ln().abs();
    all.sort_by(|a, b| {
        let order = (is_parameter(a), b.is_decided()).cmp(&(is_parameter(b), a.is_decided()));
        order.then(strength(b).total_cmp(&strength(a)))
    });
    let text = |x: f64| significant(x, TIME_DIGITS);
    let say = |effect: &Effect| {
        let interval = match effect.interval[1].is_finite() {
            true => format!("95 % {} to {}, ", text(effect.interval[0]), text(effect.interval[1])),
            false => String::new(),
        };
        let method = match (effect.axis.as_str(), effect.method.as_str()) {
            (_, "" | "none") => String::new(),
            ("method", samples) => format!(" at {samples} samples"),
            (_, method) => format!(" of {method}"),
        };
        let [value, base] = [&effect.value, &effect.base].map(|value| short(&effect.axis, value));
        let in_noise = super::noise_words(effect);
        // The name of an estimator says what it is.
        let axis = if is_parameter(effect) { format!("{} ", effect.axis) } else { String::new() };
        format!(
            "{axis}{value} instead of {base} {} the error{method} by {} ({interval}{} {}{in_noise}){}",
            if effect.is_decided() { "multiplies" } else { "may multiply" },
            text(effect.ratio),
            effect.n,
            plural(effect.n, "case"),
            match effect.interval[1].is_finite() {
                _ if effect.is_decided() => String::new(),
                true => format!(
                    ": it errs less in {} of {}, and the interval does not tell which one errs less",
                    effect.better, effect.n
                ),
                false => ", without an interval".to_owned(),
            }
        )
    };
    let first = all.first()?;
    let rest = all.iter().skip(1).take(FACTS_OF_A_KIND).map(|effect| say(effect) + ".");
    let mut best = best_values(&all);
    // The parameter beside an estimator is asked about with it, at the same sample count.
    let beside =
        best.iter().position(|(method, _)| !is_parameter(first) && method.rsplit(' ').next() == Some(&first.method));
    let beside = beside.map_or_else(String::new, |place| format!("; of {}", best.remove(place).1));
    let before = base_error(study, first).map_or_else(String::new, |text| text + "; ");
    let values = format!("{} {} instead of {}", first.axis, first.value, first.base);
    // A large number would sell what the interval leaves open.
    let (number, unit) = match (first.is_decided(), first.interval[1].is_finite()) {
        (true, _) => (format!("×{}", text(first.ratio)), format!("the error with {values}")),
        (false, true) => {
            let [lo, hi] = first.interval.map(text);
            let unit = format!(
                "cases err less with {values}; the error: × {}, 95 % {lo} to {hi}, undecided",
                text(first.ratio)
            );
            (better(first), unit)
        }
        (false, false) => (better(first), format!("cases err less with {values}; the error: × {}", text(first.ratio))),
    };
    Some(Answer {
        number,
        unit,
        sentence: format!("{before}{}{beside}.", say(first)),
        facts: presets(&all)
            .into_iter()
            .chain(best.into_iter().map(|(_, text)| format!("Of {text}.")))
            .chain(rest)
            .collect(),
    })
}

/// How much the diffuse method errs that the other is compared with.
fn base_error(study: &Study, effect: &Effect) -> Option<String> {
    let rows = study.images().into_iter().filter(|row| study.value(row, &effect.axis) == effect.base);
    let errors: Vec<f64> = rows.filter_map(|row| row.error).filter(|error| *error > 0.0).collect();
    let (least, most) = errors.iter().fold((f64::MAX, 0.0f64), |(lo, hi), error| (lo.min(*error), hi.max(*error)));
    let text = |error: f64| significant(error, ERROR_DIGITS);
    (effect.axis == "diffuse" && !errors.is_empty()).then(|| {
        let [middle, least, most] = [median(&errors), least, most].map(text);
        format!(
            "{} errs by a relMSE of {middle} in the median of {} cases, from {least} to {most}",
            effect.base,
            errors.len()
        )
    })
}

/// What the values with names do, as those of engines: a sentence for each axis that has some and each method at its largest count.
fn presets(all: &[&Effect]) -> Vec<String> {
    let samples = |effect: &Effect| effect.method.rsplit(' ').next().and_then(|count| count.parse::<u32>().ok());
    let mut groups: BTreeMap<&str, Vec<&Effect>> = BTreeMap::new();
    for effect in all.iter().filter(|effect| preset(&effect.axis, &effect.value).is_some()) {
        groups.entry(&effect.axis).or_default().push(effect);
    }
    let text = |x: f64| significant(x, TIME_DIGITS);
    let sentence = |(axis, effects): (&str, Vec<&Effect>)| {
        let most = effects.iter().filter_map(|effect| samples(effect)).max();
        let mut own: Vec<&Effect> = effects.into_iter().filter(|effect| samples(effect) == most).collect();
        own.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
        let say = |effect: &&Effect| {
            let name = preset(axis, &effect.value).unwrap_or_default();
            let [lo, hi] = effect.interval.map(text);
            let interval = if effect.interval[1].is_finite() { format!(", 95 % {lo} to {hi}") } else { String::new() };
            format!("{name} ×{} ({}{interval})", text(effect.ratio), short(axis, &effect.value))
        };
        let first = own.first()?;
        Some(format!(
            "Presets of engines for {axis}, as multiples of the error of {} with {}: {}.",
            first.method,
            short(axis, &first.base),
            own.iter().map(say).collect::<Vec<_>>().join(", ")
        ))
    };
    groups.into_iter().filter_map(sentence).collect()
}

/// Which value of each parameter with three or more errs least, for each method that has it: the method, and what follows "of".
/// `all` holds the effects over all alphas.
fn best_values(all: &[&Effect]) -> Vec<(String, String)> {
    let mut groups: BTreeMap<(&str, &str), Vec<&Effect>> = BTreeMap::new();
    for effect in all.iter().filter(|effect| effect.axis != "method") {
        groups.entry((&effect.axis, &effect.method)).or_default().push(effect);
    }
    let text = |x: f64| significant(x, TIME_DIGITS);
    let best = |((axis, method), effects): ((&str, &str), Vec<&Effect>)| {
        let least = effects.iter().min_by(|a, b| a.ratio.total_cmp(&b.ratio)).filter(|_| effects.len() > 1)?;
        let of = if ["", "none"].contains(&method) { String::new() } else { format!(" for {method}") };
        let interval = match least.interval[1].is_finite() {
            true => format!(" (95 % {} to {})", text(least.interval[0]), text(least.interval[1])),
            false => String::new(),
        };
        let [value, base] = [&least.value, &least.base].map(|value| short(axis, value));
        let ratio = text(least.ratio);
        let (verb, doubt) = match least.is_decided() {
            true => ("multiplies", String::new()),
            false => (
                "may multiply",
                format!("; it errs less in {}, and the interval does not tell the two apart", better(least)),
            ),
        };
        let text = match least.ratio < 1.0 {
            true => {
                format!(
                    "the tried {axis}, {value} errs least{of}: {ratio} times the error with {base}{interval}{doubt}"
                )
            }
            false => format!(
                "the tried {axis}, {base} errs least{of}; the next, {value}, {verb} the error by {ratio}{interval}{doubt}"
            ),
        };
        Some((method.to_owned(), text))
    };
    groups.into_iter().filter_map(best).collect()
}
