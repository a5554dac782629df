//! The device pass: one dispatch per part of the table.

use super::DfgAxes;
use crate::base::glsl::layout::{DfgParams, SharedStruct};
use crate::base::glsl::specialization::Specialization;
use crate::instrument::brdf::{Brdf, MaskingShadowing};
use crate::instrument::gpu::{Bind, Format, Gpu, GpuError, Image, Report};

pub fn shader(brdf: &dyn Brdf) -> String {
    format!("precompute/dfg.comp:{}", brdf.name())
}

pub fn table(gpu: &Gpu, side: u32) -> Result<Image, GpuError> {
    gpu.image("DFG table", [side, side], 1, Format::Rgba32Float)
}

/// Fills `table` by quadrature with `sample_count` nodes per texel (a multiple of 32; others round
/// down). `fresnel_f0` is the specialization constant.
pub fn run(
    gpu: &Gpu,
    brdf: &dyn Brdf,
    masking_shadowing: MaskingShadowing,
    axes: DfgAxes,
    fresnel_f0: f32,
    sample_count: u32,
    table: &Image,
) -> Result<Report, GpuError> {
    let [width, height] = table.mip_size(0);
    let shader = shader(brdf);
    let specialization = Specialization {
        masking: masking_shadowing as u32,
        dfg_axes: axes as u32,
        fresnel_f0,
        ..Specialization::default()
    };
    let mut total = Report::default();
    for part in gpu.parts([width, height], 1, sample_count.into()) {
        let push = DfgParams {
            width,
            height,
            sample_count,
            first_row: part.first_row,
        }
        .to_bytes();
        let binds = [Bind::StoreMip(table, 0)];
        total.add(gpu.submit_pass("dfg", |r| {
            r.dispatch(&shader, &specialization.words(), &binds, &push, part.groups)
        })?);
    }
    Ok(total)
}
