//! Two methods timed in the same rounds: which is faster, and when a method's tables have paid for themselves.

use super::statistics::{INTERVAL_SAMPLES_MIN, TOO_FEW_ROUNDS, median, median_interval};
use super::timing::{FRAME, Key, PRECOMPUTE, TimingRecord, is_alike, is_of_method};
use crate::experiment::axis::{METHOD, SAMPLES};
use crate::shade::{METHODS, Method};
use crate::table::markdown::significant;
use std::fmt;

/// Times closer than this count as the same: below it neither is worth a choice.
const SAME_WITHIN: f64 = 0.02;

/// The verdict of an interval of a ratio of times on the first method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    Fast,
    Slow,
    /// The whole interval lies within 2 % of 1.
    Same,
    /// The interval reaches across a border, or there are too few rounds.
    Ambiguous,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Fast => "FAST",
            Self::Slow => "SLOW",
            Self::Same => "SAME",
            Self::Ambiguous => "AMBIGUOUS",
        })
    }
}

/// The verdict on a median ratio with this 95 % interval over `rounds` pairs.
pub fn verdict([lo, hi]: [f64; 2], rounds: usize) -> Verdict {
    match () {
        () if rounds < INTERVAL_SAMPLES_MIN || lo.is_nan() || hi.is_nan() => Verdict::Ambiguous,
        () if hi < 1.0 - SAME_WITHIN => Verdict::Fast,
        () if lo > 1.0 + SAME_WITHIN => Verdict::Slow,
        () if lo >= 1.0 - SAME_WITHIN && hi <= 1.0 + SAME_WITHIN => Verdict::Same,
        () => Verdict::Ambiguous,
    }
}

/// The interval of a ratio or a time as people read it.
pub fn interval_words(interval: [f64; 2], digits: usize) -> String {
    match interval.iter().any(|end| end.is_nan()) {
        true => TOO_FEW_ROUNDS.to_owned(),
        false => interval.map(|end| significant(end, digits)).join(" to "),
    }
}

/// Two methods timed in the same rounds with equal axes: a sampling one beside one that draws no samples, or two of one kind at the same count,
/// of which the first in the list of methods stands as `sampled`.
#[derive(Clone, Debug)]
pub struct Ratio<'r> {
    pub sampled: &'r TimingRecord,
    pub fixed: &'r TimingRecord,
    /// Median over rounds of time of `sampled` / time of `fixed`.
    pub ratio: f64,
    /// 95 % interval of it; the rounds are resampled, never single samples. NaN below [`INTERVAL_SAMPLES_MIN`] rounds.
    pub interval: [f64; 2],
    pub rounds: usize,
    /// That of `sampled`.
    pub verdict: Verdict,
    /// Every set of tables that such frames were timed with; one without a time where none was.
    pub tables: Vec<TableCost>,
}

impl Ratio<'_> {
    /// Whether one of the two has its tables in place of samples.
    pub fn has_payback(&self) -> bool {
        self.tables.iter().all(|tables| tables.payback != Payback::NotAsked)
    }
}

/// The cost of one set of tables behind a pair of methods.
#[derive(Clone, Debug)]
pub struct TableCost {
    /// The axes of both frames and of their tables, without method and sample count.
    pub key: Key,
    /// Cost of the tables of `fixed` beyond those of `sampled`, ms; NaN where they were not timed.
    pub ms: f64,
    pub payback: Payback,
}

/// When a method without samples has paid for its tables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Payback {
    /// After this many frames, with their 95 % interval: that of the ratio. What the tables cost is a median without one.
    Frames { count: f64, interval: [f64; 2] },
    /// Its frames are slower.
    Never,
    /// The verdict does not say whose frames are faster, and why it does not.
    NotDecided(&'static str),
    /// The tables were not timed.
    NotTimed,
    /// Both methods draw samples, or neither does: there is no choice between tables and samples.
    NotAsked,
}

impl Payback {
    /// For the median ratio of the sampling method's times to the other's, with its 95 % interval over `rounds`, by the time of a frame and of the tables of the other, ms.
    pub fn new(ratio: f64, [lo, hi]: [f64; 2], rounds: usize, fixed_ms: f64, tables_ms: f64) -> Self {
        let frames = |ratio: f64| (tables_ms / ((ratio - 1.0) * fixed_ms)).ceil().max(0.0);
        match verdict([lo, hi], rounds) {
            _ if tables_ms.is_nan() => Self::NotTimed,
            Verdict::Fast => Self::Never,
            Verdict::Slow => Self::Frames { count: frames(ratio), interval: [frames(hi), frames(lo)] },
            Verdict::Same => Self::NotDecided("frames within 2 % of each other"),
            _ if rounds < INTERVAL_SAMPLES_MIN => Self::NotDecided(TOO_FEW_ROUNDS),
            _ => Self::NotDecided("the interval of the ratio leaves open whose frames are faster"),
        }
    }

