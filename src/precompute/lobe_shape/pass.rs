//! The table on the device.

use crate::glsl::constants::{LOBE_SHAPE_PARTS, LOBE_SHAPE_SIDE};
use crate::gpu::{Format, Gpu, GpuError, Image};

/// An empty table.
pub fn table(gpu: &Gpu) -> Result<Image, GpuError> {
    let size = [LOBE_SHAPE_SIDE, LOBE_SHAPE_PARTS * LOBE_SHAPE_SIDE];
    gpu.image("lobe shapes", size, 1, Format::Rgba32Float)
}
