//! Splits long work over submissions, so that none holds the device for long.

use super::device::lock;
use super::{Gpu, GpuError, Recorder, Report};
use crate::base::glsl::constants::GROUP_SIDE;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Samples per submission on a CPU driver: about a quarter of a second on two cores.
const SAMPLES_CPU: u64 = 1 << 23;
/// Samples per submission on a GPU: well under a second on slow ones, long enough to hide the cost
/// of submitting.
const SAMPLES_GPU: u64 = 1 << 28;

/// Counts the square work groups that cover rows of an image.
pub fn image_groups(width: u32, row_count: u32) -> [u32; 3] {
    [
        width.div_ceil(GROUP_SIDE),
        row_count.div_ceil(GROUP_SIDE),
        1,
    ]
}

/// Counts the square work groups that cover rows of every face of a map.
pub fn face_groups(width: u32, row_count: u32, face_count: u32) -> [u32; 3] {
    let [x, y, _] = image_groups(width, row_count);
    [x, y, face_count]
}

/// Work groups of a dispatch: `count` of them, starting at `first`.
#[derive(Clone, Copy, Debug)]
pub struct Groups {
    pub first: [u32; 3],
    pub count: [u32; 3],
}

impl From<[u32; 3]> for Groups {
    fn from(count: [u32; 3]) -> Self {
        Self {
            first: [0; 3],
            count,
        }
    }
}

/// The part of an image or map that one submission computes. Columns and faces follow from the
/// groups.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    pub first_row: u32,
    pub groups: Groups,
}

/// Interactive programs divide the samples per submission by this: about 10 ms each.
const INTERACTIVE_SHARE: u64 = 32;

impl Gpu {
    pub fn submission_samples(&self) -> u64 {
        let whole = if self.info().device_type == "cpu" {
            SAMPLES_CPU
        } else {
            SAMPLES_GPU
        };
        if self.shared.is_interactive {
            whole / INTERACTIVE_SHARE
        } else {
            whole
        }
    }

    /// Refuses to record while `flag` is set: work ends with [`GpuError::Interrupted`] between two
    /// submissions.
    pub fn interrupt_by(&self, flag: Option<Arc<AtomicBool>>) {
        *lock(&self.shared.interrupt) = flag;
    }

    /// Splits an image or map into parts within the budget of one submission: rows of all faces,
    /// else of some faces, else columns of one face. No part is smaller than a work group.
    pub fn parts(
        &self,
        [width, height]: [u32; 2],
        face_count: u32,
        samples_per_texel: u64,
    ) -> impl Iterator<Item = Part> + use<> {
        let [columns, rows, faces] = face_groups(width, height, face_count);
        let fit = self.submission_samples()
            / (u64::from(GROUP_SIDE * GROUP_SIDE) * samples_per_texel).max(1);
        let step = |all: u32, of: u32| (fit / u64::from(of)).clamp(1, u64::from(all)) as u32;
        let [by_column, by_face, by_row] = [
            step(columns, 1),
            step(faces, columns),
            step(rows, columns * faces),
        ];
        let from = |all: u32, step: u32| {
            (0..all)
                .step_by(step as usize)
                .map(move |at| (at, step.min(all - at)))
        };
        from(rows, by_row).flat_map(move |(row, row_count)| {
            from(faces, by_face).flat_map(move |(face, face_count)| {
                from(columns, by_column).map(move |(column, column_count)| Part {
                    first_row: row * GROUP_SIDE,
                    groups: Groups {
                        first: [column, 0, face],
                        count: [column_count, row_count, face_count],
                    },
                })
            })
        })
    }

    /// Splits an image as [`Self::parts`], of at most so many rows each. No part is smaller than a
    /// work group.
    pub fn parts_of_rows(
        &self,
        [width, height]: [u32; 2],
        rows_max: u32,
        samples_per_pixel: u64,
    ) -> impl Iterator<Item = Part> + use<'_> {
        let step = (rows_max / GROUP_SIDE).max(1) * GROUP_SIDE;
        (0..height).step_by(step as usize).flat_map(move |top| {
            let size = [width, step.min(height - top)];
            let parts = self.parts(size, 1, samples_per_pixel);
            parts.map(move |part| Part {
                first_row: top + part.first_row,
                ..part
            })
        })
    }

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
