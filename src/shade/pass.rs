//! The device passes of every method but the reference: specular, diffuse, analytic lights, background.

use super::{Diffuse, Method};
use crate::brdf::{Brdf, MaskingShadowing};
use crate::gbuffer::pass::GbufferImages;
use crate::glsl::constants::{GROUP_SIDE, SHADE_FLAG_NO_SPECULAR};
use crate::glsl::layout::{BackgroundParams, LightData, ShadeParams, SharedStruct};
use crate::gpu::{
    Bind, Buffer, ComputePipeline, Filter, Gpu, GpuError, Image, Recorder, Sampler, Slot, Wrap, has_shader,
};
use crate::precompute::points::{PointRange, Points};
use crate::scene::{Camera, Light, Projection};
use glam::{DMat3, DVec3};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// What every shading pass needs to know besides the tables: camera and environment placement, and the method's parameters.
#[derive(Clone, Debug)]
pub struct ShadeSettings {
    pub camera: Camera,
    pub environment_rotation_deg: f64,
    pub environment_scale: f32,
    pub environment_size: [u32; 2],
    pub sample_count: u32,
    pub lod_bias: f32,
    pub prefilter_level_count: u32,
    /// Whether the image has a specular term that takes its share from the diffuse one.
    pub has_specular: bool,
    pub light_count: u32,
}

/// The environment's tables on the device, as the shading passes bind them.
#[derive(Clone, Copy)]
pub struct Tables<'a> {
    pub environment: &'a Image,
    pub prefiltered: &'a Image,
    pub dfg: &'a Image,
    pub irradiance_map: &'a Image,
    pub sh9: &'a Buffer,
    pub points: &'a Points,
}

/// The pipelines of the passes, made when they are first needed.
pub struct ShadePass {
    specular: HashMap<(&'static str, &'static str, MaskingShadowing), ComputePipeline>,
    diffuse: HashMap<&'static str, ComputePipeline>,
    lights: HashMap<(&'static str, MaskingShadowing), ComputePipeline>,
    background: ComputePipeline,
    nearest: Sampler,
    equirect: Sampler,
    clamp: Sampler,
}

/// Rows turn a world direction into the frame of an environment turned by `rotation_deg` about +y (counter-clockwise seen from above).
pub fn environment_from_world(rotation_deg: f64) -> DMat3 {
    DMat3::from_rotation_y(rotation_deg.to_radians()).transpose()
}

impl ShadeSettings {
    /// The push constants for rows from `first_row` on.
    pub fn params(&self, size: [u32; 2], first_row: u32) -> ShadeParams {
        let rows = environment_from_world(self.environment_rotation_deg).transpose();
        let row = |v: DVec3| v.extend(0.0).as_vec4().to_array();
        ShadeParams {
            environment_from_world_0: row(rows.x_axis),
            environment_from_world_1: row(rows.y_axis),
            environment_from_world_2: row(rows.z_axis),
            eye: eye(&self.camera),
            width: size[0],
            height: size[1],
            environment_width: self.environment_size[0],
            environment_height: self.environment_size[1],
            sample_count: self.sample_count,
            scramble: 0,
            first_row,
            prefilter_level_count: self.prefilter_level_count,
            environment_scale: self.environment_scale,
            lod_bias: self.lod_bias,
            light_count: self.light_count,
            flags: if self.has_specular { 0 } else { SHADE_FLAG_NO_SPECULAR },
            seed: 0,
            scramble_count: 0,
            point_count: 0,
            slot_count: 0,
        }
    }
}

/// Eye position (w = 1), or direction to the viewer (w = 0).
pub(super) fn eye(camera: &Camera) -> [f32; 4] {
    match camera.projection {
        Projection::Perspective { .. } => camera.eye.extend(1.0).as_vec4().to_array(),
        Projection::Ortho { .. } => (-camera.forward).extend(0.0).as_vec4().to_array(),
    }
}

/// The lights as the pass reads them.
pub fn light_data(lights: &[Light]) -> Vec<u8> {
    let data = |light: &Light| {
        let [r, g, b] = light.color;
        LightData {
            position_or_direction: light.position_or_direction.extend(0.0).as_vec4().to_array(),
            color_kind: [r, g, b, light.kind as u32 as f32],
        }
    };
    lights.iter().flat_map(|light| data(light).to_bytes()).collect()
}

/// Bindings 0 to 3 of every shading pass.
pub(super) const GBUFFER_SLOTS: [Slot; 4] = [Slot::Sampled; 4];

/// The g-buffer at bindings 0 to 3, then `rest`.
pub(super) fn with_gbuffer<'a>(gbuffer: &'a GbufferImages, nearest: &'a Sampler, rest: &[Bind<'a>]) -> Vec<Bind<'a>> {
    gbuffer.attachments.iter().map(|image| Bind::Sample(image, nearest)).chain(rest.iter().cloned()).collect()
}

