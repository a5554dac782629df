//! What a request needs before it can be shaded: tables, scene, targets, pipelines.
//!
//! Long because each resource is prepared in the order in which the next one needs it.

use super::cache::Recent;
use super::inputs::{DfgInputs, Inputs, IrradianceInputs, MipsInputs, PrefilterInputs, Sh9Inputs};
use super::shared_work::{Kept, Levels, Maker, submit_pass};
use super::{PipelineError, RenderRequest, light_bytes};
use crate::brdf::MaskingShadowing;
use crate::environment::{
    Environment,
    distribution::{EnvironmentDistribution, weighted_texels},
};
use crate::gbuffer::pass::{GbufferImages, GbufferPass, SceneData};
use crate::gpu::{Buffer, Format, Gpu, GpuError, Image, Report};
use crate::math::sequence::SEQUENCES;
use crate::pixels::GrayImage;
use crate::precompute::dfg::pass::DfgPass;
use crate::precompute::irradiance::pass::IrradiancePass;
use crate::precompute::mips::{level_count, pass::MipsPass};
use crate::precompute::points::Points;
use crate::precompute::prefilter::pass::PrefilterPass;
use crate::precompute::sh9::pass::Sh9Pass;
use crate::precompute::{HALF_MAX, StorageFormat};
use crate::scene::Camera;
use crate::shade::pass::{ShadePass, Tables};
use crate::shade::reference_pass::{DistributionBuffers, Lobe, ReferencePass, ScramblePlan, Sums};
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
    /// Radiance with its mips.
    environments: Recent<String, Levels>,
    distributions: Recent<String, DistributionBuffers>,
    coefficients: Recent<String, Buffer>,
    irradiance_maps: Recent<String, Levels>,
    prefiltered: Recent<String, Levels>,
    dfg_tables: Recent<String, Levels>,
    /// Copies of tables in the format that a request asks for.
    halves: Recent<String, Image>,
    points: Recent<(u32, &'static str, u32), Points>,
    scenes: Recent<String, Arc<SceneData>>,
    targets: Recent<TargetKey, Arc<Target>>,
    /// Stand for tables that a request does not use, because every binding needs something.
    blank_image: Image,
    blank_buffer: Buffer,
}

