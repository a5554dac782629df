//! The table of sample points that the sampling shaders read: `(u, cos φ, sin φ, -ln(1 - u))` of each Hammersley point.
//!
//! The polar coordinate is `(i + 0.5) / N`, so no point sits at 0 or 1, where the Phong lobe and the level formula degenerate. The
//! trigonometry and the logarithm are taken here in f64, once, and not per pixel.
//!
//! Set 0 is the plain Hammersley set that the methods use. Set k > 0 is the same set shifted on the torus by the k-th point of the R2
//! sequence [Roberts18] (a Cranley-Patterson rotation [CranleyPatterson76]): independent enough repetitions to part bias from variance.

use crate::gpu::{Buffer, Gpu, GpuError};
use crate::math::sampling::hammersley;
use glam::DVec2;
use std::f64::consts::TAU;

/// The fractions of the R2 sequence: 1/g and 1/g² for the root g of g³ = g + 1.
const R2: DVec2 = DVec2::new(0.754_877_666_246_692_8, 0.569_840_290_998_053_3);

/// The shift of set `set` on the unit torus.
fn shift(set: u32) -> DVec2 {
    (f64::from(set) * R2).fract()
}

/// The table of `count` points of set `set`.
pub fn table(count: u32, set: u32) -> Vec<[f32; 4]> {
    let shift = shift(set);
    let point = |i| {
        let xi = (hammersley(i, count) + shift).fract();
        let (sin_phi, cos_phi) = (TAU * xi.y).sin_cos();
        [xi.x, cos_phi, sin_phi, -(-xi.x).ln_1p()].map(|x| x as f32)
    };
    (0..count).map(point).collect()
}

/// The table on the device.
pub fn upload(gpu: &Gpu, count: u32, set: u32) -> Result<Buffer, GpuError> {
    gpu.buffer_from("sample points", &table(count.max(1), set))
}
