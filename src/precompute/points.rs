//! The table of sample points that the sampling shaders read: `(u, cos φ, sin φ, -ln(1 - u))` of each Hammersley point.
//!
//! The polar coordinate is `(i + 0.5) / N`, so no point sits at 0 or 1, where the Phong lobe and the level formula degenerate. The
//! trigonometry and the logarithm are taken here in f64, once, and not per pixel.

use crate::gpu::{Buffer, Gpu, GpuError};
use crate::math::sampling::hammersley;
use std::f64::consts::TAU;

/// The first `count` entries of the table for sets of `count` points.
pub fn table(count: u32) -> Vec<[f32; 4]> {
    let point = |i| {
        let xi = hammersley(i, count);
        let (sin_phi, cos_phi) = (TAU * xi.y).sin_cos();
        [xi.x, cos_phi, sin_phi, -(-xi.x).ln_1p()].map(|x| x as f32)
    };
    (0..count).map(point).collect()
}

/// The table on the device.
pub fn upload(gpu: &Gpu, count: u32) -> Result<Buffer, GpuError> {
    gpu.buffer_from("sample points", &table(count.max(1)))
}
