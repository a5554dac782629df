//! The answer in words: one headline sentence with its numbers, and what qualifies it.

use super::Answers;
use super::break_even::BreakEven;
use super::cases::{Pair, Winner};
use super::dynamic_range::growth;
use super::effects::Effect;
use super::exposure::{Hiding, VISIBLE_FROM, hiding};
use super::study::{FrameTime, Role, Row, Study, short};
use super::times::FrameRatio;
use crate::experiment::axis::REFERENCE;
use crate::experiment::statistics::median;
use crate::shade::METHODS;
use crate::table::markdown::significant;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Digits of an error in a sentence.
const ERROR_DIGITS: usize = 2;
/// Digits of a time or a ratio in a sentence.
const TIME_DIGITS: usize = 3;
/// Sentences of one kind beside the headline.
const FACTS_OF_A_KIND: usize = 4;

/// The answer, largest part first.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
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

/// Writes the answer for joined runs. An experiment with more tone curves than sample counts asks what the curve shows, one that cuts off the
/// peaks of its light what they do; else break-even leads where there is one, else times; then what a parameter changes, then which way is best. What
/// does not lead follows as facts.
pub fn answer(study: &Study, answers: &Answers) -> Answer {
    let pair = answers.pairs.iter().find_map(|pair| Some(from_pair(study, answers, pair, pair.quartiles()?)));
    let clips = study.axis("environment_clip_log2").is_some_and(|axis| study.axes[axis].values.len() > 1);
    let mut leads: Vec<Answer> = Vec::new();
    let values = |axis: usize| study.axes[axis].values.len();
    let curves: usize = study.display_axes().into_iter().map(values).product();
    let (asks_the_curve, visibility) = (curves > study.axis("samples").map_or(1, values), from_visibility(answers));
    leads.extend(visibility.clone().filter(|_| asks_the_curve));
    leads.extend(if clips { from_range(answers) } else { None });
    leads.extend(match pair {
        None => from_times(study, answers),
        pair => pair,
    });
    leads.extend(visibility.filter(|_| !asks_the_curve));
    leads.extend(from_effects(study, answers));
    if leads.is_empty() {
        leads.push(from_variants(study));
    }
    let mut leads = leads.into_iter();
    let mut first = leads.next().expect("one was just added");
    for other in leads {
        first.facts.push(other.sentence);
        first.facts.extend(other.facts);
    }
    first.facts.extend(copies(study));
    first
}

/// How many cells count once, where some do.
fn copies(study: &Study) -> Option<String> {
    let (rows, copies) = (study.rows.len(), study.copy_count());
    (copies > 0).then(|| {
        format!(
            "{copies} of the {} cells differ from another one only in what cannot reach their pixels; each image counts once, so \
             these numbers are of {rows} cells.",
            rows + copies
        )
    })
}

