//! Numbers, counts and scopes in sentences, digests and tips.

use crate::draw::words::{Coverage, Extent, Interval, Number, Quantity, Statement, statement};
use crate::experiment::axis::AxisId;
use crate::experiment::value::Value;
use crate::study::frame::{Frame, Row, estimate::Estimate, values};

/// A number with two digits.
pub fn number(x: f64) -> String {
    Number::rounded(x).to_string()
}

/// A number with its 95 % interval: "12 (95 % 8.1 to 17)".
pub fn estimated(estimate: &Estimate) -> Quantity {
    Quantity::rounded(estimate.value).interval(confidence(estimate))
}

/// The 95 % interval over environments, if they are enough.
pub fn confidence(estimate: &Estimate) -> Option<Interval> {
    estimate.interval.map(|[lo, hi]| Interval {
        extent: Extent {
            least: Number::rounded(lo),
            most: Number::rounded(hi),
        },
        coverage: Coverage::Confidence,
    })
}

/// As [`estimated`], for digests and tips.
pub fn with_interval(estimate: &Estimate) -> String {
    estimated(estimate).to_string()
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

/// As [`with_rms`], in a sentence.
pub fn error_statement(frame: &Frame, error: f64) -> Statement {
    let rms = rms_percent(frame, error)
        .map(|percent| statement![" (", Quantity::rounded(percent).unit(" % rms"), ")"]);
    statement![Quantity::rounded(error), rms]
}

/// "0.012 (11 % rms) (95 % 0.0081 to 0.017)".
pub fn error_with_interval(frame: &Frame, mean: &Estimate) -> String {
    let interval = confidence(mean).map_or_else(String::new, |interval| interval.to_string());
    with_rms(frame, mean.value) + &interval
}

/// "Over 10 environments, 3 BRDF models, 5 alphas."; `None` if all axes have one value.
pub fn scope_statement(frame: &Frame, rows: &[&Row]) -> Option<Statement> {
    let mut counts = Vec::new();
    for axis in frame.case_axes() {
        let n = value_count(rows, axis);
        if n > 1 {
            counts.push(statement![
                Number::Count(n as u64),
                format!(" {}", frame.names.plural(axis))
            ]);
        }
    }
    (!counts.is_empty()).then(|| statement!["Over ", Statement::joined(counts, ", "), "."])
}

/// The number of set values of rows on an axis.
fn value_count(rows: &[&Row], axis: AxisId) -> usize {
    values(rows.iter().copied(), axis)
        .iter()
        .filter(|value| **value != Value::Unset)
        .count()
}

/// The non-empty words, separated by commas: "ggx, alpha 1".
pub fn commas<const N: usize>(words: [&str; N]) -> String {
    words
        .into_iter()
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join(", ")
}

/// "n·v 0.8 to 1": the last bin ends above 1, so that it holds 1.
pub fn n_dot_v_words([lo, hi]: [f64; 2]) -> String {
    format!("n·v {lo} to {}", hi.min(1.0))
}

/// "1 sample", "30 samples".
pub fn count(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// "25 %" for 0.25.
pub fn percent(share: f64) -> String {
    Number::share(share).to_string()
}

/// "-19 to 24 %" of shares, or one if both ends read alike.
pub fn percent_extent([lo, hi]: [f64; 2]) -> Quantity {
    let extent = Extent {
        least: Number::rounded(100.0 * lo),
        most: Number::rounded(100.0 * hi),
    };
    Quantity::new(extent).unit(" %")
}

/// The range of positive numbers: "5.1" or "5.1 to 6.0".
pub fn range(values: impl IntoIterator<Item = f64>) -> String {
    Extent::from_values(values).to_string()
}
