//! Cases in which a sampling method meets one without samples: break-even at equal error and at equal time, over the whole object and by
//! `n_dot_v`.
//!
//! At equal error the question is the crossing of the errors. At equal time it is which method errs less in the same frame time: the
//! sampling method wins where its crossing lies below the count that fits into the time of the other ([`TimeMatch`]).

use super::break_even::{Basis, BreakEven, Level, break_even, crossing, crossing_interval, median};
use super::curves::{Curve, CurvePoint, Fixed, fits, geometric_mean};
use super::study::Study;
use super::times::{PairTimes, TimeLevel, TimeMatch, ratio_at, time_match};
use crate::runner::statistics::{TOO_FEW_ROUNDS, median_order};
use crate::runner::timing_ratios::Payback;
use serde::Serialize;

/// Where two error curves cross.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Crossing {
    pub break_even: BreakEven,
    /// Where the curves cross by log-log interpolation; `None` when they do not between two tried counts.
    pub crossing: Option<f64>,
    /// 95 % interval of the crossing; ends as in [`crossing_interval`].
    pub interval: Option<[f64; 2]>,
    pub basis: Basis,
    /// Who errs less in the time of the method without samples.
    pub at_equal_time: Winner,
}

/// The better method in equal time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Winner {
    Sampled,
    Fixed,
    /// The intervals of crossing and time overlap.
    Undecided,
    /// The times have too few rounds for an interval.
    TooFewRounds,
    /// The two were not timed in the same rounds.
    NotTimed,
}

impl Winner {
    /// As in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sampled => "sampled",
            Self::Fixed => "fixed",
            Self::Undecided => "undecided",
            Self::TooFewRounds => TOO_FEW_ROUNDS,
            Self::NotTimed => "",
        }
    }
}

/// A case in which a sampling method meets one without samples.
#[derive(Clone, Debug, Serialize)]
pub struct Case {
    pub key: Vec<String>,
    pub fixed_error: f64,
    pub fixed_run: usize,
    pub fixed_cell: String,
    /// Index into the curves.
    pub curve: usize,
    #[serde(flatten)]
    pub whole: Crossing,
    /// Crossing within each bin of `n_dot_v`.
    pub bins: Vec<BinCrossing>,
    pub time: Option<TimeMatch>,
    /// Time of a frame of the sampling method at the crossing over that of the fixed one.
    pub time_ratio_at_crossing: Option<f64>,
    /// 95 % interval of that ratio.
    pub time_ratio_interval: Option<[f64; 2]>,
    /// Frames with the same tables after which the fixed method is cheaper than the sampling one at the crossing; `None` where
    /// the crossing, or a time, is not known, or where the interval does not say that its frames are faster.
    pub payback_frames: Option<f64>,
    /// Whether an error at the crossing is near the reference's own noise: more reference samples would move it.
    pub is_reference_limited: bool,
}

/// Crossing over the pixels of one bin.
#[derive(Clone, Debug, Serialize)]
pub struct BinCrossing {
    pub lo: f64,
    pub hi: f64,
    pub fixed_error: f64,
    #[serde(flatten)]
    pub crossing: Crossing,
}

/// All cases of one pair of methods.
#[derive(Clone, Debug, Serialize)]
pub struct Pair {
    pub sampled: String,
    pub fixed: String,
    pub cases: Vec<Case>,
    pub sample_counts: Vec<u32>,
    /// Keys of the cases that the experiment leaves out.
    #[serde(skip)]
    pub excluded: Vec<Vec<String>>,
}

impl Pair {
    /// Lower quartile, median and upper quartile of the cases, each a tried count.
    pub fn quartiles(&self) -> Option<[BreakEven; 3]> {
        let mut sorted: Vec<BreakEven> = self.cases.iter().map(|case| case.whole.break_even).collect();
        sorted.sort();
        let last = sorted.len().checked_sub(1)?;
        // Nearest rank, so that each is one of the tried counts.
        let at = |p: f64| sorted[(p * last as f64).round() as usize];
        Some([at(0.25), median(&sorted)?, at(0.75)])
    }