    /// The frames, where they are known.
    pub fn frames(self) -> Option<f64> {
        if let Self::Frames { count, .. } = self { Some(count) } else { None }
    }
}

impl fmt::Display for Payback {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Frames { count, interval: [lo, hi] } if lo == hi => write!(f, "{count}"),
            Self::Frames { count, interval: [lo, hi] } => write!(f, "{count} ({lo} to {hi})"),
            Self::Never => f.write_str("never"),
            Self::NotDecided(why) => write!(f, "not decided: {why}"),
            Self::NotTimed | Self::NotAsked => Ok(()),
        }
    }
}

/// Every pair of methods that was timed in one block.
pub fn ratios(records: &[TimingRecord]) -> Vec<Ratio<'_>> {
    let draws = |record: &TimingRecord| record.method().is_some_and(|method| method.uses_samples);
    let is_nothing = |record: &TimingRecord| record.method().is_none_or(Method::is_none);
    let frames: Vec<&TimingRecord> = records.iter().filter(|r| r.phase == FRAME && !is_nothing(r)).collect();
    let mut found = Vec::new();
    // Records come in any order: the list of methods says which of two stands over the other.
    let place = |record: &TimingRecord| {
        METHODS.iter().position(|method| record.method().is_some_and(|own| own.name == method.name))
    };
    for fixed in &frames {
        let is_pair = |record: &&&TimingRecord| {
            let is_beside =
                record.block == fixed.block && is_same_device(record, fixed) && is_alike(&record.axes, &fixed.axes);
            let is_first = place(record) < place(fixed) && record.value(SAMPLES) == fixed.value(SAMPLES);
            is_beside && if draws(fixed) == draws(record) { is_first } else { draws(record) }
        };
        for sampled in frames.iter().filter(is_pair) {
            let pairs = sampled.sums_ms().into_iter().zip(fixed.sums_ms());
            let quotients: Vec<f64> = pairs.map(|(a, b)| a / b).collect();
            let interval = median_interval(&quotients);
            let (rounds, ratio) = (quotients.len(), median(&quotients));
            let verdict = verdict(interval, rounds);
            let fixed_ms = median(&fixed.sums_ms());
            let is_asked = draws(sampled) && !draws(fixed);
            let payback = |ms: f64| match is_asked {
                true => Payback::new(ratio, interval, rounds, fixed_ms, ms),
                false => Payback::NotAsked,
            };
            let cost = |(key, ms): (Key, f64)| TableCost { key, ms, payback: payback(ms) };
            let tables = costs(records, fixed, sampled).into_iter().map(cost).collect();
            found.push(Ratio { sampled, fixed, ratio, interval, rounds, verdict, tables });
        }
    }
    found
}

/// Times of two devices, or of two drivers of one, are never compared: a run in chunks may hold both.
fn is_same_device(a: &TimingRecord, b: &TimingRecord) -> bool {
    (&a.device, &a.driver) == (&b.device, &b.driver)
}

/// The cost of each set of tables of `fixed` beyond that of `sampled` with the same parameters, median ms, with its key.
fn costs(records: &[TimingRecord], fixed: &TimingRecord, sampled: &TimingRecord) -> Vec<(Key, f64)> {
    // A method without any tables was timed, too: they cost nothing.
    let ms = |record: &TimingRecord| if record.passes.is_empty() { 0.0 } else { median(&record.sums_ms()) };
    let key = |tables: &[&TimingRecord]| -> Key {
        let all = [sampled, fixed].into_iter().chain(tables.iter().copied()).flat_map(TimingRecord::key);
        let is_shared = |(name, value): &(String, String)| !is_of_method(name) && !value.is_empty();
        all.filter(is_shared).collect()
    };
    let mut found = Vec::new();
    for own in table_sets(records, fixed) {
        let before = found.len();
        let others = table_sets(records, sampled).into_iter().filter(|other| is_alike(&own.axes, &other.axes));
        found.extend(others.map(|other| (key(&[own, other]), ms(own) - ms(other))));
        if found.len() == before {
            found.push((key(&[own]), f64::NAN));
        }
    }
    if found.is_empty() { vec![(key(&[]), f64::NAN)] } else { found }
}

/// Every set of tables that a frame's configuration can stand on: a frame is timed once for all values of an axis that changes its tables only.
fn table_sets<'r>(records: &'r [TimingRecord], frame: &TimingRecord) -> Vec<&'r TimingRecord> {
    let is_of_frame = |record: &&TimingRecord| {
        record.phase == PRECOMPUTE
            && is_same_device(record, frame)
            && record.environment_size == frame.environment_size
            && record.size == frame.size
            && record.value(METHOD) == frame.value(METHOD)
            && is_alike(&record.axes, &frame.axes)
    };
    records.iter().filter(is_of_frame).collect()
}
