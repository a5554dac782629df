//! Break-even: from which sample count on a sampling method beats one whose error is fixed.

use std::fmt;

/// The answer for one error curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BreakEven {
    /// The smallest tried count from which on every tried count is better; the true crossing lies at or below it.
    From(u32),
    /// Not even this largest tried count is better.
    Above(u32),
}

impl fmt::Display for BreakEven {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::From(count) => write!(f, "{count}"),
            Self::Above(count) => write!(f, "> {count}"),
        }
    }
}

/// The break-even of a curve of (sample count, error), in any order, against a fixed error. A count that is better while a
/// larger one is not does not count: it was luck of the points. An empty curve gives `Above(0)`.
pub fn break_even(curve: &[(u32, f64)], fixed: f64) -> BreakEven {
    let mut curve = curve.to_vec();
    curve.sort_by_key(|(count, _)| *count);
    let Some(&(largest, _)) = curve.last() else { return BreakEven::Above(0) };
    let better = curve.iter().rev().take_while(|(_, error)| *error < fixed);
    better.last().map_or(BreakEven::Above(largest), |(count, _)| BreakEven::From(*count))
}

/// The upper median, with "above" last: at least half of the cases break even at or below it.
pub fn median(results: &[BreakEven]) -> Option<BreakEven> {
    let mut sorted = results.to_vec();
    sorted.sort();
    sorted.get(sorted.len() / 2).copied()
}
