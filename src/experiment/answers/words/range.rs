//! What the environment's peaks do to the error.

use super::{Answer, ERROR_DIGITS, FACTS_OF_A_KIND};
use crate::experiment::answers::Answers;
use crate::experiment::answers::dynamic_range::{Growth, growth};
use crate::table::markdown::significant;

pub(super) fn from_range(answers: &Answers) -> Option<Answer> {
    let mut growth = growth(&answers.dynamic_range);
    // What has no samples first: it is what the question is about; then the steepest.
    let draws = |method: &str| method.contains(' ');
    growth.sort_by(|a, b| draws(&a.method).cmp(&draws(&b.method)).then(b.fit.value.total_cmp(&a.fit.value)));
    let text = |x: f64| significant(x.exp(), ERROR_DIGITS);
    let say = |one: &Growth| {
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
