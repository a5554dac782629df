//! The device pass: partial sums over strided texels, then one group that adds them.

use crate::glsl::constants::SH9_COUNT;
use crate::glsl::layout::{Sh9Params, SharedStruct};
use crate::gpu::{Bind, Buffer, ComputePipeline, Filter, Gpu, GpuError, Image, Recorder, Sampler, Slot, Wrap};

/// Groups of the first dispatch: enough to fill a large GPU, few enough that adding their sums is nothing.
const GROUP_COUNT: u32 = 128;

pub struct Sh9Pass {
    project: ComputePipeline,
    reduce: ComputePipeline,
    sampler: Sampler,
    partials: Buffer,
}

impl Sh9Pass {
    /// The shaders that make the coefficients.
    pub const SHADERS: [&str; 2] = ["precompute/sh9.comp", "precompute/sh9_reduce.comp"];

    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let [project, reduce] = Self::SHADERS;
        let project = gpu.compute_pipeline(project, &[Slot::Sampled, Slot::Buffer], Sh9Params::SIZE, &[])?;
        let reduce = gpu.compute_pipeline(reduce, &[Slot::Buffer, Slot::Buffer], Sh9Params::SIZE, &[])?;
        let sampler = gpu.sampler(Filter::Nearest, Wrap::Equirect)?;
        let partials = gpu.buffer("SH9 partial sums", u64::from(16 * SH9_COUNT * GROUP_COUNT))?;
        Ok(Self { project, reduce, sampler, partials })
    }

    /// A buffer for the coefficients: SH9_COUNT vec4, radiance, w = 0.
    pub fn coefficients(gpu: &Gpu) -> Result<Buffer, GpuError> {
        gpu.buffer("SH9 coefficients", u64::from(16 * SH9_COUNT))
    }

    /// Projects level 0 of `environment` into `coefficients`.
    pub fn record(&self, recorder: &mut Recorder, environment: &Image, coefficients: &Buffer) -> Result<(), GpuError> {
        let [width, height] = environment.mip_size(0);
        let push = Sh9Params { width, height, group_count: GROUP_COUNT, pad: 0 }.to_bytes();
        let binds = [Bind::Sample(environment, &self.sampler), Bind::Write(&self.partials)];
        recorder.dispatch(&self.project, &binds, &push, [GROUP_COUNT, 1, 1])?;
        let binds = [Bind::Read(&self.partials), Bind::Write(coefficients)];
        recorder.dispatch(&self.reduce, &binds, &push, [1, 1, 1])
    }
}
