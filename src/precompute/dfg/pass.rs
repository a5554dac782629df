//! The device pass: one dispatch a band of rows.

use crate::brdf::{Brdf, MaskingShadowing};
use crate::glsl::constants::GROUP_SIDE;
use crate::glsl::layout::{DfgParams, SharedStruct};
use crate::gpu::{Bind, ComputePipeline, Format, Gpu, GpuError, Image, Report, Slot};

pub struct DfgPass {
    pipeline: ComputePipeline,
}

impl DfgPass {
    /// The shader that makes the table.
    pub fn shader(brdf: &dyn Brdf) -> String {
        format!("precompute/dfg.comp:{}", brdf.name())
    }

    pub fn new(gpu: &Gpu, brdf: &dyn Brdf, masking_shadowing: MaskingShadowing) -> Result<Self, GpuError> {
        let slots = [Slot::StorageImage];
        let pipeline =
            gpu.compute_pipeline(&Self::shader(brdf), &slots, DfgParams::SIZE, &[masking_shadowing as u32])?;
        Ok(Self { pipeline })
    }

    /// A table to fill.
    pub fn table(gpu: &Gpu, side: u32) -> Result<Image, GpuError> {
        gpu.image("DFG table", [side, side], 1, Format::Rgba32Float)
    }

    /// Fills `table` by quadrature with `sample_count` nodes a texel (a multiple of 32; others round down).
    pub fn run(&self, gpu: &Gpu, sample_count: u32, table: &Image) -> Result<Report, GpuError> {
        let [width, height] = table.mip_size(0);
        let mut total = Report::default();
        for rows in gpu.row_bands(height, u64::from(width) * u64::from(sample_count), GROUP_SIDE) {
            let params = DfgParams { width, height, sample_count, first_row: rows.start };
            let groups = [width.div_ceil(GROUP_SIDE), (rows.end - rows.start).div_ceil(GROUP_SIDE), 1];
            let binds = [Bind::StoreMip(table, 0)];
            let mut recorder = gpu.record("dfg")?;
            recorder.pass("dfg", |r| r.dispatch(&self.pipeline, &binds, &params.to_bytes(), groups))?;
            total.add(recorder.submit()?);
        }
        Ok(total)
    }
}
