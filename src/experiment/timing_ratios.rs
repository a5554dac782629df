//! Two methods timed in the same rounds: which is faster, and when a method's tables have paid for themselves.

use super::statistics::{INTERVAL_SAMPLES_MIN, TOO_FEW_ROUNDS, median, median_interval};
use super::timing::{FRAME, PRECOMPUTE, TimingRecord};
use crate::shade::METHODS;
use crate::table::markdown::significant;
use std::fmt;

/// Times closer than this count as the same: below it neither is worth a choice.
const SAME_WITHIN: f64 = 0.02;

/// What an interval of a ratio of times says of the first method.
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

/// A sampling method beside one that draws no samples, timed in the same rounds.
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
    /// What the tables of `fixed` cost beyond those of `sampled`, ms; NaN where they were not timed.
    pub tables_ms: f64,
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
            Self::NotTimed => Ok(()),
        }
    }
}

/// Every pair of the records that was timed in one block.
pub fn ratios(records: &[TimingRecord]) -> Vec<Ratio<'_>> {
    let draws = |record: &TimingRecord| {
        let name = record.axes.get("method").map_or("", String::as_str);
        METHODS.iter().find(|method| method.name == name).is_some_and(|method| method.uses_samples)
    };
    let is_nothing = |record: &TimingRecord| record.axes.get("method").is_none_or(|name| name == "none");
    let frames: Vec<&TimingRecord> = records.iter().filter(|r| r.phase == FRAME && !is_nothing(r)).collect();
    let mut found = Vec::new();
    for fixed in frames.iter().filter(|record| !draws(record)) {
        for sampled in
            frames.iter().filter(|record| draws(record) && record.block == fixed.block && is_same_device(record, fixed))
        {
            let pairs = sampled.sums_ms().into_iter().zip(fixed.sums_ms());
            let quotients: Vec<f64> = pairs.map(|(a, b)| a / b).collect();
            let interval = median_interval(&quotients);
            let tables_ms = tables_ms(records, fixed) - tables_ms(records, sampled);
            let (rounds, ratio) = (quotients.len(), median(&quotients));
            let verdict = verdict(interval, rounds);
            let payback = Payback::new(ratio, interval, rounds, median(&fixed.sums_ms()), tables_ms);
            found.push(Ratio { sampled, fixed, ratio, interval, rounds, verdict, tables_ms, payback });
        }
    }
    found
}

/// Times of two devices, or of two drivers of one, are never compared: a run in chunks may hold both.
fn is_same_device(a: &TimingRecord, b: &TimingRecord) -> bool {
    (&a.device, &a.driver) == (&b.device, &b.driver)
}

/// Median time of all tables that a frame's configuration needs, ms.
fn tables_ms(records: &[TimingRecord], frame: &TimingRecord) -> f64 {
    let same = |record: &TimingRecord, name: &str| record.axes.get(name) == frame.axes.get(name);
    let of_frame = |record: &&TimingRecord| {
        record.phase == PRECOMPUTE
            && is_same_device(record, frame)
            && record.environment_size == frame.environment_size
            && ["brdf", "method", "diffuse", "masking"].iter().all(|name| same(record, name))
    };
    records.iter().find(of_frame).map_or(f64::NAN, |record| median(&record.sums_ms()))
}
