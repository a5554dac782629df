//! What the environment's peaks do to the error.

use super::{Answer, ERROR_DIGITS, FACTS_OF_A_KIND};
use crate::study::answers::Answers;
use crate::study::answers::dynamic_range::{Growth, growth};
use crate::table::markdown::significant;

/// Medians that lie within this factor of each other count as level.
const LEVEL: f64 = 1.5;
/// Over this share of the range at least: two neighbours are always close.
const LEVEL_SHARE: f64 = 1.0 / 3.0;

fn text(x: f64) -> String {
    significant(x, ERROR_DIGITS)
}

/// The path of the medians in words. A factor per stop would describe it only where it is a line, and it is not: errors saturate.
fn say(one: &Growth) -> String {
    let Growth { method, series, points, .. } = one;
    let at = |i: usize| format!("{} at {} stops", text(points[i].1), text(points[i].0));
    let last = points.len() - 1;
    let over = |points: &[(f64, f64)]| {
        let errors = points.iter().map(|point| point.1);
        errors.clone().fold(0.0, f64::max) / errors.fold(f64::INFINITY, f64::min)
    };
    let subject = format!("The error of {method} in {series}");
    if over(points) <= LEVEL {
        return format!("{subject} is level, {} to {} (within a factor of {}).", at(0), at(last), text(over(points)));
    }
    let is_long = |i: usize| points[last].0 - points[i].0 >= LEVEL_SHARE * (points[last].0 - points[0].0);
    let level_from = (0..last).find(|&i| over(&points[i..]) <= LEVEL && is_long(i));
    let verb = if points[last].1 > points[0].1 { "grows" } else { "falls" };
    match level_from {
        Some(from) => format!(
            "{subject} {verb} from {} to {}, and is level beyond (within a factor of {} up to {} stops).",
            at(0),
            at(from),
            text(over(&points[from..])),
            text(points[last].0)
        ),
        None => {
            let step = |i: usize| (points[i + 1].1 / points[i].1).ln().abs();
            let steepest = (0..last).max_by(|a, b| step(*a).total_cmp(&step(*b))).unwrap_or(0);
            format!(
                "{subject} {verb} from {} to {}, the most, ×{}, between {} and {} stops.",
                at(0),
                at(last),
                text(points[steepest + 1].1 / points[steepest].1),
                text(points[steepest].0),
                text(points[steepest + 1].0)
            )
        }
    }
}

/// Of series that cut off the peaks of one light. Over several lights the range stands for all that differs between them: the table has those.
pub(super) fn from_range(answers: &Answers) -> Option<Answer> {
    let is_clipped = |one: &Growth| one.is_one_light;
    let mut growth: Vec<Growth> = growth(&answers.dynamic_range).into_iter().filter(is_clipped).collect();
    // What has no samples first: it is what the question is about; then what grows the most.
    let draws = |method: &str| method.contains(' ');
    let factor = |one: &Growth| one.points.last().map_or(1.0, |last| last.1) / one.points[0].1;
    growth.sort_by(|a, b| draws(&a.method).cmp(&draws(&b.method)).then(factor(b).total_cmp(&factor(a))));
    let [first, rest @ ..] = growth.as_slice() else { return None };
    let range = |one: &Growth| [one.points[0].0, one.points[one.points.len() - 1].0].map(text);
    let [from, to] = range(first);
    Some(Answer {
        number: format!("×{}", text(factor(first))),
        unit: format!("the error of {} in {} from {from} to {to} stops of dynamic range", first.method, first.series),
        sentence: say(first),
        facts: rest.iter().take(FACTS_OF_A_KIND).map(say).collect(),
    })
}
