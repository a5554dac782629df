//! Break-even: from which sample count on a sampling method beats one whose error is fixed.
//!
//! Two answers are kept apart. The *tried count* is what was measured: the smallest tried count from which on every larger one is better
//! too. The *crossing* is an estimate between the tried counts, with a 95 % interval.
//!
//! The interval inverts a band. At each tried count the ratio of the two errors has an interval ([`Level`]); the interval of the crossing
//! holds every count at which the ratio is not told apart from 1. A true crossing at count n is left out only if the interval of the ratio
//! at n misses 1, so the coverage is that of the levels' intervals. Where the band lies on one side of 1 at every tried count the answer
//! is *always* or *never up to N*, with certainty and not only by the point estimates.
//!
//! A level's interval has one of two origins ([`Basis`]), the first where it can be had:
//! - *point sets*: where `point_set` is swept, each set gives an error of its own. ln(error) has Student's interval over the sets, and the
//!   answer is that of the typical (geometric mean) set.
//! - *n·v bins*: from one point set alone, the bins of `n_dot_v` are the units of a jackknife over ln of the ratio of the summed errors. It
//!   says how far the answer hangs on which parts of the surface are seen; luck of the one point set that all bins share stays outside.

use super::slope::{mean_95, t_95};
use serde::Serialize;
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

/// `{n, above}`: JSON for the report.
impl Serialize for BreakEven {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Shape {
            n: u32,
            above: bool,
        }
        match *self {
            Self::From(n) => Shape { n, above: false },
            Self::Above(n) => Shape { n, above: true },
        }
        .serialize(serializer)
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

/// Where the segment that ends at the break-even count meets the fixed error, by log-log interpolation. `points` ascend.
pub fn crossing(points: &[(u32, f64)], fixed: f64, result: BreakEven) -> Option<f64> {
    let BreakEven::From(count) = result else { return None };
    let index = points.iter().position(|(samples, _)| *samples == count)?;
    let ((n0, e0), (n1, e1)) = (*points.get(index.checked_sub(1)?)?, points[index]);
    let at = zero(n0, (e0 / fixed).ln(), n1, (e1 / fixed).ln());
    at.is_finite().then_some(at)
}

/// The count between `n0` and `n1` at which a line over ln n from `y0` to `y1` is 0.
fn zero(n0: u32, y0: f64, n1: u32, y1: f64) -> f64 {
    let [x0, x1] = [n0, n1].map(|n| f64::from(n).ln());
    (x0 + y0 / (y0 - y1) * (x1 - x0)).exp()
}

/// What the interval of a level comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// Nothing to take an interval from.
    None,
    PointSets,
    NDotVBins,
}

impl Basis {
    /// As in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "",
            Self::PointSets => "point-sets",
            Self::NDotVBins => "n-dot-v-bins",
        }
    }
}

/// ln of the ratio of two quantities at a sample count, with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    pub samples: u32,
    pub ln_ratio: f64,
    pub lo: f64,
    pub hi: f64,
}

impl Level {
    /// From the errors of the point sets at one count.
    pub fn of_point_sets(samples: u32, errors: &[f64], fixed: f64) -> Option<Self> {
        let logs: Vec<f64> = errors.iter().map(|error| (error / fixed).ln()).collect();
        let (ln_ratio, half) = mean_95(&logs).filter(|(_, half)| half.is_finite())?;
        Some(Self { samples, ln_ratio, lo: ln_ratio - half, hi: ln_ratio + half })
    }

    /// From weight, error and fixed error of each bin, by the jackknife [Efron79]: bins are left out one at a time.
    pub fn of_bins(samples: u32, bins: &[(f64, f64, f64)]) -> Option<Self> {
        if bins.len() < 3 {
            return None;
        }
        let ln_ratio = |left_out: Option<usize>| {
            let kept = || bins.iter().enumerate().filter(|(i, _)| Some(*i) != left_out).map(|(_, bin)| bin);
            (kept().map(|(w, e, _)| w * e).sum::<f64>() / kept().map(|(w, _, f)| w * f).sum::<f64>()).ln()
        };
        let without: Vec<f64> = (0..bins.len()).map(|i| ln_ratio(Some(i))).collect();
        let n = bins.len() as f64;
        let mean = without.iter().sum::<f64>() / n;
        let variance = (n - 1.0) / n * without.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        let (ln_ratio, half) = (ln_ratio(None), t_95(bins.len() - 1) * variance.sqrt());
        (ln_ratio.is_finite() && half.is_finite()).then_some(Self {
            samples,
            ln_ratio,
            lo: ln_ratio - half,
            hi: ln_ratio + half,
        })
    }
}

/// 95 % interval of the count at which the ratio falls through 1. `levels` ascend by count. An end of 0 means below the smallest
/// tried count, one of infinity above the largest; a whole interval above the largest count N is `[N, inf]`: never up to N. `None`
/// without levels.
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

/// As [`interval_text`], in the room of a cell: `11–19`, `≤ 4`, `≥ 12`, `> 64` and, where nothing is told apart, `?`.
pub fn range_text([lo, hi]: [f64; 2], [smallest, largest]: [u32; 2]) -> String {
    let text = |n: f64| crate::table::markdown::significant(n, 2);
    match () {
        () if lo == 0.0 && hi == f64::INFINITY => "?".to_owned(),
        () if lo >= f64::from(largest) => format!("> {largest}"),
        () if hi <= f64::from(smallest) => format!("≤ {smallest}"),
        () if lo == 0.0 => format!("≤ {}", text(hi)),
        () if hi == f64::INFINITY => format!("≥ {}", text(lo)),
        () => format!("{}–{}", text(lo), text(hi)),
    }
}

/// An interval of sample counts as people read it: `11 to 19`, `at most 4`, `12 or more`, `always`, `never up to 64`.
pub fn interval_text([lo, hi]: [f64; 2], [smallest, largest]: [u32; 2]) -> String {
    let text = |n: f64| crate::table::markdown::significant(n, 2);
    match () {
        () if lo == 0.0 && hi == f64::INFINITY => "undecided".to_owned(),
        () if lo >= f64::from(largest) => format!("never up to {largest}"),
        () if hi <= f64::from(smallest) => format!("always, from {smallest}"),
        () if lo == 0.0 => format!("at most {}", text(hi)),
        () if hi == f64::INFINITY => format!("{} or more", text(lo)),
        () => format!("{} to {}", text(lo), text(hi)),
    }
}
