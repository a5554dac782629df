//! Splitting long work over submissions, so that no single one holds the device for long.

use super::device::lock;
use super::{Gpu, GpuError, Recorder, Report};
use crate::glsl::constants::GROUP_SIDE;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

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

/// A program that a person waits for has submissions of a thirty-second of that: about a hundredth of a second.
const INTERACTIVE_SHARE: u64 = 32;

impl Gpu {
    /// Samples that one submission may take.
    pub fn submission_samples(&self) -> u64 {
        let whole = if self.info().device_type == "cpu" { SAMPLES_CPU } else { SAMPLES_GPU };
        if self.shared.is_interactive { whole / INTERACTIVE_SHARE } else { whole }
    }

    /// While `flag` is set nothing new is recorded: what is under way ends with [`GpuError::Interrupted`], between two submissions. `None` ends that.
    pub fn interrupt_by(&self, flag: Option<Arc<AtomicBool>>) {
        *lock(&self.shared.interrupt) = flag;
    }

    /// Bands of whole rows such that one band of `samples_per_row` samples a row stays within one submission's budget.
    /// A band is a multiple of a work group's height, except for the last.
    pub fn row_bands(&self, row_count: u32, samples_per_row: u64) -> impl Iterator<Item = Range<u32>> + use<> {
        let rows = (self.submission_samples() / samples_per_row.max(1)).clamp(1, u64::from(row_count.max(1))) as u32;
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
