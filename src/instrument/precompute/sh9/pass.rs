//! The device pass: partial sums over strided texels, then one group that adds them.

use super::{Projection, TEXTURE_SIZE};
use crate::base::glsl::constants::{GROUP_SIDE, SH9_COUNT};
use crate::base::glsl::layout::{MipsParams, Sh9Params, SharedStruct};
use crate::instrument::gpu::{Bind, Buffer, Format, Gpu, GpuError, Image, Report, Sampler};

/// Groups of the first dispatch: enough for a large GPU, few enough that adding their sums takes no
/// time.
const GROUP_COUNT: u32 = 128;

pub const SHADERS: [&str; 2] = ["precompute/sh9.comp", "precompute/sh9_reduce.comp"];

pub const TEXTURE_SHADER: &str = "precompute/sh9_texture.comp";

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

/// Makes an image for the texture of irradiance over π.
pub fn texture(gpu: &Gpu) -> Result<Image, GpuError> {
    gpu.image("SH9 texture", TEXTURE_SIZE, 1, Format::Rgba32Float)
}

/// Evaluates `coefficients` at the centre of each texel of `texture`.
pub fn evaluate(gpu: &Gpu, coefficients: &Buffer, texture: &Image) -> Result<Report, GpuError> {
    let [width, height] = texture.mip_size(0);
    let push = MipsParams {
        width,
        height,
        ..MipsParams::default()
    }
    .to_bytes();
    let binds = [Bind::Read(coefficients), Bind::StoreMip(texture, 0)];
    let groups = [width.div_ceil(GROUP_SIDE), height.div_ceil(GROUP_SIDE), 1];
    gpu.submit_pass("sh9-texture", |recorder| {
        recorder.dispatch(TEXTURE_SHADER, &[], &binds, &push, groups)
    })
}
