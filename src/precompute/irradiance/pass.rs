//! The device passes: a map of irradiance over π from SH9, or by numerical integration.

use crate::glsl::layout::{IrradianceParams, SharedStruct};
use crate::gpu::{Bind, Buffer, Format, Gpu, GpuError, Image, Report, Sampler, image_groups};

/// The shader of [`integrate`].
pub const INTEGRATE_SHADER: &str = "precompute/irradiance_integrate.comp";

/// A map to fill.
pub fn map(gpu: &Gpu, size: [u32; 2]) -> Result<Image, GpuError> {
    gpu.image("irradiance map", size, 1, Format::Rgba32Float)
}

/// Evaluates nine radiance coefficients at every texel.
pub fn from_sh9(gpu: &Gpu, sh9: &Buffer, map: &Image) -> Result<Report, GpuError> {
    let [width, height] = map.mip_size(0);
    let push = IrradianceParams { width, height, ..Default::default() }.to_bytes();
    let binds = [Bind::Read(sh9), Bind::StoreMip(map, 0)];
    gpu.submit_pass("irradiance", |r| {
        r.dispatch("precompute/irradiance_sh9.comp", &[], &binds, &push, image_groups(width, height))
    })
}

/// Integrates over the hemisphere of every texel with `[phi, theta]` midpoints.
pub fn integrate(gpu: &Gpu, environment: &Image, sample_count: [u32; 2], map: &Image) -> Result<Report, GpuError> {
    let ([width, height], [source_width, source_height]) = (map.mip_size(0), environment.mip_size(0));
    let [phi_count, theta_count] = sample_count;
    let params =
        IrradianceParams { width, height, phi_count, theta_count, source_width, source_height, pad0: 0, pad1: 0 };
    let binds = [Bind::Sample(environment, Sampler::EQUIRECT), Bind::StoreMip(map, 0)];
    gpu.submit_pass("irradiance", |r| {
        r.dispatch(INTEGRATE_SHADER, &[], &binds, &params.to_bytes(), image_groups(width, height))
    })
}
