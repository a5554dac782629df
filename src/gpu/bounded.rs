//! Splitting long work over submissions, so that no single one holds the device for long.

use super::Gpu;
use std::ops::Range;

/// Samples that one submission may take on a CPU driver: about a quarter of a second on two cores.
const SAMPLES_CPU: u64 = 1 << 23;
/// The same for GPUs: well under a second on slow ones, long enough to hide the cost of submitting.
const SAMPLES_GPU: u64 = 1 << 28;

impl Gpu {
    /// Bands of whole rows such that one band of `samples_per_row` samples a row stays within one submission's budget.
    /// A band is a multiple of `row_step` rows (a work group's height), except for the last.
    pub fn row_bands(&self, row_count: u32, samples_per_row: u64, row_step: u32) -> Vec<Range<u32>> {
        let budget = if self.info().device_type == "cpu" { SAMPLES_CPU } else { SAMPLES_GPU };
        let rows = (budget / samples_per_row.max(1)).clamp(1, u64::from(row_count.max(1))) as u32;
        let step = rows.div_ceil(row_step) * row_step;
        (0..row_count).step_by(step as usize).map(|first| first..(first + step).min(row_count)).collect()
    }
}
