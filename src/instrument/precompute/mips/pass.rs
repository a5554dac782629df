//! The device pass: one dispatch per level.

use crate::base::glsl::layout::{MipsParams, SharedStruct};
use crate::instrument::gpu::{Bind, Gpu, GpuError, Image, Report, Sampler, image_groups};

pub const SHADER: &str = "precompute/mips.comp";

/// Fills every level of `image` from level 1 on.
pub fn run(gpu: &Gpu, image: &Image) -> Result<Report, GpuError> {
    gpu.submit_pass("mips", |recorder| {
        (1..image.mip_count()).try_for_each(|mip| {
            let push = parameters(image, mip).to_bytes();
            let [width, height] = image.mip_size(mip);
            let binds = [
                Bind::SampleMip(image, Sampler::TEXELS, mip - 1),
                Bind::StoreMip(image, mip),
            ];
            recorder.dispatch(SHADER, &[], &binds, &push, image_groups(width, height))
        })
    })
}

/// The sizes of a level and of the level above, whose texels it averages.
pub fn parameters(image: &Image, mip: u32) -> MipsParams {
    let [source_width, source_height] = image.mip_size(mip - 1);
    let [width, height] = image.mip_size(mip);
    MipsParams {
        source_width,
        source_height,
        width,
        height,
    }
}
