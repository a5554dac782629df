//! Frame times of two methods over the sample count: how many samples fit into the time of the method without samples.

use super::break_even::{Level, crossing_interval};
use super::run_folder::RunFolder;
use super::study::{Row, Study};
use crate::runner::timing::{Key, TimingRecord};
use crate::runner::timing_ratios::{Payback, Ratio, TableCost, ratios};
use serde::Serialize;

/// Every pair of methods that was timed in the same rounds, of all runs.
pub struct PairTimes<'r> {
    pairs: Vec<(usize, Ratio<'r>)>,
}

/// Times of a sampling method at one count over those of a fixed method.
#[derive(Clone, Copy, Debug)]
pub struct TimeLevel {
    pub samples: u32,
    /// Median over rounds of the ratio, with its 95 % interval.
    pub ratio: f64,
    pub interval: [f64; 2],
    /// Pairs of frames behind them.
    pub rounds: usize,
    /// What the tables of the fixed method cost beyond those of the sampling one, ms.
    pub tables_ms: f64,
    /// Median time of the fixed method's frame, ms.
    pub fixed_ms: f64,
    pub is_cpu: bool,
}

/// Frame times of a sampling method over those of a fixed one, of one timed configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameRatio {
    pub sampled: String,
    /// As written.
    pub samples: String,
    pub fixed: String,
    /// Median over rounds, with its 95 % interval; NaN below six rounds.
    pub ratio: f64,
    pub interval: [f64; 2],
    /// When the fixed method has paid for its tables, for each set of them.
    pub paybacks: Vec<Payback>,
}

/// What a sampling method can do in the time of a method without samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TimeMatch {
    /// Sample count whose frame takes as long as one of the fixed method (log-log interpolation of the tried counts); 0 where even the
    /// smallest tried count takes longer, infinite where the largest does not.
    pub samples: f64,
    /// 95 % interval of it, with the ends of [`crossing_interval`]; `None` where a ratio has too few rounds for one.
    pub interval: Option<[f64; 2]>,
    /// Whether the times come from a CPU driver, which says nothing about a GPU.
    pub is_cpu: bool,
}

impl<'r> PairTimes<'r> {
    /// The timed pairs of joined runs.
    pub fn new(runs: &'r [RunFolder]) -> Self {
        let of_run = |(run, folder): (usize, &'r RunFolder)| ratios(&folder.timings).into_iter().map(move |r| (run, r));
        Self { pairs: runs.iter().enumerate().flat_map(of_run).collect() }
    }

    /// Every pair of a sampling and a fixed method in words of its methods.
    pub fn frame_ratios(&self) -> Vec<FrameRatio> {
        let axis = |record: &TimingRecord, name: &str| record.axes.get(name).cloned().unwrap_or_default();
        let ratio = |(_, pair): &(usize, Ratio)| FrameRatio {
            sampled: axis(pair.sampled, "method"),
            samples: axis(pair.sampled, "samples"),
            fixed: axis(pair.fixed, "method"),
            ratio: pair.ratio,
            interval: pair.interval,
            paybacks: pair.tables.iter().map(|tables| tables.payback).collect(),
        };
        self.pairs.iter().filter(|(_, pair)| pair.has_payback()).map(ratio).collect()
    }

    /// The times of a sampled row beside those of a fixed one of the same run: those taken with the row's own environment where there
    /// are any, else those of one with the same shading.
    pub fn level(&self, study: &Study, sampled: &Row, fixed: &Row) -> Option<TimeLevel> {
        let environment_of = |cell: &str| study.row(sampled.run, cell).map(|row| study.value(row, "environment"));
        let fitting = self.pairs.iter().filter(|(run, pair)| {
            *run == sampled.run
                && sampled.run == fixed.run
                && is_of(study, &pair.sampled.axes, sampled)
                && is_of(study, &pair.fixed.axes, fixed)
        });
        let fitting: Vec<&Ratio> = fitting.map(|(_, pair)| pair).collect();
        let own = Some(study.value(sampled, "environment"));
        let pair = fitting.iter().find(|pair| environment_of(&pair.sampled.cell) == own).or(fitting.first())?;
        let samples = study.value(sampled, "samples").parse().ok()?;
        let fixed_ms = crate::runner::statistics::median(&pair.fixed.sums_ms());
        let is_own = |tables: &&TableCost| is_of(study, &tables.key, sampled) && is_of(study, &tables.key, fixed);
        let tables = match pair.tables.as_slice() {
            [only] => Some(only),
            several => several.iter().find(is_own),
        };
        pair.ratio.is_finite().then_some(TimeLevel {
            samples,
            ratio: pair.ratio,
            interval: pair.interval,
            rounds: pair.rounds,
            tables_ms: tables.map_or(f64::NAN, |tables| tables.ms),
            fixed_ms,
            is_cpu: pair.sampled.device_type == "cpu",
        })
    }
}

/// Whether a timed configuration stands for a row: every axis that its key names has the row's value, or does not reach the row's pixels.
pub fn is_of(study: &Study, key: &Key, row: &Row) -> bool {
    let fits = |name: &str, value: &str| {
        let own = study.value(row, name);
        own == value || (own.is_empty() && study.axis(name).is_some())
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
    Some(TimeMatch {
        samples,
        interval: wide.and_then(|wide| crossing_interval(&wide)),
        is_cpu: levels.iter().any(|level| level.is_cpu),
    })
}

/// Time ratio at a sample count with its 95 % interval, by log-log interpolation; `None` outside the tried counts.
pub fn ratio_at(levels: &[TimeLevel], samples: f64) -> Option<(f64, [f64; 2])> {
    if let Some(exact) = levels.iter().find(|level| f64::from(level.samples) == samples) {
        return Some((exact.ratio, exact.interval));
    }
    let next = levels.iter().position(|level| f64::from(level.samples) > samples)?;
    let (a, b) = (levels.get(next.checked_sub(1)?)?, &levels[next]);
    let [x0, x1] = [a, b].map(|level| f64::from(level.samples).ln());
    let t = (samples.ln() - x0) / (x1 - x0);
    let between = |y0: f64, y1: f64| (y0.ln() + t * (y1.ln() - y0.ln())).exp();
    // Interpolating the ends as if both levels erred together is wider than if each erred alone.
    let ends = std::array::from_fn(|end| between(a.interval[end], b.interval[end]));
    Some((between(a.ratio, b.ratio), ends))
}
