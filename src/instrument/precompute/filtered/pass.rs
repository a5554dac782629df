//! The device passes: one dispatch per part of the finest level, then one per level.

use crate::base::glsl::constants::RESAMPLE_SIDE;
use crate::base::glsl::layout::{ResampleParams, SharedStruct};
use crate::instrument::environment::layout::MapLayout;
use crate::instrument::gpu::{Bind, Format, Gpu, GpuError, Image, Report, Sampler, face_groups};
use crate::instrument::precompute::mips::{self, level_count};

const HALVE: &str = "precompute/halve.comp";

pub fn shaders(layout: &MapLayout) -> [String; 2] {
    [
        format!("precompute/resample.comp:{}", layout.name),
        HALVE.to_owned(),
    ]
}

/// Makes a map for an environment of this size.
pub fn map(gpu: &Gpu, layout: &MapLayout, environment_size: [u32; 2]) -> Result<Image, GpuError> {
    let size = (layout.finest_size)(environment_size);
    gpu.faced_image(
        "filtered environment",
        size,
        layout.face_count,
        level_count(size),
        Format::Rgba32Float,
    )
}

/// Fills every level of `map` from level 0 of `environment`.
pub fn run(
    gpu: &Gpu,
    layout: &MapLayout,
    environment: &Image,
    map: &Image,
) -> Result<Report, GpuError> {
    let ([source_width, source_height], [width, height]) =
        (environment.mip_size(0), map.mip_size(0));
    let [resample, _] = shaders(layout);
    let faces = map.face_count();
    let mut total = Report::default();
    for part in gpu.parts(
        [width, height],
        faces,
        u64::from(RESAMPLE_SIDE * RESAMPLE_SIDE),
    ) {
        let push = ResampleParams {
            source_width,
            source_height,
            width,
            height,
            first_row: part.first_row,
        }
        .to_bytes();
        let binds = [
            Bind::SampleMip(environment, Sampler::TEXELS, 0),
            Bind::StoreFaces(map, 0),
        ];
        total.add(gpu.submit_pass("mips", |r| {
            r.dispatch(&resample, &[], &binds, &push, part.groups)
        })?);
    }
    total.add(gpu.submit_pass("mips", |recorder| {
        (1..map.mip_count()).try_for_each(|mip| {
            let push = mips::pass::parameters(map, mip).to_bytes();
            let [width, height] = map.mip_size(mip);
            let binds = [
                Bind::SampleFaces(map, Sampler::TEXELS, mip - 1),
                Bind::StoreFaces(map, mip),
            ];
            recorder.dispatch(HALVE, &[], &binds, &push, face_groups(width, height, faces))
        })
    })?);
    Ok(total)
}
