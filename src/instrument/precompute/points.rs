//! The sample points that shaders read: `(u, cos φ, sin φ, -ln(1 - u))` for each point of a
//! sequence.
//!
//! Every sample of every pixel reads the table. Software drivers read storage buffers lane by lane
//! but uniform blocks once for all lanes, which makes a sample a sixth cheaper. A uniform block
//! holds [`POINTS_PER_DISPATCH`] points, so a dispatch adds that many.
//!
//! No point of `math::sequence` has u = 0 or 1, where the Phong lobe and the level formula
//! degenerate. Trigonometry and logarithm are computed here once, in f64, instead of per pixel.

use crate::base::glsl::constants::POINTS_PER_DISPATCH;
use crate::base::math::sequence::{PixelPoints, Sequence};
use crate::instrument::gpu::{Bind, Buffer, Gpu, GpuError};
use std::f64::consts::TAU;

/// Computes the table of a sequence's set. Points that each pixel scrambles are `(xi.x, xi.y, 0,
/// 0)`.
pub fn table(count: u32, sequence: &Sequence, set: u32, of_pixel: PixelPoints) -> Vec<[f32; 4]> {
    let point = |i| {
        let xi = (sequence.point)(i, count, set);
        if of_pixel == PixelPoints::Owen {
            return [xi.x as f32, xi.y as f32, 0.0, 0.0];
        }
        let (sin_phi, cos_phi) = (TAU * xi.y).sin_cos();
        [xi.x, cos_phi, sin_phi, -(-xi.x).ln_1p()].map(|x| x as f32)
    };
    (0..count).map(point).collect()
}

#[derive(Clone)]
pub struct Points {
    count: u32,
    /// Padded to whole dispatches.
    buffer: Buffer,
}

#[derive(Clone, Copy)]
pub struct PointRange<'a> {
    points: &'a Points,
    /// A multiple of [`POINTS_PER_DISPATCH`].
    pub first: u32,
    /// At most [`POINTS_PER_DISPATCH`].
    pub count: u32,
}

impl Points {
    pub fn upload(
        gpu: &Gpu,
        count: u32,
        sequence: &Sequence,
        set: u32,
        of_pixel: PixelPoints,
    ) -> Result<Self, GpuError> {
        let mut texels = table(count, sequence, set, of_pixel);
        texels.resize(
            count.next_multiple_of(POINTS_PER_DISPATCH) as usize,
            [0.0; 4],
        );
        Ok(Self {
            count,
            buffer: gpu.uniform_from("sample points", &texels)?,
        })
    }

    pub fn count(&self) -> u32 {
        self.count
    }

    /// Splits the points into dispatches, in order.
    pub fn ranges(&self) -> impl Iterator<Item = PointRange<'_>> {
        (0..self.count)
            .step_by(POINTS_PER_DISPATCH as usize)
            .map(|first| PointRange {
                points: self,
                first,
                count: POINTS_PER_DISPATCH.min(self.count - first),
            })
    }
}

impl<'a> PointRange<'a> {
    /// Binds the uniform block `vec4 points[POINTS_PER_DISPATCH]`.
    pub fn bind(self) -> Bind<'a> {
        const BLOCK: u64 = POINTS_PER_DISPATCH as u64 * size_of::<[f32; 4]>() as u64;
        let start = u64::from(self.first) * size_of::<[f32; 4]>() as u64;
        Bind::Uniform(&self.points.buffer, start..start + BLOCK)
    }
}
