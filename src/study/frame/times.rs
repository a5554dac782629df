//! Frame times beside the rows: how many samples fit into the frame time of a method without samples.

use super::band::{Level, crossing_interval};
use super::{Frame, Row};
use crate::experiment::axis::{ENVIRONMENT, index_of};
use crate::experiment::value::Value;
use crate::run::timing::Key;
use crate::run::timing_ratios::{Ratio, ratios};

/// Frame time of a sampling method at one count over that of a method without samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeLevel {
    pub samples: u32,
    /// Median over rounds, with its 95 % interval; NaN ends below six rounds.
    pub ratio: f64,
    pub interval: [f64; 2],
}

/// What a sampling method can do in the frame time of a method without samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeMatch {
    /// Samples whose frame takes as long (log-log interpolation between tried counts); 0 where even the smallest tried count takes longer,
    /// infinite where the largest does not.
    pub samples: f64,
    /// 95 % interval of it, with the ends of [`crossing_interval`]; `None` where a ratio has too few rounds for one.
    pub interval: Option<[f64; 2]>,
}

/// The times of a sampled row beside those of a row of a method without samples: those taken with the row's own environment where there are
/// any, else those of one with the same shading. `pairs` are the run's [`ratios`].
pub fn level(frame: &Frame, pairs: &[Ratio], sampled: &Row, fixed: &Row) -> Option<TimeLevel> {
    let environment_of = |id: &str| {
        let row = frame.rows.iter().find(|row| row.cell.id == id || row.copies.contains(&id));
        row.map(|row| &row.point[ENVIRONMENT])
    };
    let fits = |pair: &&Ratio| is_of(&pair.sampled.axes, sampled) && is_of(&pair.fixed.axes, fixed);
    let fitting: Vec<&Ratio> = pairs.iter().filter(fits).collect();
    let own = Some(&sampled.point[ENVIRONMENT]);
    let pair = fitting.iter().find(|pair| environment_of(&pair.sampled.cell) == own).or(fitting.first())?;
    let samples = sampled.samples()?;
    pair.ratio.is_finite().then_some(TimeLevel { samples, ratio: pair.ratio, interval: pair.interval })
}

/// The timed pairs of a frame's run.
pub fn pairs<'f>(frame: &Frame<'f>) -> Vec<Ratio<'f>> {
    ratios(&frame.run.timings)
}

/// Whether a timed configuration stands for a row: every axis that its key names has the row's value, or does not reach the row's pixels.
fn is_of(key: &Key, row: &Row) -> bool {
    let fits = |name: &str, value: &str| {
        index_of(name).is_some_and(|axis| row.point[axis] == Value::Unset || row.text(axis) == value)
    };
    key.iter().filter(|(_, value)| !value.is_empty()).all(|(name, value)| fits(name, value))
}

/// The count at which the two take equally long. `levels` ascend by count; `None` without any.
pub fn time_match(levels: &[TimeLevel]) -> Option<TimeMatch> {
    // Turned over, the ratio falls with the count as that of errors does.
    let level = |time: &TimeLevel, [lo, hi]: [f64; 2]| Level {
        samples: time.samples,
        ln_ratio: -time.ratio.ln(),
        lo: -hi.ln(),
        hi: -lo.ln(),
    };
    let sure: Vec<Level> = levels.iter().map(|time| level(time, [time.ratio; 2])).collect();
    let has_interval = |time: &TimeLevel| time.interval.iter().all(|end| *end > 0.0);
    let with_interval = |time: &TimeLevel| has_interval(time).then(|| level(time, time.interval));
    let wide: Option<Vec<Level>> = levels.iter().map(with_interval).collect();
    let [lo, hi] = crossing_interval(&sure)?;
    // The point estimate: the interval of levels without width, whose ends meet unless the ratio crosses more than once.
    let samples = match () {
        () if hi <= f64::from(levels.first()?.samples) && levels.first()?.ratio > 1.0 => 0.0,
        () if hi == f64::INFINITY => f64::INFINITY,
        () if lo == 0.0 => hi,
        () => (lo * hi).sqrt(),
    };
    Some(TimeMatch { samples, interval: wide.and_then(|wide| crossing_interval(&wide)) })
}