fn from_visibility(answers: &Answers) -> Option<Answer> {
    // The image without a specular term is there for scale.
    let hiding: Vec<Hiding> = hiding(&answers.visibility).into_iter().filter(|one| one.method != "none").collect();
    let strongest = hiding.iter().max_by(|a, b| a.peak.1.total_cmp(&b.peak.1))?;
    let text = |x: f64| significant(x, ERROR_DIGITS);
    let say = |one: &Hiding| {
        let hidden = match one.hidden_at.as_slice() {
            [] => "is visible at every tried exposure".to_owned(),
            all if all.len() == one.tried.len() => "is hidden at every tried exposure".to_owned(),
            some => format!("is hidden at {}", some.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")),
        };
        format!(
            "At contrast {} the error of {} shows most at exposure {} (FLIP {}) and {hidden}.",
            one.contrast,
            one.method,
            one.peak.0,
            text(one.peak.1)
        )
    };
    // Contrast 1 first, the curve as it is; methods without samples before the others, and those with most samples next, as listed.
    let mut order: Vec<&Hiding> = hiding.iter().collect();
    let samples =
        |one: &Hiding| one.method.rsplit(' ').next().and_then(|n| n.parse::<f64>().ok()).unwrap_or(f64::INFINITY);
    order.sort_by(|a, b| {
        let distance = |one: &Hiding| (one.contrast - 1.0).abs();
        let listed = |one: &Hiding| METHODS.iter().position(|method| one.method.split(' ').next() == Some(method.name));
        distance(a).total_cmp(&distance(b)).then(samples(b).total_cmp(&samples(a))).then(listed(a).cmp(&listed(b)))
    });
    let lead = order[0];
    Some(Answer {
        number: lead.peak.0.to_string(),
        unit: format!("the exposure at which the error of {} shows most", lead.method),
        sentence: say(lead),
        facts: order
            .iter()
            .skip(1)
            .filter(|one| one.contrast == lead.contrast)
            .take(FACTS_OF_A_KIND)
            .map(|one| say(one))
            .chain([format!(
                "The strongest visible error is that of {} at exposure {} and contrast {}: FLIP {}. Hidden means a mean FLIP \
                 below {VISIBLE_FROM}.",
                strongest.method,
                strongest.peak.0,
                strongest.contrast,
                text(strongest.peak.1)
            )])
            .collect(),
    })
}

fn from_range(answers: &Answers) -> Option<Answer> {
    let mut growth = growth(&answers.dynamic_range);
    // What has no samples first: it is what the question is about; then the steepest.
    let draws = |method: &str| method.contains(' ');
    growth.sort_by(|a, b| draws(&a.method).cmp(&draws(&b.method)).then(b.fit.value.total_cmp(&a.fit.value)));
    let text = |x: f64| significant(x.exp(), ERROR_DIGITS);
    let say = |one: &super::dynamic_range::Growth| {
        format!(
            "The error of {} in {} changes by a factor of {} per stop of dynamic range (95 % {} to {}; a line through the logarithms \
             of {} medians, which need not lie on one).",
            one.method,
            one.series,
            text(one.fit.value),
            text(one.fit.lo),
            text(one.fit.hi),
            one.fit.n
        )
    };
    let [first, rest @ ..] = growth.as_slice() else { return None };
    Some(Answer {
        number: format!("×{}", text(first.fit.value)),
        unit: format!("the error of {} per stop of dynamic range of {}", first.method, first.series),
        sentence: say(first),
        facts: rest.iter().take(FACTS_OF_A_KIND).map(say).collect(),
    })
}

/// Axes that choose an estimator. An experiment that sweeps one asks about it, whatever it sweeps beside.
const ESTIMATORS: [&str; 2] = ["method", "diffuse"];

fn from_effects(study: &Study, answers: &Answers) -> Option<Answer> {
    let mut all: Vec<&Effect> = answers.effects.iter().filter(|effect| effect.alpha.is_none()).collect();
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
        format!(
            "{} {value} instead of {base} {} the error{method} by {} ({interval}{} {}){}.",
            effect.axis,
            if effect.is_decided() { "multiplies" } else { "may multiply" },
            text(effect.ratio),
            effect.n,
            plural(effect.n, "pair"),
            match effect.interval[1].is_finite() {
                _ if effect.is_decided() => "",
                true => ": the interval does not tell which one errs less",
                false => ", without an interval",
            }
        )
    };
    let first = all.first()?;
    let rest = all.iter().skip(1).take(FACTS_OF_A_KIND).map(|effect| say(effect));
    Some(Answer {
        number: format!("×{}", text(first.ratio)),
        unit: format!("the error with {} {} instead of {}", first.axis, first.value, first.base),
        sentence: say(first),
        facts: base_error(study, first).into_iter().chain(best_values(&all)).chain(rest).collect(),
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
            "{} errs by a relMSE of {middle} in the median of {} cases, from {least} to {most}.",
            effect.base,
            errors.len()
        )
    })
}

/// Which value of each parameter with three or more errs least, for each method that has it. `all` holds the effects over all alphas.
fn best_values(all: &[&Effect]) -> Vec<String> {
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
        let doubt = if least.is_decided() { "" } else { "; the interval does not tell the two apart" };
        Some(match least.ratio < 1.0 {
            true => format!(
                "Of the tried {axis}, {value} errs least{of}: {ratio} times the error with {base}{interval}{doubt}."
            ),
            false => format!(
                "Of the tried {axis}, {base} errs least{of}; the next, {value}, multiplies the error by {ratio}{interval}{doubt}."
            ),
        })
    };
    groups.into_iter().filter_map(best).collect()
}

