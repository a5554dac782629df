//! Numbers, counts and scopes in sentences.

use crate::draw::markdown::significant;
use crate::experiment::axis::AxisId;
use crate::experiment::value::Value;
use crate::study::frame::{Frame, Row, estimate::Estimate, values};

const DIGITS: usize = 2;

/// A number with two digits.
pub fn number(x: f64) -> String {
    significant(x, DIGITS)
}

/// "12 (95 % 8.1 to 17)"; see [`interval_words`].
pub fn with_interval(estimate: &Estimate) -> String {
    number(estimate.value) + &interval_words(estimate, number)
}

/// " (95 % 8.1 to 17)"; empty for too few environments or equal ends.
pub fn interval_words(estimate: &Estimate, words: impl Fn(f64) -> String) -> String {
    let Some([lo, hi]) = estimate.interval.map(|ends| ends.map(words)) else {
        return String::new();
    };
    if lo == hi {
        String::new()
    } else {
        format!(" (95 % {lo} to {hi})")
    }
}

/// "8.1 to 17", or one number if both ends read alike.
pub fn range_words(ends: [f64; 2], words: impl Fn(f64) -> String) -> String {
    let [least, most] = ends.map(words);
    if least == most {
        least
    } else {
        format!("{least} to {most}")
    }
}

/// The root of a mean square in percent: 11 for 0.012. `None` for other metrics.
pub fn rms_percent(frame: &Frame, error: f64) -> Option<f64> {
    (frame.metric.power == 2.0).then(|| 100.0 * error.sqrt())
}

/// "0.012 (11 % rms)".
pub fn with_rms(frame: &Frame, error: f64) -> String {
    match rms_percent(frame, error) {
        Some(percent) => format!("{} ({} % rms)", number(error), number(percent)),
        None => number(error),
    }
}

/// "a", "a and b", "a, b and c"; of more than four, the first three and "others".
pub fn listed(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [a, b, c, _, _, ..] => format!("{a}, {b}, {c} and others"),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// " Over 10 environments, 3 BRDF models, 5 alphas."; empty if all axes have one value.
pub fn scope_sentence(frame: &Frame, rows: &[&Row]) -> String {
    let count = |axis: AxisId| {
        values(rows.iter().copied(), axis)
            .iter()
            .filter(|value| **value != Value::Unset)
            .count()
    };
    let counts = frame
        .case_axes()
        .into_iter()
        .map(|axis| (axis, count(axis)))
        .filter(|(_, n)| *n > 1);
    let scope = counts
        .map(|(axis, n)| format!("{n} {}", frame.names.plural(axis)))
        .collect::<Vec<_>>()
        .join(", ");
    if scope.is_empty() {
        scope
    } else {
        format!(" Over {scope}.")
    }
}

/// The non-empty words, separated by commas: "ggx, alpha 1".
pub fn commas<const N: usize>(words: [&str; N]) -> String {
    words
        .into_iter()
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join(", ")
        .replace(" · ", ", ")
}

/// "n·v 0.8 to 1": the last bin ends above 1, so that it holds 1.
pub fn view([lo, hi]: [f64; 2]) -> String {
    format!("n·v {lo} to {}", hi.min(1.0))
}

/// "1 sample", "30 samples".
pub fn count(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// "25 %" for 0.25.
pub fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share))
}

/// The range of positive numbers: "5.1" or "5.1 to 6.0".
pub fn range(values: impl IntoIterator<Item = f64>) -> String {
    let (least, most) = values
        .into_iter()
        .fold((f64::INFINITY, 0.0), |(lo, hi), x| {
            (f64::min(lo, x), f64::max(hi, x))
        });
    range_words([least, most], number)
}
