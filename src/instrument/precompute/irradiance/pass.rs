//! A map of irradiance over π, synthesised on the host from spherical harmonics or integrated on
//! the device.

use crate::base::glsl::layout::{IrradianceParams, SharedStruct};
use crate::base::math::harmonics::Harmonics;
use crate::instrument::environment::layout::MapLayout;
use crate::instrument::gpu::{Bind, Format, Gpu, GpuError, Image, PassTime, Report, Sampler};
use crate::instrument::precompute::prefilter::harmonic::{cosine_factors, texels};
use std::time::Instant;

const PASS: &str = "irradiance";

pub fn shader(layout: &MapLayout) -> String {
    format!("precompute/irradiance_integrate.comp:{}", layout.name)
}

pub fn map(gpu: &Gpu, layout: &MapLayout, size: [u32; 2]) -> Result<Image, GpuError> {
    gpu.faced_image(
        "irradiance map",
        size,
        layout.face_count,
        1,
        Format::Rgba32Float,
    )
}

/// Integrates the environment's filtered levels (same layout) over each texel's hemisphere at
/// `[phi, theta]` midpoints.
pub fn run(
    gpu: &Gpu,
    layout: &MapLayout,
    environment: &Image,
    sample_count: [u32; 2],
    map: &Image,
) -> Result<Report, GpuError> {
    let ([width, height], [source_width, source_height]) =
        (map.mip_size(0), environment.mip_size(0));
    let [phi_count, theta_count] = sample_count;
    let whole = IrradianceParams {
        width,
        height,
        phi_count,
        theta_count,
        source_width,
        source_height,
        first_row: 0,
    };
    let shader = shader(layout);
    let binds = [
        Bind::Sample(environment, Sampler::MAP),
        Bind::StoreFaces(map, 0),
    ];
    let mut total = Report::default();
    for part in gpu.parts(
        [width, height],
        map.face_count(),
        u64::from(phi_count) * u64::from(theta_count),
    ) {
        let push = IrradianceParams {
            first_row: part.first_row,
            ..whole
        }
        .to_bytes();
        total.add(gpu.submit_pass(PASS, |r| {
            r.dispatch(&shader, &[], &binds, &push, part.groups)
        })?);
    }
    Ok(total)
}

/// As [`run`], by convolution with the cosine; reports the host's time.
pub fn run_harmonic(
    gpu: &Gpu,
    layout: &MapLayout,
    harmonics: &Harmonics,
    map: &Image,
) -> Result<Report, GpuError> {
    let start = Instant::now();
    gpu.write_image(
        map,
        0,
        &texels(
            harmonics,
            &cosine_factors(harmonics.degree()),
            layout,
            map.mip_size(0),
        ),
    )?;
    let ms = 1e3 * start.elapsed().as_secs_f64();
    Ok(Report {
        passes: vec![PassTime { pass: PASS, ms }],
        wall_ms: ms,
        ..Report::default()
    })
}