    /// 95 % interval of the median by order statistics, of break-even and of where the curves cross, each over all cases: a crossing below the
    /// smallest tried count is 0, one above the largest is infinite. It takes the cases for independent draws. `None` where cases are too few.
    pub fn median_interval(&self) -> Option<([BreakEven; 2], [f64; 2])> {
        let outer = median_order(self.cases.len())?;
        let ends = [outer, self.cases.len() - 1 - outer];
        let mut counts: Vec<BreakEven> = self.cases.iter().map(|case| case.whole.break_even).collect();
        counts.sort();
        let crossings = self.crossings();
        Some((ends.map(|place| counts[place]), ends.map(|place| crossings[place])))
    }

    /// Where the curves of each case cross, ascending; 0 below the smallest tried count, infinite above the largest.
    pub fn crossings(&self) -> Vec<f64> {
        let place = |case: &Case| match (case.whole.crossing, case.whole.break_even) {
            (Some(crossing), _) => crossing,
            (None, BreakEven::Above(_)) => f64::INFINITY,
            (None, BreakEven::From(_)) => 0.0,
        };
        let mut all: Vec<f64> = self.cases.iter().map(place).collect();
        all.sort_by(f64::total_cmp);
        all
    }

    /// The extreme cases.
    pub fn extremes(&self) -> Option<[BreakEven; 2]> {
        let all = || self.cases.iter().map(|case| case.whole.break_even);
        Some([all().min()?, all().max()?])
    }

    /// Smallest and largest tried count.
    pub fn tried(&self) -> [u32; 2] {
        [self.sample_counts.first(), self.sample_counts.last()].map(|count| count.copied().unwrap_or(0))
    }
}

/// All pairs of methods, in the order of the fixed ones. A curve of one count only has no crossing and makes no case.
pub fn pairs(study: &Study, curves: &[Curve], fixed: &[Fixed], times: &PairTimes) -> Vec<Pair> {
    let mut pairs: Vec<Pair> = Vec::new();
    for fixed in fixed {
        for (index, curve) in curves.iter().enumerate().filter(|(_, curve)| curve.points.len() > 1) {
            if !fits(&curve.key, &fixed.key) {
                continue;
            }
            let case = case(study, curve, index, fixed, times);
            match pairs.iter_mut().find(|pair| pair.sampled == curve.method && pair.fixed == fixed.method) {
                Some(pair) => pair.cases.push(case),
                None => pairs.push(Pair {
                    sampled: curve.method.clone(),
                    fixed: fixed.method.to_owned(),
                    cases: vec![case],
                    sample_counts: Vec::new(),
                    excluded: Vec::new(),
                }),
            }
        }
    }
    for pair in &mut pairs {
        let mut counts: Vec<u32> =
            pair.cases.iter().flat_map(|case| &curves[case.curve].points).map(|point| point.samples).collect();
        counts.sort_unstable();
        counts.dedup();
        pair.sample_counts = counts;
        pair.excluded = excluded(study, pair);
    }
    pairs
}

/// Keys of what is left out of one of the two methods and is part of no case.
fn excluded(study: &Study, pair: &Pair) -> Vec<Vec<String>> {
    let axes = study.case_axes();
    let method = study.axis("method");
    let of_pair =
        |values: &&Vec<String>| method.is_some_and(|axis| [&pair.sampled, &pair.fixed].contains(&&values[axis]));
    let mut keys: Vec<Vec<String>> = Vec::new();
    for values in study.excluded.iter().filter(of_pair) {
        let key: Vec<String> = axes.iter().map(|&axis| values[axis].clone()).collect();
        if !keys.contains(&key) && pair.cases.iter().all(|case| !fits(&case.key, &key)) {
            keys.push(key);
        }
    }
    keys
}

