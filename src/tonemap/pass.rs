//! The device pass: radiance to packed 8-bit pixels.

use super::ToneCurve;
use crate::glsl::constants::GROUP_SIDE;
use crate::glsl::layout::{SharedStruct, TonemapParams};
use crate::gpu::{Bind, Buffer, ComputePipeline, Gpu, GpuError, Recorder, Slot};
use crate::pixels::{Pixels, Rgb8Image};

pub struct TonemapPass {
    pipeline: ComputePipeline,
}

impl TonemapPass {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let slots = [Slot::Buffer, Slot::Buffer];
        Ok(Self { pipeline: gpu.compute_pipeline("tonemap/tonemap.comp", &slots, TonemapParams::SIZE, &[])? })
    }

    /// A buffer for the packed pixels of an image.
    pub fn packed(gpu: &Gpu, size: [u32; 2]) -> Result<Buffer, GpuError> {
        gpu.buffer("tone-mapped pixels", 4 * u64::from(size[0]) * u64::from(size[1]))
    }

    /// Applies `curve` to `radiance` (a vec4 a pixel).
    pub fn record(
        &self,
        recorder: &mut Recorder,
        curve: ToneCurve,
        radiance: &Buffer,
        packed: &Buffer,
        size: [u32; 2],
    ) -> Result<(), GpuError> {
        let [width, height] = size;
        let params = TonemapParams { width, height, exposure: curve.exposure, contrast: curve.contrast };
        let groups = [width.div_ceil(GROUP_SIDE), height.div_ceil(GROUP_SIDE), 1];
        recorder.dispatch(&self.pipeline, &[Bind::Read(radiance), Bind::Write(packed)], &params.to_bytes(), groups)
    }

    /// The packed pixels as an image.
    pub fn read(gpu: &Gpu, packed: &Buffer, size: [u32; 2]) -> Result<Rgb8Image, GpuError> {
        let words: Vec<u32> = gpu.read_buffer(packed)?;
        let rgb = words.iter().map(|word| {
            let [r, g, b, _] = word.to_le_bytes();
            [r, g, b]
        });
        Ok(Pixels::new(size[0], size[1], rgb.collect()))
    }
}
