//! How large tables must be.

use super::{Answer, change, in_brackets, listed, plural};
use crate::experiment::answers::Answers;
use crate::experiment::answers::effects::Effect;
use crate::experiment::answers::sizes::{Enough, GAIN};
use crate::table::markdown::significant;

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
    Some(format!("{} {} multiplies the error by {times}{}", one.axis, below.value, in_brackets(below.interval)))
}

pub(super) fn from_sizes(answers: &Answers) -> Option<Answer> {
    let method = &answers.enough.first()?.method;
    let own: Vec<&Enough> = answers.enough.iter().filter(|one| one.method == *method).collect();
    let enough = listed(&own.iter().map(|one| format!("{} {}", one.axis, one.value)).collect::<Vec<_>>());
    let gain = own.iter().filter_map(|one| one.beyond.as_ref()).min_by(|a, b| a.ratio.total_cmp(&b.ratio));
    let beyond = match gain {
        None => "no larger one was tried".to_owned(),
        Some(effect) => format!(
            "the larger one that does most, {} {}, changes it by {}",
            effect.axis,
            effect.value,
            changes(effect)
        ),
    };
    let fewer: Vec<String> = own.iter().filter_map(|one| costs(one)).collect();
    let fewer = match fewer.as_slice() {
        [] => String::new(),
        some => format!("; less costs: {}", listed(some)),
    };
    let fact = |one: &Enough| {
        let below = costs(one).map_or_else(|| "it is the smallest tried".to_owned(), |costs| costs);
        let beyond = one.beyond.as_ref().map_or_else(
            || "no larger one was tried".to_owned(),
            |effect| {
                let doubt = if effect.interval[0] < 1.0 - GAIN { ", which leaves a gain open" } else { "" };
                format!("{} changes it by {} ({} {}){doubt}", effect.value, changes(effect), effect.n, plural(effect.n, "pair"))
            },
        );
        format!("{} {} is enough for {}: {beyond}; {below}.", one.axis, one.value, one.method)
    };
    Some(Answer {
        number: own[0].value.clone(),
        unit: format!("{} from which on a larger one gains nothing", own[0].axis),
        sentence: format!(
            "From {enough} on nothing is gained, that is at most {} % of the error of {method}: {beyond}{fewer}.",
            100.0 * GAIN
        ),
        facts: answers.enough.iter().map(fact).collect(),
    })
}
