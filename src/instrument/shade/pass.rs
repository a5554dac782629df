//! The device passes of all methods but the reference: specular, diffuse, background.

use super::{Method, Shading};
use crate::base::glsl::constants::ANISOTROPY_NONE;
use crate::base::glsl::layout::{BackgroundParams, LightData, ShadeParams, SharedStruct};
use crate::base::glsl::specialization::Specialization;
use crate::instrument::brdf::{Brdf, FresnelWeight};
use crate::instrument::environment::layout::MapLayout;
use crate::instrument::gbuffer::pass::GbufferImages;
use crate::instrument::gpu::{
    Bind, Buffer, Filter, Gpu, GpuError, Image, Part, Recorder, Sampler, Wrap, has_shader,
};
use crate::instrument::precompute::points::{PointRange, Points};
use crate::instrument::scene::light::{Emitter, Light};
use crate::instrument::scene::{Camera, Projection};
use glam::DVec3;

#[derive(Clone)]
pub struct Tables {
    pub environment: Image,
    /// The environment's levels in the layout of the maps.
    pub filtered: Image,
    pub prefiltered: Image,
    pub dfg: Image,
    /// The table of taps that the method reads.
    pub tap_table: Image,
    pub irradiance_map: Image,
    pub sh9: Buffer,
    /// Equirectangular irradiance over π of the coefficients.
    pub sh9_texture: Image,
    pub points: Points,
    /// Shift of each pixel's points, as fixed point; read only in sequences of frames.
    pub shifts: Buffer,
}

/// Inputs of one frame's passes, and the radiance that each adds to.
#[derive(Clone, Copy)]
pub struct Passes<'a> {
    pub shading: &'a Shading,
    pub camera: &'a Camera,
    pub tables: &'a Tables,
    pub gbuffer: &'a GbufferImages,
    /// The specialization constant.
    pub fresnel_f0: f32,
    /// The g-buffer of [`crate::instrument::scene::Scene::tangents`], if lobes have two widths.
    pub tangents: Option<&'a GbufferImages>,
    /// A vec4 per pixel.
    pub radiance: &'a Buffer,
}

/// Eye position (w = 1), or direction to the viewer (w = 0).
pub(super) fn eye(camera: &Camera) -> [f32; 4] {
    match camera.projection {
        Projection::Perspective { .. } => camera.eye.extend(1.0).as_vec4().to_array(),
        Projection::Ortho { .. } => (-camera.forward).extend(0.0).as_vec4().to_array(),
    }
}

pub(super) const TABLE: Sampler = Sampler(Filter::Linear, Wrap::CLAMP);

/// The timed passes that shade surfaces: the only ones whose cost depends on the method.
pub const SPECULAR_PASS: &str = "shade-specular";
pub const DIFFUSE_PASS: &str = "shade-diffuse";
/// The pass of direct lights, the same for every method.
pub const LIGHTS_PASS: &str = "shade-lights";

pub const BACKGROUND_SHADER: &str = "shade/background.comp";

/// Names the shader of a method's specular pass. Methods that do not use the model have one shader
/// for all models.
pub fn specular_shader(layout: &MapLayout, method: &Method, brdf: &dyn Brdf) -> String {
    let general = format!(
        "shade/specular.comp:{}:{}",
        layout.name,
        method.shader.unwrap_or(method.name)
    );
    let special = format!("{general}:{}", brdf.name());
    if has_shader(&special) {
        special
    } else {
        general
    }
}

/// Direct lights on the device.
pub struct LightBuffer {
    buffer: Buffer,
    count: u32,
}

impl LightBuffer {
    /// Uploads at least one light; their units must be absolute.
    pub fn new(gpu: &Gpu, lights: &[Light]) -> Result<Self, GpuError> {
        let bytes: Vec<u8> = lights
            .iter()
            .flat_map(|light| light_data(light).to_bytes())
            .collect();
        Ok(Self {
            buffer: gpu.buffer_from("lights", &bytes)?,
            count: lights.len() as u32,
        })
    }

    pub fn count(&self) -> u32 {
        self.count
    }
}

fn light_data(light: &Light) -> LightData {
    // Without a cone: 2 - |l|²/2 is above 1.
    const NO_CONE: [f64; 2] = [2.0, 1.0];
    let vec4 = |v: DVec3, w: f64| v.extend(w).as_vec4().to_array();
    let place = match light.emitter {
        Emitter::Directional { direction } => vec4(-direction, 0.0),
        Emitter::Point { position } | Emitter::Spot { position, .. } => vec4(position, 1.0),
    };
    let (axis, [outer_versine, scale]) = match light.emitter {
        Emitter::Spot {
            direction, cone, ..
        } => (direction, cone.falloff_terms()),
        _ => (DVec3::ZERO, NO_CONE),
    };
    let [r, g, b] = light.color;
    LightData {
        place,
        color: [r, g, b, light.range.map_or(0.0, |range| 1.0 / range) as f32],
        axis: vec4(axis, scale),
        outer_versine: outer_versine as f32,
    }
}

