//! How large tables must be.

use super::{Answer, ERROR_DIGITS, change, listed, plural, sentence_case};
use crate::study::answers::Answers;
use crate::study::answers::effects::Effect;
use crate::study::answers::sizes::{Enough, GAIN, leading};
use crate::table::markdown::significant;

/// Which pairs these are: those of the chart and of `effects.csv` are more.
const SUBSET: &str = "Each parameter is judged by those pairs alone in which the other parameters of the tables have the first value of the \
                      experiment or a larger one; the chart and effects.csv have all pairs.";

/// `(95 % +1.0 % to +3.2 %)` of a ratio.
fn changes(effect: &Effect) -> String {
    match effect.interval[1].is_finite() {
        true => format!("{}, 95 % {}", change(effect.ratio), effect.interval.map(change).join(" to ")),
        false => format!("{}, without an interval", change(effect.ratio)),
    }
}

fn costs(one: &Enough) -> Option<String> {
    let below = one.below.as_ref()?;
    let times = significant(below.ratio, super::TIME_DIGITS);
    let (verb, doubt) = match below.is_decided() {
        true => ("multiplies", ""),
        false => ("may multiply", "; the interval does not tell which one errs less"),
    };
    let interval = match below.interval[1].is_finite() {
        true => format!("95 % {}, ", below.interval.map(|end| significant(end, ERROR_DIGITS)).join(" to ")),
        false => String::new(),
    };
    let noise = super::noise_words(below);
    let (n, cases) = (below.n, plural(below.n, "case"));
    Some(format!("{} {} {verb} the error by {times} ({interval}{n} {cases}{noise}{doubt})", one.axis, below.value))
}

pub(super) fn from_sizes(answers: &Answers) -> Option<Answer> {
    let method = &answers.enough.first()?.method;
    let own: Vec<&Enough> = answers.enough.iter().filter(|one| one.method == *method).collect();
    let names = |of: &dyn Fn(&Enough) -> bool| -> Vec<String> {
        own.iter().filter(|one| of(one)).map(|one| format!("{} {}", one.axis, one.together)).collect()
    };
    let (settled, largest) = (names(&|one| one.beyond.is_some()), names(&|one| one.beyond.is_none()));
    let gain = own.iter().filter_map(|one| one.beyond.as_ref()).min_by(|a, b| a.ratio.total_cmp(&b.ratio));
    let settled = gain.map(|effect| {
        let doubt = if effect.interval[0] < 1.0 - GAIN { ", which leaves a larger gain open" } else { "" };
        format!(
            "from {} on a larger one takes at most {} % off the error of {method} (the one that does most, {} {}, changes it by {}{doubt})",
            listed(&settled),
            100.0 * GAIN,
            effect.axis,
            effect.value,
            changes(effect)
        )
    });
    let largest = match largest.as_slice() {
        [] => None,
        some => Some(format!("of {} no larger one was tried", listed(some))),
    };
    let fewer: Vec<String> = own.iter().filter_map(|one| costs(one)).collect();
    let fewer = match fewer.as_slice() {
        [] => None,
        some => Some(format!("less costs: {}", listed(some))),
    };
    let fact = |one: &Enough| {
        let below = costs(one).unwrap_or_else(|| "no smaller one was tried beside such others".to_owned());
        let beyond = one.beyond.as_ref().map_or_else(
            || "no larger one was tried".to_owned(),
            |effect| {
                let doubt = if effect.interval[0] < 1.0 - GAIN { ", which leaves a gain open" } else { "" };
                let cases = plural(effect.n, "case");
                format!("{} changes the error by {} ({} {cases}){doubt}", effect.value, changes(effect), effect.n)
            },
        );
        let beside = match one.together == one.value {
            true => String::new(),
            false => format!(", {} beside what the others need", one.together),
        };
        format!("{} {} for {}{beside}: {beyond}; {below}.", one.axis, one.value, one.method)
    };
    let parts: Vec<String> = [settled, largest, fewer].into_iter().flatten().collect();
    let lead = leading(&answers.enough)?;
    Some(Answer {
        number: lead.together.clone(),
        unit: match lead.beyond {
            Some(_) => {
                format!("{} from which on a larger one takes at most {} % off the error", lead.axis, 100.0 * GAIN)
            }
            None => format!("{}, the largest tried", lead.axis),
        },
        sentence: sentence_case(&parts.join("; ")) + ".",
        // Of the method in the sentence, what has no larger value tried stands there in whole.
        facts: answers
            .enough
            .iter()
            .filter(|one| one.method != *method || one.beyond.is_some())
            .map(fact)
            .chain((answers.enough.len() > 1).then(|| SUBSET.to_owned()))
            .collect(),
    })
}