fn case(study: &Study, curve: &Curve, index: usize, fixed: &Fixed, times: &PairTimes) -> Case {
    let row_of = |point: &CurvePoint| study.row(point.run, &point.cell);
    let levels: Vec<TimeLevel> =
        curve.points.iter().filter_map(|point| times.level(study, row_of(point)?, fixed.row)).collect();
    let time = time_match(&levels);
    let whole = whole(curve, fixed, time);
    let bins = fixed.row.bins.iter().map(|bin| {
        let errors: Vec<(u32, Vec<f64>)> =
            curve.points.iter().map(|point| (point.samples, point.bin(bin.lo).0)).collect();
        let errors: Vec<(u32, Vec<f64>)> = errors.into_iter().filter(|(_, errors)| !errors.is_empty()).collect();
        let crossing = cross(&errors, bin.error, None, time);
        BinCrossing { lo: bin.lo, hi: bin.hi, fixed_error: bin.error, crossing }
    });
    let last = levels.last();
    let time_ratio = whole.crossing.and_then(|samples| ratio_at(&levels, samples));
    let payback = |(ratio, interval): (f64, [f64; 2])| {
        let TimeLevel { rounds, fixed_ms, tables_ms, .. } = *last?;
        Payback::new(ratio, interval, rounds, fixed_ms, tables_ms).frames()
    };
    let is_limited_at = |count: u32| curve.points.iter().any(|point| point.samples <= count && !point.is_resolved);
    Case {
        key: curve.key.iter().zip(&fixed.key).map(|(a, b)| if a.is_empty() { b } else { a }.clone()).collect(),
        fixed_error: fixed.error,
        fixed_run: fixed.row.run,
        fixed_cell: fixed.row.cell.clone(),
        curve: index,
        bins: bins.collect(),
        time,
        time_ratio_at_crossing: time_ratio.map(|(ratio, _)| ratio),
        time_ratio_interval: time_ratio
            .map(|(_, interval)| interval)
            .filter(|ends| ends.iter().all(|end| end.is_finite())),
        payback_frames: time_ratio.and_then(payback),
        is_reference_limited: !fixed.row.is_resolved()
            || match whole.break_even {
                BreakEven::From(count) | BreakEven::Above(count) => is_limited_at(count),
            },
        whole,
    }
}

fn whole(curve: &Curve, fixed: &Fixed, time: Option<TimeMatch>) -> Crossing {
    let errors: Vec<(u32, Vec<f64>)> = curve.points.iter().map(|point| (point.samples, point.errors.clone())).collect();
    // Without further point sets the bins are the units.
    let of_bins: Option<Vec<Level>> = curve
        .points
        .iter()
        .map(|point| {
            let bins: Vec<(f64, f64, f64)> = fixed
                .row
                .bins
                .iter()
                .filter_map(|bin| {
                    let (errors, pixel_count) = point.bin(bin.lo);
                    (!errors.is_empty()).then(|| (pixel_count, geometric_mean(&errors), bin.error))
                })
                .collect();
            Level::of_bins(point.samples, &bins)
        })
        .collect();
    cross(&errors, fixed.error, of_bins, time)
}

/// The crossing of a curve, given as the errors of its point sets by count, with a fixed error. `fallback` are levels for curves of one
/// point set.
fn cross(errors: &[(u32, Vec<f64>)], fixed: f64, fallback: Option<Vec<Level>>, time: Option<TimeMatch>) -> Crossing {
    let curve: Vec<(u32, f64)> = errors.iter().map(|(samples, errors)| (*samples, geometric_mean(errors))).collect();
    let result = break_even(&curve, fixed);
    let of_sets: Option<Vec<Level>> =
        errors.iter().map(|(samples, errors)| Level::of_point_sets(*samples, errors, fixed)).collect();
    let (levels, basis) = match (of_sets.filter(|levels| !levels.is_empty()), fallback) {
        (Some(levels), _) => (levels, Basis::PointSets),
        (None, Some(levels)) => (levels, Basis::NDotVBins),
        (None, None) => (Vec::new(), Basis::None),
    };
    let interval = crossing_interval(&levels);
    let crossing = crossing(&curve, fixed, result);
    Crossing {
        break_even: result,
        crossing,
        interval,
        basis: interval.map_or(Basis::None, |_| basis),
        at_equal_time: winner(interval, time),
    }
}

/// Without an interval the point estimates decide nothing.
fn winner(interval: Option<[f64; 2]>, time: Option<TimeMatch>) -> Winner {
    let Some(time) = time else { return Winner::NotTimed };
    match (interval, time.interval) {
        (_, None) => Winner::TooFewRounds,
        (Some([_, hi]), Some([fewest, _])) if hi < fewest => Winner::Sampled,
        (Some([lo, _]), Some([_, most])) if lo > most => Winner::Fixed,
        _ => Winner::Undecided,
    }
}
