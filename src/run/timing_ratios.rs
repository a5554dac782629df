//! Two methods timed in the same rounds: the ratio of their times.

use super::timing::{FRAME, TimingRecord, is_alike};
use crate::base::math::order_statistics::{median, median_interval};
use crate::experiment::axis::SAMPLES;
use crate::instrument::shade::{METHODS, Method};

/// Two methods timed in the same rounds with equal axes: one with samples and one without, or two
/// of one kind at the same count, of which `sampled` is the first in the list of methods.
#[derive(Clone, Debug)]
pub struct Ratio<'r> {
    pub sampled: &'r TimingRecord,
    pub fixed: &'r TimingRecord,
    /// Median over rounds of the shading time of `sampled` over `fixed`'s.
    pub ratio: f64,
    /// 95 % interval of the median. NaN below six rounds.
    pub interval: [f64; 2],
}

/// Every pair of methods that was timed in one block.
pub fn ratios(records: &[TimingRecord]) -> Vec<Ratio<'_>> {
    let draws = |record: &TimingRecord| record.method().is_some_and(|method| method.uses_samples);
    let is_nothing = |record: &TimingRecord| record.method().is_none_or(Method::is_none);
    let frames: Vec<&TimingRecord> = records
        .iter()
        .filter(|r| r.phase == FRAME && !is_nothing(r))
        .collect();
    let mut found = Vec::new();
    let place = |record: &TimingRecord| {
        METHODS
            .iter()
            .position(|method| record.method().is_some_and(|own| own.name == method.name))
    };
    for fixed in &frames {
        let is_pair = |record: &&&TimingRecord| {
            // Shards may mix devices and drivers.
            let is_same = record.device == fixed.device && record.driver == fixed.driver;
            let is_beside =
                is_same && record.block == fixed.block && is_alike(&record.axes, &fixed.axes);
            let is_first =
                place(record) < place(fixed) && record.value(SAMPLES) == fixed.value(SAMPLES);
            is_beside
                && if draws(fixed) == draws(record) {
                    is_first
                } else {
                    draws(record)
                }
        };
        for sampled in frames.iter().filter(is_pair) {
            let pairs = sampled.shading_ms().into_iter().zip(fixed.shading_ms());
            let quotients: Vec<f64> = pairs.map(|(a, b)| a / b).collect();
            let (ratio, interval) = (median(&quotients), median_interval(&quotients));
            found.push(Ratio {
                sampled,
                fixed,
                ratio,
                interval,
            });
        }
    }
    found
}
