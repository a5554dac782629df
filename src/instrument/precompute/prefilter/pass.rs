//! The device pass: one dispatch per level, part of it and range of points.

use super::{Kernel, LevelMapping, harmonic};
use crate::base::glsl::constants::POINTS_PER_DISPATCH;
use crate::base::glsl::layout::{PrefilterParams, SharedStruct};
use crate::base::glsl::specialization::Specialization;
use crate::base::math::harmonics::Harmonics;
use crate::instrument::brdf::{Brdf, MODELS, MaskingShadowing};
use crate::instrument::environment::layout::MapLayout;
use crate::instrument::gpu::{
    Bind, Format, Gpu, GpuError, Image, PassTime, Report, Sampler, has_shader,
};
use crate::instrument::precompute::PrecomputeSettings;
use crate::instrument::precompute::points::Points;
use std::time::Instant;

/// The table that all [`PASSES`] fill.
pub const TABLE: &str = "prefilter";
/// Pass names of the levels. Levels halve a side of at most 4096 texels, so there are no more.
pub const PASSES: [&str; 12] = [
    "prefilter mip 0",
    "prefilter mip 1",
    "prefilter mip 2",
    "prefilter mip 3",
    "prefilter mip 4",
    "prefilter mip 5",
    "prefilter mip 6",
    "prefilter mip 7",
    "prefilter mip 8",
    "prefilter mip 9",
    "prefilter mip 10",
    "prefilter mip 11",
];

/// Names the shader of a model. The map of a sheen lobe takes its mirror from another, and is exact
/// beyond.
pub fn shader(brdf: &dyn Brdf, layout: &MapLayout) -> String {
    let name = |model: &str| format!("precompute/prefilter.comp:{model}:{}", layout.name);
    Some(name(brdf.name()))
        .filter(|name| has_shader(name))
        .unwrap_or_else(|| name(MODELS[0].name()))
}

pub fn map(
    gpu: &Gpu,
    layout: &MapLayout,
    size: [u32; 2],
    level_count: u32,
) -> Result<Image, GpuError> {
    gpu.faced_image(
        "prefiltered map",
        size,
        layout.face_count,
        level_count,
        Format::Rgba32Float,
    )
}

/// Contents of the levels of a map.
#[derive(Clone, Copy, Debug)]
pub struct Recipe {
    pub kernel: Kernel,
    pub mapping: &'static LevelMapping,
    /// Added to the level of each sample's lookup.
    pub lod_bias: f32,
}

impl Recipe {
    pub fn new(
        brdf: &'static dyn Brdf,
        masking: MaskingShadowing,
        settings: &PrecomputeSettings,
    ) -> Self {
        let kernel = Kernel::new(brdf, settings.prefilter_weight, masking);
        Self {
            kernel,
            mapping: settings.level_mapping,
            lod_bias: settings.prefilter_lod_bias,
        }
    }
}

/// Fills every level of `map` from `points` and the environment's filtered levels of the same
/// layout.
pub fn run(
    gpu: &Gpu,
    recipe: Recipe,
    layout: &MapLayout,
    environment: &Image,
    points: &Points,
    map: &Image,
) -> Result<Report, GpuError> {
    let mut total = Report::default();
    for level in 0..map.mip_count() {
        total.add(sample(
            gpu,
            recipe,
            layout,
            environment,
            points,
            map,
            level,
        )?);
    }
    Ok(total)
}

/// As [`run`], with all levels but a mirror synthesised on the host; reports the host's time.
pub fn run_harmonic(
    gpu: &Gpu,
    recipe: Recipe,
    layout: &MapLayout,
    environment: &Image,
    (points, harmonics): (&Points, &Harmonics),
    map: &Image,
) -> Result<Report, GpuError> {
    let mut total = Report::default();
    for level in 0..map.mip_count() {
        let start = Instant::now();
        let alpha = recipe
            .mapping
            .alpha_from_mip(f64::from(level), map.mip_count());
        if alpha == 0.0 {
            total.add(sample(
                gpu,
                recipe,
                layout,
                environment,
                points,
                map,
                level,
            )?);
            continue;
        }
        let texels = harmonic::level(harmonics, recipe.kernel, alpha, layout, map.mip_size(level));
        gpu.write_image(map, level, &texels)?;
        let ms = 1e3 * start.elapsed().as_secs_f64();
        let passes = vec![PassTime {
            pass: PASSES[(level as usize).min(PASSES.len() - 1)],
            ms,
        }];
        total.add(Report {
            passes,
            wall_ms: ms,
            ..Report::default()
        });
    }
    Ok(total)
}

/// Fills a level, one dispatch per part and range of points; each adds to the sums in its texels.
fn sample(
    gpu: &Gpu,
    recipe: Recipe,
    layout: &MapLayout,
    environment: &Image,
    points: &Points,
    map: &Image,
    level: u32,
) -> Result<Report, GpuError> {
    let [source_width, source_height] = environment.mip_size(0);
    let Recipe {
        kernel,
        mapping,
        lod_bias,
    } = recipe;
    let shader = shader(kernel.brdf, layout);
    let sample_count = points.count();
    let specialization = Specialization {
        masking: kernel.masking as u32,
        prefilter_weight: kernel.weight.code,
        ..Specialization::default()
    };
    let [width, height] = map.mip_size(level);
    let alpha = mapping.alpha_from_mip(f64::from(level), map.mip_count()) as f32;
    let is_mirror = alpha == 0.0;
    let points_per_texel = if is_mirror {
        1
    } else {
        sample_count.min(POINTS_PER_DISPATCH)
    };
    let mut total = Report::default();
    for part in gpu.parts([width, height], map.face_count(), points_per_texel.into()) {
        for range in points.ranges().take(if is_mirror { 1 } else { usize::MAX }) {
            let params = PrefilterParams {
                width,
                height,
                source_width,
                source_height,
                sample_count,
                alpha,
                lod_bias,
                first_row: part.first_row,
                first_point: range.first,
                point_count: range.count,
            };
            let binds = [
                Bind::Sample(environment, Sampler::MAP),
                Bind::UpdateFaces(map, level),
                range.bind(),
            ];
            let name = PASSES[(level as usize).min(PASSES.len() - 1)];
            let push = params.to_bytes();
            total.add(gpu.submit_pass(name, |r| {
                r.dispatch(&shader, &specialization.words(), &binds, &push, part.groups)
            })?);
        }
    }
    Ok(total)
}
