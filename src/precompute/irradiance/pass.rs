//! The device passes: a map of irradiance over π from SH9, or by numerical integration.

use crate::glsl::constants::GROUP_SIDE;
use crate::glsl::layout::{IrradianceParams, SharedStruct};
use crate::gpu::{Bind, Buffer, ComputePipeline, Format, Gpu, GpuError, Image, Recorder, Sampler, Slot};

pub struct IrradiancePass {
    from_sh9: ComputePipeline,
    integrate: ComputePipeline,
}

impl IrradiancePass {
    /// The shader of [`Self::record_integrate`].
    pub const INTEGRATE_SHADER: &str = "precompute/irradiance_integrate.comp";

    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let size = IrradianceParams::SIZE;
        let from_sh9 =
            gpu.compute_pipeline("precompute/irradiance_sh9.comp", &[Slot::Buffer, Slot::StorageImage], size, &[])?;
        let integrate =
            gpu.compute_pipeline(Self::INTEGRATE_SHADER, &[Slot::Sampled, Slot::StorageImage], size, &[])?;
        Ok(Self { from_sh9, integrate })
    }

    /// A map to fill.
    pub fn map(gpu: &Gpu, size: [u32; 2]) -> Result<Image, GpuError> {
        gpu.image("irradiance map", size, 1, Format::Rgba32Float)
    }

    /// Evaluates nine radiance coefficients at every texel.
    pub fn record_from_sh9(&self, recorder: &mut Recorder, sh9: &Buffer, map: &Image) -> Result<(), GpuError> {
        let [width, height] = map.mip_size(0);
        let push = IrradianceParams { width, height, ..Default::default() }.to_bytes();
        recorder.dispatch(&self.from_sh9, &[Bind::Read(sh9), Bind::StoreMip(map, 0)], &push, groups(map))
    }

    /// Integrates over the hemisphere of every texel with `[phi, theta]` midpoints.
    pub fn record_integrate(
        &self,
        recorder: &mut Recorder,
        environment: &Image,
        sampler: &Sampler,
        sample_count: [u32; 2],
        map: &Image,
    ) -> Result<(), GpuError> {
        let ([width, height], [source_width, source_height]) = (map.mip_size(0), environment.mip_size(0));
        let [phi_count, theta_count] = sample_count;
        let params =
            IrradianceParams { width, height, phi_count, theta_count, source_width, source_height, pad0: 0, pad1: 0 };
        let binds = [Bind::Sample(environment, sampler), Bind::StoreMip(map, 0)];
        recorder.dispatch(&self.integrate, &binds, &params.to_bytes(), groups(map))
    }
}

fn groups(map: &Image) -> [u32; 3] {
    let [width, height] = map.mip_size(0);
    [width.div_ceil(GROUP_SIDE), height.div_ceil(GROUP_SIDE), 1]
}
