//! The device pass: one dispatch a level.

use crate::glsl::constants::GROUP_SIDE;
use crate::glsl::layout::{MipsParams, SharedStruct};
use crate::gpu::{Bind, ComputePipeline, Filter, Gpu, GpuError, Image, Recorder, Sampler, Slot, Wrap};

pub struct MipsPass {
    pipeline: ComputePipeline,
    sampler: Sampler,
}

impl MipsPass {
    /// The shader that makes the levels.
    pub const SHADER: &str = "precompute/mips.comp";

    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let slots = [Slot::Sampled, Slot::StorageImage];
        let pipeline = gpu.compute_pipeline(Self::SHADER, &slots, MipsParams::SIZE, &[])?;
        Ok(Self { pipeline, sampler: gpu.sampler(Filter::Nearest, Wrap::Equirect)? })
    }

    /// Fills every level of `image` below the first.
    pub fn record(&self, recorder: &mut Recorder, image: &Image) -> Result<(), GpuError> {
        for mip in 1..image.mip_count() {
            let ([source_width, source_height], [width, height]) = (image.mip_size(mip - 1), image.mip_size(mip));
            let params = MipsParams { source_width, source_height, width, height };
            let binds = [Bind::SampleMip(image, &self.sampler, mip - 1), Bind::StoreMip(image, mip)];
            let groups = [width.div_ceil(GROUP_SIDE), height.div_ceil(GROUP_SIDE), 1];
            recorder.dispatch(&self.pipeline, &binds, &params.to_bytes(), groups)?;
        }
        Ok(())
    }
}
