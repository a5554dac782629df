//! The table of sample points that the sampling shaders read: `(u, cos φ, sin φ, -ln(1 - u))` of each point of a sequence.
//!
//! No point of `math::sequence` sits at u = 0 or 1, where the Phong lobe and the level formula degenerate. The trigonometry and the
//! logarithm are taken here in f64, once, and not per pixel.

use crate::gpu::{Buffer, Gpu, GpuError};
use crate::math::sequence::Sequence;
use std::f64::consts::TAU;

/// The table of `count` points of set `set` of a sequence.
pub fn table(count: u32, sequence: &Sequence, set: u32) -> Vec<[f32; 4]> {
    let point = |i| {
        let xi = (sequence.point)(i, count, set);
        let (sin_phi, cos_phi) = (TAU * xi.y).sin_cos();
        [xi.x, cos_phi, sin_phi, -(-xi.x).ln_1p()].map(|x| x as f32)
    };
    (0..count).map(point).collect()
}

/// The table on the device.
pub fn upload(gpu: &Gpu, count: u32, sequence: &Sequence, set: u32) -> Result<Buffer, GpuError> {
    gpu.buffer_from("sample points", &table(count.max(1), sequence, set))
}
