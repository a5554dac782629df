//! Whether the claimed sample counts suffice.

use super::{Answer, ERROR_DIGITS, in_brackets, listed};
use crate::study::answers::Answers;
use crate::study::answers::claim::{Against, CLAIMED, Sufficiency};
use crate::study::answers::exposure::VISIBLE_FROM;
use crate::table::markdown::significant;

fn text(x: f64) -> String {
    significant(x, ERROR_DIGITS)
}

/// `0.1 to 0.2` of the two counts, or one of them where they are equal.
fn ends(of: &[&Sufficiency; 2], value: impl Fn(&Sufficiency) -> f64) -> String {
    let [a, b] = of.map(|one| text(value(one)));
    if a == b { a } else { format!("{a} to {b}") }
}

/// What the two counts do: against the method without samples, and to the eye.
fn says(of: &[&Sufficiency; 2]) -> String {
    let last = of[1];
    let method = &last.method;
    let beats = match of.map(|one| one.against.as_ref().map(|against| (one.samples, against))) {
        [Some(few), Some(many)] => {
            let over = if many.1.n > 1 { format!(" of {} cases", many.1.n) } else { String::new() };
            let say = |(_, against): (u32, &Against)| {
                format!("{} times{}", text(against.ratio), in_brackets(against.interval))
            };
            format!(
                "with {method} the error is in the geometric mean{over} {} that of {} at {} samples and {} at {}",
                say(few),
                many.1.fixed,
                few.0,
                say(many),
                many.0
            )
        }
        _ => format!("with {method} they err by a relMSE of {}", ends(of, |one| one.error.median)),
    };
    let flips = of.map(|one| one.flip);
    let seen = flips[0].zip(flips[1]).map(|(a, b)| {
        let verdict = match () {
            () if a.median >= VISIBLE_FROM && b.median >= VISIBLE_FROM => "the difference stays visible",
            () if a.median < VISIBLE_FROM && b.median < VISIBLE_FROM => "the difference is hidden",
            () => "the difference is at the edge of visibility",
        };
        let [x, y] = [a.median, b.median].map(text);
        let flip = if x == y { x } else { format!("{x} to {y}") };
        let cases = match b.n {
            1 => String::new(),
            n => format!(", visible in {} of {n} cases at {}", last.visible, last.samples),
        };
        format!("{verdict} (mean FLIP {flip}{cases})")
    });
    match seen {
        Some(seen) => format!("{beats}, and {seen}"),
        None => beats,
    }
}

pub(super) fn from_claim(answers: &Answers) -> Option<Answer> {
    let all = &answers.sufficiency;
    let mut methods: Vec<&str> = Vec::new();
    let mut models: Vec<&str> = Vec::new();
    for one in all {
        if !methods.contains(&one.method.as_str()) {
            methods.push(&one.method);
        }
        if let Some(model) = one.model.as_deref().filter(|model| !models.contains(model)) {
            models.push(model);
        }
    }
    let counts = |method: &str, model: Option<&str>| -> Option<[&Sufficiency; 2]> {
        let at = |samples: u32| {
            all.iter().find(|one| one.method == method && one.samples == samples && one.model.as_deref() == model)
        };
        Some([at(CLAIMED[0])?, at(CLAIMED[1])?])
    };
    // With the filter first: it is what the claim is about.
    methods.sort_by_key(|method| *method != FILTERED);
    let [first, ..] = methods.as_slice() else { return None };
    let lead = counts(first, None)?;
    let parts: Vec<String> = methods.iter().filter_map(|method| Some(says(&counts(method, None)?))).collect();
    let [few, many] = CLAIMED;
    let is_beaten = lead.map(|one| one.against.as_ref().map(|against| against.interval[1] < 1.0));
    let are_hidden = lead.iter().all(|one| one.flip.is_some_and(|flip| flip.median < VISIBLE_FROM));
    let hide = if are_hidden { "hide" } else { "do not hide" };
    let verdict = match (is_beaten, lead[1].against.as_ref().map(|against| &against.fixed)) {
        (_, None) => format!("{few} to {many} samples {hide} the error"),
        ([_, Some(true)], Some(fixed)) => {
            let who = match is_beaten[0] {
                Some(true) => format!("{few} to {many} samples beat {fixed}"),
                _ => format!("{many} samples beat {fixed}, {few} not for sure,"),
            };
            format!("{who} {} {hide} the error", if are_hidden { "and" } else { "but" })
        }
        (_, Some(fixed)) => {
            let and = if are_hidden { "but" } else { "and" };
            format!("{few} to {many} samples do not beat {fixed} for sure, {and} {hide} the error")
        }
    };
    let mut facts: Vec<String> = Vec::new();
    for model in &models {
        let of_model: Vec<String> =
            methods.iter().filter_map(|method| Some(says(&counts(method, Some(model))?))).collect();
        facts.push(format!("{model}: {}.", of_model.join("; ")));
    }
    facts.extend(methods.iter().filter_map(|method| remaining(&counts(method, None)?)));
    facts.extend(methods.iter().map(|method| hidden_from(all, method)));
    facts.push(format!("Visible is a mean FLIP of at least {VISIBLE_FROM}, {}.", super::tone::SOURCE));
    Some(Answer {
        number: lead[1].against.as_ref().map_or_else(|| text(lead[1].error.median), |a| format!("×{}", text(a.ratio))),
        unit: match &lead[1].against {
            Some(against) => {
                let mean = if against.n > 1 { ", geometric mean; the charts draw medians" } else { "" };
                format!("the error of {} with {first} at {many} samples{mean}", against.fixed)
            }
            None => format!("relMSE of {first} at {many} samples"),
        },
        sentence: format!("{verdict}: {}.", parts.join("; ")),
        facts,
    })
}

/// What more samples could not remove, where bias and variance were parted.
fn remaining(of: &[&Sufficiency; 2]) -> Option<String> {
    let say = |one: &&Sufficiency| {
        let [mostly, all] = one.mostly_bias;
        (all > 0).then(|| format!("{mostly} of {all} cases at {}", one.samples))
    };
    let cases: Option<Vec<String>> = of.iter().map(say).collect();
    let method = &of[0].method;
    Some(format!(
        "With {method} the bias, which more samples cannot remove, outweighs the noise in {}.",
        cases?.join(" and ")
    ))
}

/// The method with the mip filter.
const FILTERED: &str = "sampled";

/// From which tried count on a viewer notices nothing.
fn hidden_from(all: &[Sufficiency], method: &str) -> String {
    let mut own: Vec<&Sufficiency> = all.iter().filter(|one| one.method == method && one.model.is_none()).collect();
    own.sort_by_key(|one| one.samples);
    let is_hidden = |one: &&&Sufficiency| one.flip.is_some_and(|flip| flip.median < VISIBLE_FROM);
    let tried = listed(&own.iter().map(|one| one.samples.to_string()).collect::<Vec<_>>());
    match own.iter().rev().take_while(is_hidden).last() {
        Some(one) => format!("With {method} the difference is hidden from {} samples on, of {tried}.", one.samples),
        None => format!("With {method} the difference is visible at all of {tried} samples."),
    }
}
