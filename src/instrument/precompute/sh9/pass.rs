//! The device pass: partial sums over strided texels, then one group that adds them.

use super::Projection;
use crate::base::glsl::constants::SH9_COUNT;
use crate::base::glsl::layout::{Sh9Params, SharedStruct};
use crate::instrument::gpu::{Bind, Buffer, Gpu, GpuError, Image, Report, Sampler};

/// Groups of the first dispatch: enough for a large GPU, few enough that adding their sums takes no
/// time.
const GROUP_COUNT: u32 = 128;

pub const SHADERS: [&str; 2] = ["precompute/sh9.comp", "precompute/sh9_reduce.comp"];

/// Makes a buffer for the coefficients: SH9_COUNT vec4 of radiance, w = 0.
pub fn coefficients(gpu: &Gpu) -> Result<Buffer, GpuError> {
    gpu.buffer("SH9 coefficients", u64::from(16 * SH9_COUNT))
}

/// Projects level 0 of `environment` into `coefficients`.
pub fn run(
    gpu: &Gpu,
    environment: &Image,
    projection: Projection,
    coefficients: &Buffer,
) -> Result<Report, GpuError> {
    let [width, height] = environment.mip_size(0);
    let push = Sh9Params {
        width,
        height,
        group_count: GROUP_COUNT,
        projection: projection as u32,
    }
    .to_bytes();
    let partials = gpu.buffer("SH9 partial sums", u64::from(16 * SH9_COUNT * GROUP_COUNT))?;
    let [project, reduce] = SHADERS;
    gpu.submit_pass("sh9", |recorder| {
        let binds = [
            Bind::Sample(environment, Sampler::TEXELS),
            Bind::Write(&partials),
        ];
        recorder.dispatch(project, &[], &binds, &push, [GROUP_COUNT, 1, 1])?;
        let binds = [Bind::Read(&partials), Bind::Write(coefficients)];
        recorder.dispatch(reduce, &[], &binds, &push, [1, 1, 1])
    })
}