fn from_pair(study: &Study, answers: &Answers, pair: &Pair, [lower, middle, upper]: [BreakEven; 3]) -> Answer {
    let (sampled, fixed) = (&pair.sampled, &pair.fixed);
    let count = pair.cases.len();
    let breadth = breadth(answers, pair);
    let interval = if lower == upper { lower.to_string() } else { format!("{lower} to {upper}") };
    let sentence = match middle {
        BreakEven::From(n) => format!(
            "From {n} {} a pixel on{censored}, {sampled} is closer to the reference than {fixed}: the median of {count} {}{breadth}. \
             The middle half of them breaks even at {interval} samples.",
            plural(n as usize, "sample"),
            plural(count, "case"),
            // Fewer were not tried, so the answer is an upper bound.
            censored = if n == pair.tried()[0] { " at the latest, the fewest that were tried" } else { "" },
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
    let mut crossings: Vec<f64> = pair.cases.iter().filter_map(|case| case.whole.crossing).collect();
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
        facts.extend(time_fact(study, answers, sampled, n, fixed));
    }
    facts.extend(equal_time_fact(pair));
    Answer {
        number: middle.to_string(),
        unit: format!("samples a pixel for {sampled} to beat {fixed}"),
        sentence,
        facts,
    }
}

/// Who errs less in equal time, over the cases.
fn equal_time_fact(pair: &Pair) -> Option<String> {
    let timed: Vec<Winner> =
        pair.cases.iter().map(|case| case.whole.at_equal_time).filter(|winner| *winner != Winner::NotTimed).collect();
    let count = |wanted: Winner| timed.iter().filter(|winner| **winner == wanted).count();
    (!timed.is_empty()).then(|| {
        format!(
            "In equal frame time {} errs less in {} of {} cases and {} in {}; {} are undecided.",
            pair.sampled,
            count(Winner::Sampled),
            timed.len(),
            pair.fixed,
            count(Winner::Fixed),
            count(Winner::Undecided)
        )
    })
}

/// Median frame time of a method at a sample count (empty for none) over the cells that were timed, ms.
fn frame_ms(study: &Study, method: &str, samples: &str) -> Option<f64> {
    let of_method = |row: &&Row| study.value(row, "method") == method && study.value(row, "samples") == samples;
    let times = study.images().into_iter().filter(of_method).filter_map(|row: &Row| row.frame_ms);
    let mut medians: Vec<f64> = times.map(|time: FrameTime| time.median).collect();
    medians.sort_by(f64::total_cmp);
    medians.get(medians.len() / 2).copied()
}

/// What a frame costs at break-even against the method without samples.
fn time_fact(study: &Study, answers: &Answers, sampled: &str, samples: u32, fixed: &str) -> Option<String> {
    let samples = samples.to_string();
    let (at_break_even, without) = (frame_ms(study, sampled, &samples)?, frame_ms(study, fixed, "")?);
    Some(format!(
        "A frame then takes {} ms against {} ms for {fixed}, medians over what was timed{}.",
        significant(at_break_even, TIME_DIGITS),
        significant(without, TIME_DIGITS),
        ratio_words(answers, sampled, &samples, fixed).map_or_else(String::new, |(_, words)| format!(": {words}"))
    ))
}

/// Median and words of the ratios of frame times, each taken pair by pair in the same rounds.
fn ratio_words(answers: &Answers, sampled: &str, samples: &str, fixed: &str) -> Option<(f64, String)> {
    let is_it = |ratio: &&FrameRatio| ratio.sampled == sampled && ratio.samples == samples && ratio.fixed == fixed;
    let own: Vec<&FrameRatio> = answers.frame_ratios.iter().filter(is_it).collect();
    let range = |of: &dyn Fn(&FrameRatio) -> [f64; 2]| {
        let ends =
            own.iter().map(|ratio| of(ratio)).fold([f64::INFINITY, 0.0f64], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        ends.map(|end| significant(end, ERROR_DIGITS)).join(" to ")
    };
    let middle = median(&own.iter().map(|ratio| ratio.ratio).collect::<Vec<_>>());
    let interval = range(&|ratio| ratio.interval);
    let words = match own.len() {
        0 => return None,
        1 => format!("{} times as long (95 % {interval})", significant(middle, ERROR_DIGITS)),
        count => format!(
            "{} times as long in {count} configurations, whose 95 % intervals reach from {interval}",
            range(&|ratio| [ratio.ratio; 2])
        ),
    };
    Some((middle, words))
}

/// Where methods were timed but too few sample counts tried to break even: what a frame costs with each.
fn from_times(study: &Study, answers: &Answers) -> Option<Answer> {
    let mut ways: Vec<(&str, &str)> = Vec::new();
    for row in study.rows.iter().filter(|row| row.frame_ms.is_some()) {
        let way = (study.value(row, "method"), study.value(row, "samples"));
        if way.0 != "none" && !ways.contains(&way) {
            ways.push(way);
        }
    }
    let fixed = ways.iter().find(|way| way.1.is_empty())?;
    let without = frame_ms(study, fixed.0, "")?;
    let mut ratios = ways.iter().filter(|way| !way.1.is_empty()).filter_map(|(method, samples)| {
        let ms = frame_ms(study, method, samples)?;
        let (ratio, words) = ratio_words(answers, method, samples, fixed.0)?;
        let sentence = format!(
            "A frame of {method} with {samples} samples takes {} ms against {} ms for {}, medians over what was timed: {words}.",
            significant(ms, TIME_DIGITS),
            significant(without, TIME_DIGITS),
            fixed.0
        );
        let ratio = significant(ratio, ERROR_DIGITS);
        Some((ratio, format!("frame time of {method} with {samples} samples over that of {}", fixed.0), sentence))
    });
    let (ratio, unit, sentence) = ratios.next()?;
    Some(Answer {
        number: format!("×{ratio}"),
        unit,
        sentence,
        facts: ratios.map(|(_, _, sentence)| sentence).collect(),
    })
}

/// ` (2 × environment, 3 × brdf, 5 × alpha)` or nothing: the values among the cases, which need not have every combination.
fn breadth(answers: &Answers, pair: &Pair) -> String {
    let counts = answers.case_axes.iter().enumerate().filter_map(|(axis, name)| {
        let values: BTreeSet<&str> = pair.cases.iter().map(|case| case.key[axis].as_str()).collect();
        let count = values.iter().filter(|value| !value.is_empty()).count();
        (count > 1).then(|| format!("{count} × {name}"))
    });
    let counts: Vec<String> = counts.collect();
    if counts.is_empty() { String::new() } else { format!(" ({})", counts.join(", ")) }
}

/// Without a pair to break even: which way of making the image has the lowest median error.
fn from_variants(study: &Study) -> Answer {
    let axes: Vec<usize> = (0..study.axes.len())
        .filter(|&axis| study.axes[axis].role == Role::Variant && study.axes[axis].name != "point_set")
        .collect();
    let mut errors: BTreeMap<Vec<&str>, Vec<f64>> = BTreeMap::new();
    // The image without a specular term is there for scale; it is no way to make one.
    for row in study.images().into_iter().filter(|row| study.value(row, "method") != "none") {
        // An image that is its own reference errs by nothing and answers nothing.
        if let Some(error) = row.error.filter(|error| *error > 0.0) {
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
    if ranked.len() == 1 {
        return Answer {
            number: text(*error),
            unit: "relative squared error against the reference".to_owned(),
            sentence: match name.as_str() {
                REFERENCE => format!(
                    "What the reference method renders differs from what judges it by a relMSE of {}{spread}.",
                    text(*error)
                ),
                _ => format!("{name} differs from its reference by a relMSE of {}{spread}.", text(*error)),
            },
            facts: Vec::new(),
        };
    }
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