/// What only a reference needs.
pub(super) struct ReferenceData {
    pub(super) distribution: DistributionBuffers,
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
    pub(super) environment: Image,
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
            environment: &self.environment,
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
            halves: Recent::new(9),
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
        self.halves = Recent::new(9);
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
    pub(super) fn prepare(
        &mut self,
        gpu: &Gpu,
        kept: &mut Kept,
        request: &RenderRequest,
    ) -> Result<Prepared, PipelineError> {
        validate(request)?;
        let maker = &mut Maker { gpu, kept, total: Report::default() };
        let environment = self.environment(maker, &request.environment)?;
        let samples_per_pixel = if request.method.uses_samples { request.samples } else { 1 };
        let storage = request.precompute.storage;
        let needs_dfg = request.method.needs_dfg(request.diffuse, !request.lights.is_empty());

        let sh9 = match request.diffuse.name {
            "sh9" => self.coefficients(maker, &Sh9Inputs { environment: &request.environment }, &environment)?,
            _ => self.blank_buffer.clone(),
        };
        let irradiance_map = match request.diffuse.uses_irradiance_map {
            true => self.irradiance_map(maker, &IrradianceInputs::of(request), storage, &environment)?,
            false => self.blank_image.clone(),
        };
        let prefiltered = match request.method.uses_prefiltered {
            true => self.prefiltered(maker, &PrefilterInputs::of(request), storage, &environment)?,
            false => self.blank_image.clone(),
        };
        let dfg = match needs_dfg {
            true => self.dfg_table(maker, &DfgInputs::of(request), storage)?,
            false => self.blank_image.clone(),
        };
        let (sequence, set) = (request.sequence, request.point_set);
        let points = self.points.get_or_make((samples_per_pixel, sequence.name, set), || {
            Points::upload(gpu, samples_per_pixel, sequence, set)
        })?;
        let (scene, target) = self.view(gpu, request)?;
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
        let lobes = request.reference_lobes();
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
            precompute: std::mem::take(&mut maker.total),
            samples_per_pixel,
            reference,
            lobes,
            dfg,
            irradiance_map,
            sh9,
            points,
        })
    }

    fn environment(&mut self, maker: &mut Maker, environment: &Environment) -> Result<Image, PipelineError> {
        let (mips, gpu, inputs) = (&self.mips, maker.gpu, MipsInputs { environment });
        let pixels = &inputs.environment.image;
        let size = [pixels.width, pixels.height];
        let empty = || {
            let image = gpu.image("environment", size, level_count(size), Format::Rgba32Float)?;
            gpu.write_image(&image, 0, &weighted_texels(pixels))?;
            Ok(Levels { image, first: 1 })
        };
        let made = maker.table(&mut self.environments, &inputs, empty, |levels| {
            submit_pass(gpu, "mips", |r| mips.record(r, &levels.image))
        })?;
        Ok(made.image)
    }

    fn reference_data(&mut self, gpu: &Gpu, request: &RenderRequest) -> Result<ReferenceData, PipelineError> {
        let environment = &request.environment;
        let distribution = self.distributions.get_or_make(environment.hash.clone(), || {
            DistributionBuffers::new(gpu, &EnvironmentDistribution::new(&environment.image))
        })?;
        let bytes = 16 * u64::from(request.size[0]) * u64::from(request.size[1]);
        let (sums, squared_error) = (Sums::new(gpu, request.size)?, gpu.buffer("squared error", bytes)?);
        Ok(ReferenceData { distribution, sums, squared_error })
    }

    fn coefficients(
        &mut self,
        maker: &mut Maker,
        inputs: &Sh9Inputs,
        environment: &Image,
    ) -> Result<Buffer, PipelineError> {
        let (pass, gpu) = (&self.sh9, maker.gpu);
        maker.table(
            &mut self.coefficients,
            inputs,
            || Sh9Pass::coefficients(gpu),
            |coefficients| submit_pass(gpu, "sh9", |r| pass.record(r, environment, coefficients)),
        )
    }

    fn irradiance_map(
        &mut self,
        maker: &mut Maker,
        inputs: &IrradianceInputs,
        storage: StorageFormat,
        environment: &Image,
    ) -> Result<Image, PipelineError> {
        let IrradianceInputs { size, sample_count, .. } = *inputs;
        let (pass, sampler, gpu) = (&self.irradiance, self.shade.equirect_sampler(), maker.gpu);
        let empty = || IrradiancePass::map(gpu, size).map(Levels::all);
        let made = maker.table(&mut self.irradiance_maps, inputs, empty, |map| {
            submit_pass(gpu, "irradiance", |r| pass.record_integrate(r, environment, sampler, sample_count, &map.image))
        })?;
        self.stored(gpu, inputs, made.image, storage)
    }

    fn prefiltered(
        &mut self,
        maker: &mut Maker,
        inputs: &PrefilterInputs,
        storage: StorageFormat,
        environment: &Image,
    ) -> Result<Image, PipelineError> {
        let PrefilterInputs { brdf, size, level_count, sample_count, .. } = *inputs;
        let (name, gpu) = (brdf.name(), maker.gpu);
        if let Entry::Vacant(entry) = self.prefilter.entry(name) {
            entry.insert(PrefilterPass::new(gpu, brdf)?);
        }
        let sequence = &SEQUENCES[0];
        let points = self
            .points
            .get_or_make((sample_count, sequence.name, 0), || Points::upload(gpu, sample_count, sequence, 0))?;
        let (pass, sampler) = (&self.prefilter[name], self.shade.equirect_sampler());
        let empty = || PrefilterPass::map(gpu, size, level_count).map(Levels::all);
        let made = maker.table(&mut self.prefiltered, inputs, empty, |map| {
            pass.run(gpu, environment, sampler, &points, sample_count, &map.image)
        })?;
        self.stored(gpu, inputs, made.image, storage)
    }

    fn dfg_table(
        &mut self,
        maker: &mut Maker,
        inputs: &DfgInputs,
        storage: StorageFormat,
    ) -> Result<Image, PipelineError> {
        let DfgInputs { brdf, masking, side, sample_count } = *inputs;
        let (name, gpu) = (brdf.name(), maker.gpu);
        if let Entry::Vacant(entry) = self.dfg.entry((name, masking)) {
            entry.insert(DfgPass::new(gpu, brdf, masking)?);
        }
        let pass = &self.dfg[&(name, masking)];
        let empty = || DfgPass::table(gpu, side).map(Levels::all);
        let made =
            maker.table(&mut self.dfg_tables, inputs, empty, |table| pass.run(gpu, sample_count, &table.image))?;
        self.stored(gpu, inputs, made.image, storage)
    }

    /// The table as `storage` holds it.
    fn stored<I: Inputs>(
        &mut self,
        gpu: &Gpu,
        inputs: &I,
        table: Image,
        storage: StorageFormat,
    ) -> Result<Image, PipelineError> {
        match storage {
            StorageFormat::F32 => Ok(table),
            StorageFormat::F16 => {
                let key = format!("{} {}", I::KIND, inputs.key());
                Ok(self.halves.get_or_make(key, || half_copy(gpu, I::KIND, &table))?)
            }
        }
    }

    /// The scene on the device and what its camera sees of it.
    pub(super) fn view(
        &mut self,
        gpu: &Gpu,
        request: &RenderRequest,
    ) -> Result<(Arc<SceneData>, Arc<Target>), PipelineError> {
        let scene = self
            .scenes
            .get_or_make(request.scene.hash.clone(), || SceneData::new(gpu, &request.scene).map(Arc::new))?;
        let key = TargetKey { scene: request.scene.hash.clone(), camera: request.camera, size: request.size };
        let target = self.target(gpu, key, &scene)?;
        Ok((scene, target))
    }

    /// The target of a key, which names the scene, too.
    fn target(&mut self, gpu: &Gpu, key: TargetKey, scene: &SceneData) -> Result<Arc<Target>, PipelineError> {
        let TargetKey { camera, size, .. } = key;
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

/// The same texels in halves, each at most [`HALF_MAX`].
fn half_copy(gpu: &Gpu, name: &str, table: &Image) -> Result<Image, GpuError> {
    let copy = gpu.image(&format!("{name} in halves"), table.mip_size(0), table.mip_count(), Format::Rgba16Float)?;
    for mip in 0..table.mip_count() {
        let texels = gpu.read_image(table, mip)?;
        let bounded: Vec<[f32; 4]> = texels.iter().map(|texel| texel.map(|x| x.min(HALF_MAX))).collect();
        gpu.write_image(&copy, mip, &bounded)?;
    }
    Ok(copy)
}

fn validate(request: &RenderRequest) -> Result<(), PipelineError> {
    for (field, count) in [("samples", request.samples), ("reference_samples", request.reference_samples)] {
        if count == 0 {
            return Err(PipelineError::NoSamples { field });
        }
    }
    if request.has_reference_term() {
        ScramblePlan::exact(request.reference_samples)?;
    }
    Ok(request.precompute.validate()?)
}
