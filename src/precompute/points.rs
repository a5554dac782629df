//! The table of sample points that the sampling shaders read: `(u, cos φ, sin φ, -ln(1 - u))` of each Hammersley point.
//!
//! Every sample of every pixel reads the table. Software drivers read storage buffers lane by lane but uniform blocks once for all
//! lanes, which makes a sample a sixth cheaper; a uniform block holds [`POINTS_PER_DISPATCH`] points, so a dispatch adds that many.
//!
//! The polar coordinate is `(i + 0.5) / N`, so no point sits at 0 or 1, where the Phong lobe and the level formula degenerate. The
//! trigonometry and the logarithm are taken here in f64, once, and not per pixel.
//!
//! Set 0 is the plain Hammersley set that the methods use. Set k > 0 is the same set shifted on the torus by the k-th point of the R2
//! sequence [Roberts18] (a Cranley-Patterson rotation [CranleyPatterson76]): independent enough repetitions to part bias from variance.

use crate::glsl::constants::POINTS_PER_DISPATCH;
use crate::gpu::{Bind, Buffer, Gpu, GpuError};
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
#[derive(Clone)]
pub struct Points {
    count: u32,
    /// Filled up to whole dispatches.
    buffer: Buffer,
}

/// The points of one dispatch.
#[derive(Clone, Copy)]
pub struct PointRange<'a> {
    points: &'a Points,
    /// A multiple of [`POINTS_PER_DISPATCH`].
    pub first: u32,
    /// At most [`POINTS_PER_DISPATCH`].
    pub count: u32,
}

impl Points {
    /// `count` points of set `set`.
    pub fn upload(gpu: &Gpu, count: u32, set: u32) -> Result<Self, GpuError> {
        let mut texels = table(count, set);
        texels.resize(count.next_multiple_of(POINTS_PER_DISPATCH) as usize, [0.0; 4]);
        Ok(Self { count, buffer: gpu.uniform_from("sample points", &texels)? })
    }

    /// The points in the order of their dispatches.
    pub fn ranges(&self) -> impl Iterator<Item = PointRange<'_>> {
        (0..self.count).step_by(POINTS_PER_DISPATCH as usize).map(|first| PointRange {
            points: self,
            first,
            count: POINTS_PER_DISPATCH.min(self.count - first),
        })
    }
}

impl<'a> PointRange<'a> {
    /// The uniform block `vec4 points[POINTS_PER_DISPATCH]`.
    pub fn bind(self) -> Bind<'a> {
        const BLOCK: u64 = POINTS_PER_DISPATCH as u64 * size_of::<[f32; 4]>() as u64;
        let start = u64::from(self.first) * size_of::<[f32; 4]>() as u64;
        Bind::Uniform(&self.points.buffer, start..start + BLOCK)
    }
}
