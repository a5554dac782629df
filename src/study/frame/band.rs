//! Where a quantity that falls with the sample count crosses 1, with a 95 % interval.
//!
//! The interval inverts a band. At each tried count the quantity has an interval ([`Level`]); the interval of the crossing holds every
//! count at which the quantity is not told apart from 1. A true crossing at count n is left out only if the interval at n misses 1, so the
//! coverage is that of the levels' intervals.

use super::line::t_95;

/// ln of a quantity at a sample count, with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    pub samples: u32,
    pub ln_ratio: f64,
    pub lo: f64,
    pub hi: f64,
}

impl Level {
    /// Errors of several point sets over a fixed error: Student's interval of the mean logarithm. `None` for fewer than two sets.
    pub fn of_point_sets(samples: u32, errors: &[f64], fixed: f64) -> Option<Self> {
        let logs: Vec<f64> = errors.iter().map(|error| (error / fixed).ln()).collect();
        let n = logs.len() as f64;
        let ln_ratio = logs.iter().sum::<f64>() / n;
        let variance = logs.iter().map(|x| (x - ln_ratio).powi(2)).sum::<f64>() / (n - 1.0);
        let half = t_95(logs.len().checked_sub(1)?) * (variance / n).sqrt();
        half.is_finite().then_some(Self { samples, ln_ratio, lo: ln_ratio - half, hi: ln_ratio + half })
    }
}

/// The count between `n0` and `n1` at which a line over ln n from `y0` to `y1` is 0.
fn zero(n0: u32, y0: f64, n1: u32, y1: f64) -> f64 {
    let [x0, x1] = [n0, n1].map(|n| f64::from(n).ln());
    (x0 + y0 / (y0 - y1) * (x1 - x0)).exp()
}

/// 95 % interval of the count at which the quantity falls through 1. `levels` ascend by count. An end of 0 means below the smallest tried
/// count, one of infinity above the largest; a whole interval above the largest count N is `[N, inf]`, one below the smallest `[0, N]`.
/// `None` without levels.
pub fn crossing_interval(levels: &[Level]) -> Option<[f64; 2]> {
    let (first, last) = (levels.first()?, levels.last()?);
    let lo = match levels.iter().position(|level| level.lo <= 0.0) {
        Some(0) => 0.0,
        Some(i) => zero(levels[i - 1].samples, levels[i - 1].lo, levels[i].samples, levels[i].lo),
        None => f64::from(last.samples),
    };
    let hi = match levels.iter().rposition(|level| level.hi >= 0.0) {
        None => f64::from(first.samples),
        Some(i) if i + 1 == levels.len() => f64::INFINITY,
        Some(i) => zero(levels[i].samples, levels[i].hi, levels[i + 1].samples, levels[i + 1].hi),
    };
    Some([lo, hi])
}

/// y at x on the log-log line between neighbours of ascending points; `None` outside them.
pub fn between(points: &[(f64, f64)], x: f64) -> Option<f64> {
    if let Some((_, y)) = points.iter().find(|(at, _)| *at == x) {
        return Some(*y);
    }
    let next = points.iter().position(|(at, _)| *at > x)?;
    let ((x0, y0), (x1, y1)) = (*points.get(next.checked_sub(1)?)?, points[next]);
    let t = (x / x0).ln() / (x1 / x0).ln();
    Some((y0.ln() + t * (y1 / y0).ln()).exp())
}
