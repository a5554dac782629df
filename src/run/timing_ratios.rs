//! Two methods timed in the same rounds: the ratio of their times.

use super::timing::{FRAME, TimingRecord, is_alike};
use crate::base::math::order_statistics::{median, median_interval};
use crate::experiment::axis::SAMPLES;
use crate::instrument::shade::METHODS;

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

impl<'r> Ratio<'r> {
    fn new(sampled: &'r TimingRecord, fixed: &'r TimingRecord) -> Self {
        let rounds = sampled.shading_ms().into_iter().zip(fixed.shading_ms());
        let quotients: Vec<f64> = rounds
            .map(|(sampled_ms, fixed_ms)| sampled_ms / fixed_ms)
            .collect();
        Self {
            sampled,
            fixed,
            ratio: median(&quotients),
            interval: median_interval(&quotients),
        }
    }
}

/// Every pair of methods that was timed in one block.
pub fn ratios(records: &[TimingRecord]) -> Vec<Ratio<'_>> {
    let frames: Vec<&TimingRecord> = records
        .iter()
        .filter(|record| record.phase == FRAME && shades(record))
        .collect();
    let mut ratios = Vec::new();
    for &fixed in &frames {
        let sampled = frames.iter().filter(|sampled| is_pair(sampled, fixed));
        ratios.extend(sampled.map(|sampled| Ratio::new(sampled, fixed)));
    }
    ratios
}

/// Whether the configuration has a specular method, and a known one.
fn shades(record: &TimingRecord) -> bool {
    record.method().is_some_and(|method| !method.is_none())
}

fn uses_samples(record: &TimingRecord) -> bool {
    record.method().is_some_and(|method| method.uses_samples)
}

fn is_pair(sampled: &TimingRecord, fixed: &TimingRecord) -> bool {
    // Shards may mix devices and drivers.
    let is_same_device = sampled.device == fixed.device && sampled.driver == fixed.driver;
    let is_same_case =
        is_same_device && sampled.block == fixed.block && is_alike(&sampled.axes, &fixed.axes);
    if !is_same_case {
        return false;
    }
    if uses_samples(fixed) == uses_samples(sampled) {
        method_index(sampled) < method_index(fixed)
            && sampled.value(SAMPLES) == fixed.value(SAMPLES)
    } else {
        uses_samples(sampled)
    }
}

/// Position of the method in [`METHODS`].
fn method_index(record: &TimingRecord) -> Option<usize> {
    let name = record.method()?.name;
    METHODS.iter().position(|method| method.name == name)
}
