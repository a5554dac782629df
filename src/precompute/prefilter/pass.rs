//! The device pass: one dispatch a level and band of rows.

use crate::brdf::Brdf;
use crate::glsl::constants::GROUP_SIDE;
use crate::glsl::layout::{PrefilterParams, SharedStruct};
use crate::gpu::{Bind, Buffer, ComputePipeline, Format, Gpu, GpuError, Image, Report, Sampler, Slot};
use crate::precompute::prefilter::alpha_from_mip;

pub struct PrefilterPass {
    pipeline: ComputePipeline,
}

impl PrefilterPass {
    pub fn new(gpu: &Gpu, brdf: &dyn Brdf) -> Result<Self, GpuError> {
        let shader = format!("precompute/prefilter.comp:{}", brdf.name());
        let slots = [Slot::Sampled, Slot::StorageImage, Slot::Buffer];
        Ok(Self { pipeline: gpu.compute_pipeline(&shader, &slots, PrefilterParams::SIZE, &[])? })
    }

    /// A map to fill.
    pub fn map(gpu: &Gpu, size: [u32; 2], level_count: u32) -> Result<Image, GpuError> {
        gpu.image("prefiltered map", size, level_count, Format::Rgba32Float)
    }

    /// Fills every level of `map`; `points` holds `sample_count` sample points.
    pub fn run(
        &self,
        gpu: &Gpu,
        environment: &Image,
        sampler: &Sampler,
        points: &Buffer,
        sample_count: u32,
        map: &Image,
    ) -> Result<Report, GpuError> {
        let [source_width, source_height] = environment.mip_size(0);
        let mut total = Report::default();
        for level in 0..map.mip_count() {
            let [width, height] = map.mip_size(level);
            let alpha = alpha_from_mip(f64::from(level), map.mip_count()) as f32;
            let samples_per_row = u64::from(width) * if alpha > 0.0 { u64::from(sample_count) } else { 1 };
            for rows in gpu.row_bands(height, samples_per_row, GROUP_SIDE) {
                let params = PrefilterParams {
                    width,
                    height,
                    source_width,
                    source_height,
                    sample_count,
                    alpha,
                    lod_bias: 0.0,
                    first_row: rows.start,
                };
                let binds = [Bind::Sample(environment, sampler), Bind::StoreMip(map, level), Bind::Read(points)];
                let groups = [width.div_ceil(GROUP_SIDE), (rows.end - rows.start).div_ceil(GROUP_SIDE), 1];
                let mut recorder = gpu.record("prefilter")?;
                recorder.pass("prefilter", |r| r.dispatch(&self.pipeline, &binds, &params.to_bytes(), groups))?;
                total.add(recorder.submit()?);
            }
        }
        Ok(total)
    }
}