/// Work groups over a band of rows.
pub(super) fn groups(width: u32, row_count: u32) -> [u32; 3] {
    [width.div_ceil(GROUP_SIDE), row_count.div_ceil(GROUP_SIDE), 1]
}

impl ShadePass {
    /// The shader of the background.
    pub const BACKGROUND_SHADER: &str = "shade/background.comp";

    /// The shader of analytic lights.
    pub fn lights_shader(brdf: &dyn Brdf) -> String {
        format!("shade/lights.comp:{}", brdf.name())
    }

    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let slots = [&GBUFFER_SLOTS[..], &[Slot::Sampled, Slot::Buffer]].concat();
        Ok(Self {
            specular: HashMap::new(),
            diffuse: HashMap::new(),
            lights: HashMap::new(),
            background: gpu.compute_pipeline(Self::BACKGROUND_SHADER, &slots, BackgroundParams::SIZE, &[])?,
            nearest: gpu.sampler(Filter::Nearest, Wrap::Clamp)?,
            equirect: gpu.sampler(Filter::Linear, Wrap::Equirect)?,
            clamp: gpu.sampler(Filter::Linear, Wrap::Clamp)?,
        })
    }

    /// The sampler of equirectangular maps: trilinear, u repeats.
    pub fn equirect_sampler(&self) -> &Sampler {
        &self.equirect
    }

    /// Makes the pipeline of a specular method, if it is not made yet.
    pub fn prepare_specular(
        &mut self,
        gpu: &Gpu,
        method: &Method,
        brdf: &dyn Brdf,
        masking_shadowing: MaskingShadowing,
    ) -> Result<(), GpuError> {
        let key = (method.name, brdf.name(), masking_shadowing);
        if let Entry::Vacant(entry) = self.specular.entry(key) {
            let general = format!("shade/specular.comp:{}", method.name);
            let special = format!("{general}:{}", brdf.name());
            let shader = if has_shader(&special) { special } else { general };
            let slots = [&GBUFFER_SLOTS[..], &[Slot::Sampled; 3], &[Slot::Uniform, Slot::Buffer]].concat();
            let pipeline = gpu.compute_pipeline(&shader, &slots, ShadeParams::SIZE, &[masking_shadowing as u32])?;
            entry.insert(pipeline);
        }
        Ok(())
    }

    /// Makes the pipeline of a diffuse method, if it is not made yet.
    pub fn prepare_diffuse(&mut self, gpu: &Gpu, diffuse: &Diffuse) -> Result<(), GpuError> {
        if let Entry::Vacant(entry) = self.diffuse.entry(diffuse.name) {
            let slots = [&GBUFFER_SLOTS[..], &[Slot::Sampled; 2], &[Slot::Buffer; 2]].concat();
            let shader = format!("shade/diffuse.comp:{}", diffuse.name);
            entry.insert(gpu.compute_pipeline(&shader, &slots, ShadeParams::SIZE, &[])?);
        }
        Ok(())
    }

    /// Makes the pipeline of the analytic lights, if it is not made yet.
    pub fn prepare_lights(
        &mut self,
        gpu: &Gpu,
        brdf: &dyn Brdf,
        masking_shadowing: MaskingShadowing,
    ) -> Result<(), GpuError> {
        let key = (brdf.name(), masking_shadowing);
        if let Entry::Vacant(entry) = self.lights.entry(key) {
            let slots = [&GBUFFER_SLOTS[..], &[Slot::Sampled, Slot::Buffer, Slot::Buffer]].concat();
            let shader = Self::lights_shader(brdf);
            let pipeline = gpu.compute_pipeline(&shader, &slots, ShadeParams::SIZE, &[masking_shadowing as u32])?;
            entry.insert(pipeline);
        }
        Ok(())
    }

    /// Adds what the points `points` give of the specular image-based radiance of the rows `rows`; the pipeline must be prepared.
    #[allow(clippy::too_many_arguments)] // one argument a thing the pass reads; a struct would only rename them
    pub fn record_specular(
        &self,
        recorder: &mut Recorder,
        method: &Method,
        brdf: &dyn Brdf,
        masking_shadowing: MaskingShadowing,
        settings: &ShadeSettings,
        tables: Tables<'_>,
        gbuffer: &GbufferImages,
        radiance: &Buffer,
        points: PointRange<'_>,
        rows: std::ops::Range<u32>,
    ) -> Result<(), GpuError> {
        let pipeline = &self.specular[&(method.name, brdf.name(), masking_shadowing)];
        let rest = [
            Bind::Sample(tables.environment, &self.equirect),
            Bind::Sample(tables.prefiltered, &self.equirect),
            Bind::Sample(tables.dfg, &self.clamp),
            points.bind(),
            Bind::ReadWrite(radiance),
        ];
        let push = ShadeParams { point_count: points.count, ..settings.params(gbuffer.size, rows.start) }.to_bytes();
        let binds = with_gbuffer(gbuffer, &self.nearest, &rest);
        recorder.dispatch(pipeline, &binds, &push, groups(gbuffer.size[0], rows.end - rows.start))
    }

    /// Adds the diffuse image-based radiance; the pipeline must be prepared.
    pub fn record_diffuse(
        &self,
        recorder: &mut Recorder,
        diffuse: &Diffuse,
        settings: &ShadeSettings,
        tables: Tables<'_>,
        gbuffer: &GbufferImages,
        radiance: &Buffer,
    ) -> Result<(), GpuError> {
        let rest = [
            Bind::Sample(tables.irradiance_map, &self.equirect),
            Bind::Sample(tables.dfg, &self.clamp),
            Bind::Read(tables.sh9),
            Bind::ReadWrite(radiance),
        ];
        let push = settings.params(gbuffer.size, 0).to_bytes();
        let [width, height] = gbuffer.size;
        let binds = with_gbuffer(gbuffer, &self.nearest, &rest);
        recorder.dispatch(&self.diffuse[diffuse.name], &binds, &push, groups(width, height))
    }

    /// Adds the radiance of analytic lights; the pipeline must be prepared.
    #[allow(clippy::too_many_arguments)] // as above
    pub fn record_lights(
        &self,
        recorder: &mut Recorder,
        brdf: &dyn Brdf,
        masking_shadowing: MaskingShadowing,
        settings: &ShadeSettings,
        dfg: &Image,
        lights: &Buffer,
        gbuffer: &GbufferImages,
        radiance: &Buffer,
    ) -> Result<(), GpuError> {
        let rest = [Bind::Sample(dfg, &self.clamp), Bind::Read(lights), Bind::ReadWrite(radiance)];
        let push = settings.params(gbuffer.size, 0).to_bytes();
        let [width, height] = gbuffer.size;
        let binds = with_gbuffer(gbuffer, &self.nearest, &rest);
        recorder.dispatch(&self.lights[&(brdf.name(), masking_shadowing)], &binds, &push, groups(width, height))
    }

    /// Shows the environment where nothing is hit.
    pub fn record_background(
        &self,
        recorder: &mut Recorder,
        settings: &ShadeSettings,
        environment: &Image,
        gbuffer: &GbufferImages,
        radiance: &Buffer,
    ) -> Result<(), GpuError> {
        let [width, height] = gbuffer.size;
        let camera = &settings.camera;
        let turn = environment_from_world(settings.environment_rotation_deg);
        let [extent_x, extent_y] = match camera.projection {
            Projection::Perspective { .. } => camera.extent(f64::from(width) / f64::from(height)),
            Projection::Ortho { .. } => [0.0, 0.0],
        };
        let vec4 = |v: DVec3| (turn * v).extend(0.0).as_vec4().to_array();
        let params = BackgroundParams {
            right: vec4(camera.right * extent_x),
            up: vec4(camera.up * extent_y),
            forward: vec4(camera.forward),
            width,
            height,
            first_row: 0,
            environment_scale: settings.environment_scale,
        };
        let rest = [Bind::Sample(environment, &self.equirect), Bind::ReadWrite(radiance)];
        let binds = with_gbuffer(gbuffer, &self.nearest, &rest);
        recorder.dispatch(&self.background, &binds, &params.to_bytes(), groups(width, height))
    }
}
