//! What a request needs before it can be shaded: tables, scene, targets, pipelines.

use super::cache::Recent;
use super::{PipelineError, RenderRequest, light_bytes};
use crate::brdf::MaskingShadowing;
use crate::environment::{
    Environment,
    distribution::{EnvironmentDistribution, weighted_texels},
};
use crate::gbuffer::pass::{GbufferImages, GbufferPass, SceneData};
use crate::gpu::{Buffer, Format, Gpu, Image, Report};
use crate::pixels::GrayImage;
use crate::precompute::dfg::pass::DfgPass;
use crate::precompute::irradiance::pass::IrradiancePass;
use crate::precompute::mips::{level_count, pass::MipsPass};
use crate::precompute::points::Points;
use crate::precompute::prefilter::pass::PrefilterPass;
use crate::precompute::sh9::pass::Sh9Pass;
use crate::scene::Camera;
use crate::shade::pass::{ShadePass, Tables};
use crate::shade::reference_pass::{Lobe, ReferencePass, Sums};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

/// Every pass, and the most recent of what they made.
pub(super) struct Resources {
    pub(super) gbuffer: GbufferPass,
    pub(super) shade: ShadePass,
    pub(super) reference: ReferencePass,
    mips: MipsPass,
    sh9: Sh9Pass,
    irradiance: IrradiancePass,
    prefilter: HashMap<&'static str, PrefilterPass>,
    dfg: HashMap<(&'static str, MaskingShadowing), DfgPass>,
    environments: Recent<String, Arc<EnvironmentData>>,
    distributions: Recent<String, Buffer>,
    coefficients: Recent<String, Buffer>,
    irradiance_maps: Recent<(String, [u32; 2], [u32; 2]), Image>,
    prefiltered: Recent<(String, &'static str, [u32; 2], u32, u32), Image>,
    dfg_tables: Recent<(&'static str, MaskingShadowing, u32, u32), Image>,
    points: Recent<(u32, u32), Points>,
    scenes: Recent<String, Arc<SceneData>>,
    targets: Recent<TargetKey, Arc<Target>>,
    /// Stand for tables that a request does not use, because every binding needs something.
    blank_image: Image,
    blank_buffer: Buffer,
}

/// An environment on the device.
pub(super) struct EnvironmentData {
    /// Radiance with its mips.
    pub(super) image: Image,
}

/// What only a reference needs.
pub(super) struct ReferenceData {
    pub(super) distribution: Buffer,
    pub(super) sums: Sums,
    /// A vec4 a pixel.
    pub(super) squared_error: Buffer,
}

#[derive(Clone, PartialEq)]
struct TargetKey {
    scene: String,
    camera: Camera,
    size: [u32; 2],
}

/// Where a view of a scene is drawn.
pub(super) struct Target {
    pub(super) gbuffer: GbufferImages,
    /// A vec4 a pixel.
    pub(super) radiance: Buffer,
    pub(super) mask: Arc<GrayImage>,
    pub(super) n_dot_v: Arc<GrayImage>,
}

/// Everything that one request shades with.
pub(super) struct Prepared {
    pub(super) environment: Arc<EnvironmentData>,
    pub(super) scene: Arc<SceneData>,
    pub(super) target: Arc<Target>,
    pub(super) prefiltered: Image,
    pub(super) lights: Option<Buffer>,
    /// Precompute passes that ran for this request.
    pub(super) precompute: Report,
    pub(super) samples_per_pixel: u32,
    /// There when the specular or the diffuse term is a reference.
    pub(super) reference: Option<ReferenceData>,
    /// The reference terms, specular first.
    pub(super) lobes: Vec<Lobe>,
    dfg: Image,
    irradiance_map: Image,
    sh9: Buffer,
    points: Points,
}

impl Prepared {
    pub(super) fn tables(&self) -> Tables<'_> {
        Tables {
            environment: &self.environment.image,
            prefiltered: &self.prefiltered,
            dfg: &self.dfg,
            irradiance_map: &self.irradiance_map,
            sh9: &self.sh9,
            points: &self.points,
        }
    }

    pub(super) fn has_specular_pass(&self, request: &RenderRequest) -> bool {
        !matches!(request.method.name, "none" | "reference")
    }

    pub(super) fn has_diffuse_pass(&self, request: &RenderRequest) -> bool {
        !matches!(request.diffuse.name, "none" | "reference")
    }
}

impl Resources {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, PipelineError> {
        Ok(Self {
            gbuffer: GbufferPass::new(gpu)?,
            shade: ShadePass::new(gpu)?,
            reference: ReferencePass::new(gpu)?,
            mips: MipsPass::new(gpu)?,
            sh9: Sh9Pass::new(gpu)?,
            irradiance: IrradiancePass::new(gpu)?,
            prefilter: HashMap::new(),
            dfg: HashMap::new(),
            environments: Recent::new(2),
            distributions: Recent::new(2),
            coefficients: Recent::new(8),
            irradiance_maps: Recent::new(4),
            prefiltered: Recent::new(6),
            dfg_tables: Recent::new(9),
            points: Recent::new(16),
            scenes: Recent::new(4),
            targets: Recent::new(4),
            blank_image: gpu.image("blank", [1, 1], 1, Format::Rgba32Float)?,
            blank_buffer: gpu.buffer("blank", 256)?,
        })
    }

    /// Forgets every precomputed table, so that the next request makes them anew.
    pub(super) fn forget_tables(&mut self) {
        self.environments = Recent::new(2);
        self.coefficients = Recent::new(8);
        self.irradiance_maps = Recent::new(4);
        self.prefiltered = Recent::new(6);
        self.dfg_tables = Recent::new(9);
    }

    /// Forgets all that can be made again; the passes stay.
    pub(super) fn forget_all(&mut self) {
        self.forget_tables();
        self.distributions = Recent::new(2);
        self.points = Recent::new(16);
        self.scenes = Recent::new(4);
        self.targets = Recent::new(4);
    }

    /// Makes what `request` needs and is not there yet.
    pub(super) fn prepare(&mut self, gpu: &Gpu, request: &RenderRequest) -> Result<Prepared, PipelineError> {
        validate(request)?;
        let mut precompute = Report::default();
        let environment = self.environment(gpu, &request.environment, &mut precompute)?;
        let samples_per_pixel = if request.method.uses_samples { request.samples } else { 1 };
        let needs_dfg = request.method.needs_dfg(request.diffuse, !request.lights.is_empty());

        let sh9 = match request.diffuse.name {
            "sh9" => self.coefficients(gpu, &request.environment.hash, &environment, &mut precompute)?,
            _ => self.blank_buffer.clone(),
        };
        let irradiance_map = match request.diffuse.uses_irradiance_map {
            true => self.irradiance_map(gpu, request, &environment, &mut precompute)?,
            false => self.blank_image.clone(),
        };
        let prefiltered = match request.method.uses_prefiltered {
            true => self.prefiltered(gpu, request, &environment, &mut precompute)?,
            false => self.blank_image.clone(),
        };
        let dfg = if needs_dfg { self.dfg_table(gpu, request, &mut precompute)? } else { self.blank_image.clone() };
        let points = self.points.get_or_make((samples_per_pixel, request.point_set), || {
            Points::upload(gpu, samples_per_pixel, request.point_set)
        })?;
        let scene = self
            .scenes
            .get_or_make(request.scene.hash.clone(), || SceneData::new(gpu, &request.scene).map(Arc::new))?;
        let target = self.target(gpu, request, &scene)?;
        let lights = light_bytes(request).map(|bytes| gpu.buffer_from("lights", &bytes)).transpose()?;

        let (brdf, masking) = (request.brdf, request.masking_shadowing);
        if !matches!(request.method.name, "none" | "reference") {
            self.shade.prepare_specular(gpu, request.method, brdf, masking)?;
        }
        if !matches!(request.diffuse.name, "none" | "reference") {
            self.shade.prepare_diffuse(gpu, request.diffuse)?;
        }
        if lights.is_some() {
            self.shade.prepare_lights(gpu, brdf, masking)?;
        }
        let lobes = reference_lobes(request);
        for lobe in &lobes {
            self.reference.prepare(gpu, *lobe)?;
        }
        let reference = if lobes.is_empty() { None } else { Some(self.reference_data(gpu, request)?) };
        Ok(Prepared {
            environment,
            scene,
            target,
            prefiltered,
            lights,
            precompute,
            samples_per_pixel,
            reference,
            lobes,
            dfg,
            irradiance_map,
            sh9,
            points,
        })
    }

    fn environment(
        &mut self,
        gpu: &Gpu,
        environment: &Environment,
        total: &mut Report,
    ) -> Result<Arc<EnvironmentData>, PipelineError> {
        let mips = &self.mips;
        self.environments.get_or_make(environment.hash.clone(), || {
            let pixels = &environment.image;
            let size = [pixels.width, pixels.height];
            let image = gpu.image("environment", size, level_count(size), Format::Rgba32Float)?;
            gpu.write_image(&image, 0, &weighted_texels(pixels))?;
            let mut recorder = gpu.record("mips")?;
            recorder.pass("mips", |r| mips.record(r, &image))?;
            total.add(recorder.submit()?);
            Ok(Arc::new(EnvironmentData { image }))
        })
    }

    fn reference_data(&mut self, gpu: &Gpu, request: &RenderRequest) -> Result<ReferenceData, PipelineError> {
        let environment = &request.environment;
        let distribution = self.distributions.get_or_make(environment.hash.clone(), || {
            gpu.buffer_from("environment distribution", EnvironmentDistribution::new(&environment.image).words())
        })?;
        let bytes = 16 * u64::from(request.size[0]) * u64::from(request.size[1]);
        let (sums, squared_error) = (Sums::new(gpu, request.size)?, gpu.buffer("squared error", bytes)?);
        Ok(ReferenceData { distribution, sums, squared_error })
    }

    fn coefficients(
        &mut self,
        gpu: &Gpu,
        hash: &str,
        environment: &EnvironmentData,
        total: &mut Report,
    ) -> Result<Buffer, PipelineError> {
        let pass = &self.sh9;
        self.coefficients.get_or_make(hash.to_string(), || {
            let coefficients = Sh9Pass::coefficients(gpu)?;
            let mut recorder = gpu.record("sh9")?;
            recorder.pass("sh9", |r| pass.record(r, &environment.image, &coefficients))?;
            total.add(recorder.submit()?);
            Ok(coefficients)
        })
    }

    fn irradiance_map(
        &mut self,
        gpu: &Gpu,
        request: &RenderRequest,
        environment: &EnvironmentData,
        total: &mut Report,
    ) -> Result<Image, PipelineError> {
        let settings = &request.precompute;
        let key = (request.environment.hash.clone(), settings.irradiance_size, settings.irradiance_sample_count);
        let (pass, sampler) = (&self.irradiance, self.shade.equirect_sampler());
        self.irradiance_maps.get_or_make(key, || {
            let map = IrradiancePass::map(gpu, settings.irradiance_size)?;
            let mut recorder = gpu.record("irradiance")?;
            recorder.pass("irradiance", |r| {
                pass.record_integrate(r, &environment.image, sampler, settings.irradiance_sample_count, &map)
            })?;
            total.add(recorder.submit()?);
            Ok(map)
        })
    }

    fn prefiltered(
        &mut self,
        gpu: &Gpu,
        request: &RenderRequest,
        environment: &EnvironmentData,
        total: &mut Report,
    ) -> Result<Image, PipelineError> {
        let settings = &request.precompute;
        let (size, level_count) = (settings.prefilter_size, settings.prefilter_level_count);
        let sample_count = settings.prefilter_sample_count;
        let name = request.brdf.name();
        if let Entry::Vacant(entry) = self.prefilter.entry(name) {
            entry.insert(PrefilterPass::new(gpu, request.brdf)?);
        }
        let points = self.points.get_or_make((sample_count, 0), || Points::upload(gpu, sample_count, 0))?;
        let (pass, sampler) = (&self.prefilter[name], self.shade.equirect_sampler());
        let key = (request.environment.hash.clone(), name, size, level_count, sample_count);
        self.prefiltered.get_or_make(key, || {
            let map = PrefilterPass::map(gpu, size, level_count)?;
            total.add(pass.run(gpu, &environment.image, sampler, &points, sample_count, &map)?);
            Ok(map)
        })
    }

    fn dfg_table(&mut self, gpu: &Gpu, request: &RenderRequest, total: &mut Report) -> Result<Image, PipelineError> {
        let settings = &request.precompute;
        let (side, sample_count) = (settings.dfg_size, settings.dfg_sample_count);
        let key = (request.brdf.name(), request.masking_shadowing);
        if let Entry::Vacant(entry) = self.dfg.entry(key) {
            entry.insert(DfgPass::new(gpu, request.brdf, request.masking_shadowing)?);
        }
        let pass = &self.dfg[&key];
        self.dfg_tables.get_or_make((key.0, key.1, side, sample_count), || {
            let table = DfgPass::table(gpu, side)?;
            total.add(pass.run(gpu, sample_count, &table)?);
            Ok(table)
        })
    }

    fn target(&mut self, gpu: &Gpu, request: &RenderRequest, scene: &SceneData) -> Result<Arc<Target>, PipelineError> {
        let (camera, size) = (request.camera, request.size);
        let key = TargetKey { scene: request.scene.hash.clone(), camera, size };
        let pass = &self.gbuffer;
        self.targets.get_or_make(key, || {
            let gbuffer = GbufferImages::new(gpu, size)?;
            let mut recorder = gpu.record("gbuffer")?;
            pass.record(&mut recorder, scene, &camera, &gbuffer)?;
            recorder.submit()?;
            let texels = gbuffer.read(gpu)?;
            let radiance = gpu.buffer("radiance", 16 * u64::from(size[0]) * u64::from(size[1]))?;
            let (mask, n_dot_v) = (Arc::new(texels.mask()), Arc::new(texels.n_dot_v(&camera)));
            Ok(Arc::new(Target { gbuffer, radiance, mask, n_dot_v }))
        })
    }
}

/// The terms that `request` takes from the reference.
fn reference_lobes(request: &RenderRequest) -> Vec<Lobe> {
    let specular = Lobe::Specular(request.brdf, request.masking_shadowing);
    let terms = [(request.method.name == "reference", specular), (request.diffuse.name == "reference", Lobe::Diffuse)];
    terms.into_iter().filter_map(|(wanted, lobe)| wanted.then_some(lobe)).collect()
}

fn validate(request: &RenderRequest) -> Result<(), PipelineError> {
    for (field, count) in [("samples", request.samples), ("reference_samples", request.reference_samples)] {
        if count == 0 {
            return Err(PipelineError::NoSamples { field });
        }
    }
    Ok(request.precompute.validate()?)
}