impl<'a> Passes<'a> {
    /// Binds the g-buffer at 0 to 3 and the tangents at 4, then `rest`.
    pub(super) fn binds(&self, rest: &[Bind<'a>]) -> Vec<Bind<'a>> {
        let [_, tangents, ..] = &self.tangents.unwrap_or(self.gbuffer).attachments;
        let attachments = self.gbuffer.attachments.iter().chain([tangents]);
        attachments
            .map(|image| Bind::Sample(image, Sampler::TEXELS))
            .chain(rest.iter().cloned())
            .collect()
    }

    /// Returns the specialization constant `anisotropy`: the law of the widths if the scene has
    /// lobes of two.
    pub(super) fn anisotropy(&self) -> u32 {
        self.tangents
            .map_or(ANISOTROPY_NONE, |_| self.shading.widths as u32)
    }

    /// Returns the push constants for rows from `first_row` on.
    pub(super) fn params(&self, first_row: u32) -> ShadeParams {
        let Self {
            shading,
            camera,
            tables,
            gbuffer,
            ..
        } = *self;
        let rows = shading.placement.environment_from_world().transpose();
        let row = |v: DVec3| v.extend(0.0).as_vec4().to_array();
        let [width, height] = gbuffer.size;
        let [environment_width, environment_height] = tables.environment.mip_size(0);
        ShadeParams {
            environment_from_world_0: row(rows.x_axis),
            environment_from_world_1: row(rows.y_axis),
            environment_from_world_2: row(rows.z_axis),
            eye: eye(camera),
            width,
            height,
            environment_width,
            environment_height,
            sample_count: shading.samples,
            first_pair: 0,
            first_row,
            prefilter_level_count: shading.precompute.prefilter_level_count,
            environment_scale: shading.environment_scale,
            lod_bias: shading.lod_bias,
            flags: shading.flags(),
            seed: shading.point_seed(),
            pair_count: 0,
            point_count: 0,
            slot_count: 0,
            light_count: 0,
        }
    }

    /// Dispatches a pass; `rest` is bound after the g-buffer and before the radiance.
    fn dispatch(
        &self,
        recorder: &mut Recorder,
        shader: &str,
        specialization: Specialization,
        rest: &[Bind<'a>],
        push: &[u8],
        part: Part,
    ) -> Result<(), GpuError> {
        let rest = [rest, &[Bind::ReadWrite(self.radiance)]].concat();
        let specialization = Specialization {
            anisotropy: self.anisotropy(),
            ..specialization
        };
        recorder.dispatch(
            shader,
            &specialization.words(),
            &self.binds(&rest),
            push,
            part.groups,
        )
    }

    /// Adds the specular image-based radiance of `points` to a part of the image.
    pub fn specular(
        &self,
        recorder: &mut Recorder,
        points: PointRange<'a>,
        part: Part,
    ) -> Result<(), GpuError> {
        let Shading {
            method,
            brdf,
            precompute,
            ..
        } = *self.shading;
        let shader = specular_shader(precompute.layout, method, brdf);
        let Tables {
            environment,
            filtered,
            prefiltered,
            dfg,
            tap_table,
            shifts,
            ..
        } = self.tables;
        let binds = [
            Bind::Sample(environment, Sampler::MAP),
            Bind::Sample(filtered, Sampler::MAP),
            Bind::Sample(prefiltered, Sampler::MAP),
            Bind::Sample(dfg, TABLE),
            Bind::Sample(tap_table, TABLE),
            points.bind(),
            Bind::ReadWrite(self.radiance),
            Bind::Read(shifts),
        ];
        let params = ShadeParams {
            point_count: points.count,
            ..self.params(part.first_row)
        };
        let specialization = Specialization {
            anisotropy: self.anisotropy(),
            ..self.reflecting(self.shading.specialization())
        };
        recorder.dispatch(
            &shader,
            &specialization.words(),
            &self.binds(&binds),
            &params.to_bytes(),
            part.groups,
        )
    }

    /// Returns the constants with Fresnel's reflectance of the surfaces.
    pub(super) fn reflecting(&self, general: Specialization) -> Specialization {
        Specialization {
            fresnel_f0: self.fresnel_f0,
            fresnel_mean: FresnelWeight::of_constant(self.fresnel_f0).mean() as f32,
            ..general
        }
    }

    pub fn diffuse(&self, recorder: &mut Recorder, part: Part) -> Result<(), GpuError> {
        let Shading {
            diffuse,
            precompute,
            ..
        } = *self.shading;
        let Tables {
            irradiance_map,
            dfg,
            sh9,
            sh9_texture,
            ..
        } = self.tables;
        let rest = [
            Bind::Sample(irradiance_map, Sampler::MAP),
            Bind::Sample(dfg, TABLE),
            Bind::Read(sh9),
            Bind::Sample(sh9_texture, Sampler::MAP),
        ];
        let push = self.params(part.first_row).to_bytes();
        let shader = format!(
            "shade/diffuse.comp:{}:{}",
            precompute.layout.name, diffuse.name
        );
        let specialization = self.reflecting(self.shading.table_specialization());
        self.dispatch(recorder, &shader, specialization, &rest, &push, part)
    }

    /// Adds the light of direct lights that a lobe of the reference reflects; `shader` and
    /// `specialization` are the lobe's.
    pub fn lights(
        &self,
        recorder: &mut Recorder,
        shader: &str,
        specialization: Specialization,
        lights: &'a LightBuffer,
        part: Part,
    ) -> Result<(), GpuError> {
        let rest = [
            Bind::Sample(&self.tables.dfg, TABLE),
            Bind::Read(&lights.buffer),
        ];
        let push = ShadeParams {
            light_count: lights.count,
            ..self.params(part.first_row)
        }
        .to_bytes();
        self.dispatch(recorder, shader, specialization, &rest, &push, part)
    }

    /// Shows the environment in pixels where nothing is hit.
    pub fn background(&self, recorder: &mut Recorder, part: Part) -> Result<(), GpuError> {
        let [width, height] = self.gbuffer.size;
        let camera = self.camera;
        let turn = self.shading.placement.environment_from_world();
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
            first_row: part.first_row,
            environment_scale: self.shading.environment_scale,
        };
        let rest = [Bind::Sample(&self.tables.environment, Sampler::MAP)];
        self.dispatch(
            recorder,
            BACKGROUND_SHADER,
            Specialization::default(),
            &rest,
            &params.to_bytes(),
            part,
        )
    }
}
