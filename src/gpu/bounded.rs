//! Splitting long work over submissions, so that no single one holds the device for long.

use super::{Gpu, GpuError, Recorder, Report};
use crate::glsl::constants::GROUP_SIDE;
use std::ops::Range;

/// Samples that one submission may take on a CPU driver: about a quarter of a second on two cores.
const SAMPLES_CPU: u64 = 1 << 23;
/// The same for GPUs: well under a second on slow ones, long enough to hide the cost of submitting.
const SAMPLES_GPU: u64 = 1 << 28;

/// Square work groups over rows of an image.
pub fn image_groups(width: u32, row_count: u32) -> [u32; 3] {
    [width.div_ceil(GROUP_SIDE), row_count.div_ceil(GROUP_SIDE), 1]
}

/// Work groups over a band of rows of each face.
pub fn face_groups(width: u32, row_count: u32, face_count: u32) -> [u32; 3] {
    let [x, y, _] = image_groups(width, row_count);
    [x, y, face_count]
}

impl Gpu {
    /// Bands of whole rows such that one band of `samples_per_row` samples a row stays within one submission's budget.
    /// A band is a multiple of a work group's height, except for the last.
    pub fn row_bands(&self, row_count: u32, samples_per_row: u64) -> impl Iterator<Item = Range<u32>> + use<> {
        let budget = if self.info().device_type == "cpu" { SAMPLES_CPU } else { SAMPLES_GPU };
        let rows = (budget / samples_per_row.max(1)).clamp(1, u64::from(row_count.max(1))) as u32;
        let step = rows.next_multiple_of(GROUP_SIDE);
        (0..row_count).step_by(step as usize).map(move |first| first..(first + step).min(row_count))
    }

    /// Records and submits one timed pass.
    pub fn submit_pass(
        &self,
        name: &'static str,
        record: impl FnOnce(&mut Recorder) -> Result<(), GpuError>,
    ) -> Result<Report, GpuError> {
        let mut recorder = self.record(name)?;
        recorder.pass(name, record)?;
        recorder.submit()
    }
}
