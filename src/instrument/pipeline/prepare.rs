//! Prepares the inputs of shading: which tables a request reads, its scene, its targets.

use super::antialias::{Edges, points_size};
use super::inputs::{DfgInputs, IrradianceInputs, PrefilterInputs, TapTableInputs};
use super::resources::{PointKey, Prepared, ReferenceData, Resources, Target, ViewKey};
use super::shared_work::{Kept, Maker};
use super::{PipelineError, RenderRequest};
use crate::instrument::brdf::{Fresnel, UnderCoatLaw};
use crate::instrument::environment::distribution::EnvironmentDistribution;
use crate::instrument::environment::layout::MapLayout;
use crate::instrument::gbuffer::design;
use crate::instrument::gbuffer::pass::{
    self as gbuffer_pass, GBUFFER_PASS, GbufferImages, SceneData, SurfaceImages,
};
use crate::instrument::gpu::{Buffer, Gpu, GpuError, Image, Report};
use crate::instrument::precompute::points::Points;
use crate::instrument::scene::Material;
use crate::instrument::shade::layer_pass::vec4_bytes;
use crate::instrument::shade::metallic::MetallicMix;
use crate::instrument::shade::pass::Tables;
use crate::instrument::shade::reference_pass::{DistributionBuffers, Sums, pair_count};
use crate::instrument::shade::{PointTable, Shading};
use std::collections::BTreeSet;
use std::convert::Infallible;
use std::sync::{Arc, OnceLock};

impl Resources {
    /// Makes all inputs of the shading passes, or takes them from the caches.
    pub(super) fn prepare(
        &mut self,
        gpu: &Gpu,
        kept: &mut Kept,
        request: &RenderRequest,
    ) -> Result<Prepared, PipelineError> {
        validate(request)?;
        let maker = &mut Maker {
            gpu,
            kept,
            total: Report::default(),
        };
        let samples_per_pixel = if request.shading.method.uses_samples {
            request.shading.samples
        } else {
            1
        };
        let tables = self.tables_of(maker, request, samples_per_pixel)?;
        let (scene, target) = self.view(gpu, request)?;
        let tangents = self.tangents(gpu, request)?;
        let lobes = request.reference_lobes();
        let reference = if lobes.is_empty() || !request.is_under_environment() {
            None
        } else {
            Some(self.reference_data(gpu, request)?)
        };
        Ok(Prepared {
            tables,
            scene,
            target,
            tangents,
            precompute: std::mem::take(&mut maker.total),
            samples_per_pixel,
            reference,
            lobes,
        })
    }

    /// Makes the tables that a request reads. Blank ones are bound in place of the others.
    fn tables_of(
        &mut self,
        maker: &mut Maker,
        request: &RenderRequest,
        samples_per_pixel: u32,
    ) -> Result<Tables, PipelineError> {
        let gpu = maker.gpu;
        let Shading {
            method, diffuse, ..
        } = request.shading;
        let layout = request.shading.precompute.layout;
        let storage = request.shading.tables().storage;

        let environment = self.environment(maker, &request.environment)?;
        let sh9 = self.sh9(maker, request, &environment)?;
        let sh9_texture = self.texture_of(maker, request, &sh9)?;
        let filtered = if request.reads_filtered_levels() {
            self.filtered(maker, &request.environment, layout, &environment)?
        } else {
            self.blank(layout)
        };
        let irradiance_map = if diffuse.uses_irradiance_map {
            let inputs = IrradianceInputs::from_request(request);
            self.irradiance_map(maker, inputs, storage, &filtered)?
        } else {
            self.blank(layout)
        };
        let prefiltered = if method.uses_prefiltered() {
            let inputs = PrefilterInputs::from_request(request);
            self.prefiltered(maker, inputs, storage, &filtered)?
        } else {
            self.blank(layout)
        };
        let dfg = if request.needs_dfg() {
            self.dfg_table(maker, DfgInputs::from_request(request), storage)?
        } else {
            self.blank_image.clone()
        };
        let tap_table = match method.tap_table {
            Some(count) => {
                let inputs = TapTableInputs::from_request(request, count);
                self.tap_table(maker, inputs, storage)?
            }
            None => self.blank_image.clone(),
        };
        let points = self.points(gpu, samples_per_pixel, request.shading.point_table())?;
        let shifts = self.shifts(gpu, request)?;
        Ok(Tables {
            environment,
            filtered,
            prefiltered,
            dfg,
            tap_table,
            irradiance_map,
            sh9,
            sh9_texture,
            points,
            shifts,
        })
    }

    fn sh9(
        &mut self,
        maker: &mut Maker,
        request: &RenderRequest,
        environment: &Image,
    ) -> Result<Buffer, PipelineError> {
        match request.shading.diffuse.sh9 {
            Some(projection) => {
                self.coefficients(maker, &request.environment, projection, environment)
            }
            None => Ok(self.blank_buffer.clone()),
        }
    }

    /// Returns the irradiance texture of coefficients; blank if the diffuse method does not read it.
    fn texture_of(
        &mut self,
        maker: &mut Maker,
        request: &RenderRequest,
        sh9: &Buffer,
    ) -> Result<Image, PipelineError> {
        let diffuse = request.shading.diffuse;
        match diffuse.sh9 {
            Some(projection) if diffuse.uses_sh9_texture => {
                self.sh9_texture(maker, &request.environment, projection, sh9)
            }
            _ => Ok(self.blank_image.clone()),
        }
    }

    /// Returns the shift of each pixel's points; blank if all pixels share their points.
    fn shifts(&self, gpu: &Gpu, request: &RenderRequest) -> Result<Buffer, GpuError> {
        match request.point_shifts() {
            Some(shifts) => gpu.buffer_from("shifts", &shifts),
            None => Ok(self.blank_buffer.clone()),
        }
    }

    fn blank(&self, layout: &MapLayout) -> Image {
        if layout.face_count == 6 {
            self.blank_cube.clone()
        } else {
            self.blank_image.clone()
        }
    }

    pub(super) fn points(
        &mut self,
        gpu: &Gpu,
        count: u32,
        table: PointTable,
    ) -> Result<Points, PipelineError> {
        let PointTable {
            sequence,
            set,
            pixel_points,
        } = table;
        let key = PointKey {
            count,
            sequence: sequence.name,
            set,
            pixel_points,
        };
        let make = || Points::upload(gpu, count, sequence, set, pixel_points);
        Ok(self.points.get_or_make(key, make)?)
    }

    fn reference_data(
        &mut self,
        gpu: &Gpu,
        request: &RenderRequest,
    ) -> Result<ReferenceData, PipelineError> {
        let environment = &request.environment;
        let distribution = self
            .distributions
            .get_or_make(environment.hash.clone(), || {
                DistributionBuffers::new(gpu, &EnvironmentDistribution::new(&environment.image))
            })?;
        Ok(ReferenceData {
            distribution,
            sums: Sums::new(gpu, request.size)?,
            squared_error: gpu.buffer("squared error", vec4_bytes(request.size))?,
        })
    }

    /// Returns the scene on the device and its g-buffer.
    pub(super) fn view(
        &mut self,
        gpu: &Gpu,
        request: &RenderRequest,
    ) -> Result<(Arc<SceneData>, Arc<Target>), PipelineError> {
        let scene = self.scenes.get_or_make(request.scene.hash.clone(), || {
            SceneData::new(gpu, &request.scene).map(Arc::new)
        })?;
        let target = self
            .targets
            .get_or_make(ViewKey::new(request), || target(gpu, request, &scene))?;
        Ok((scene, target))
    }

    /// Returns the targets whose normals and alphas are tangents and strengths, if lobes of the
    /// scene have two widths.
    fn tangents(
        &mut self,
        gpu: &Gpu,
        request: &RenderRequest,
    ) -> Result<Option<Arc<Target>>, PipelineError> {
        if !request.scene.has_anisotropy() {
            return Ok(None);
        }
        let Ok(scene) = self.tangents.get_or_make(request.scene.hash.clone(), || {
            Ok::<_, Infallible>(Arc::new(request.scene.tangents()))
        });
        let tangents = RenderRequest {
            scene,
            ..request.clone()
        };
        let (_, target) = self.view(gpu, &tangents)?;
        Ok(Some(target))
    }

    /// Returns the edges of the view of `request`.
    pub(super) fn edges(
        &mut self,
        gpu: &Gpu,
        request: &RenderRequest,
    ) -> Result<Arc<Edges>, PipelineError> {
        let key = ViewKey::new(request);
        if let Some(edges) = self.edges.get(&key) {
            return Ok(edges);
        }
        let (scene, target) = self.view(gpu, request)?;
        // The points take eight times the memory of the view, so they are not kept.
        let points = SurfaceImages::new(gpu, points_size(request.size))?;
        let mut recorder = gpu.record("points of edges")?;
        gbuffer_pass::record(&mut recorder, &scene, &request.camera, points.all())?;
        recorder.submit()?;
        let pixels = target.gbuffer.read_surfaces(gpu)?;
        let read = |rows| points.read_surface_rows(gpu, rows);
        let edges = Arc::new(Edges::find(&pixels, &request.camera, read)?);
        self.edges.get_or_make(key, || Ok(edges))
    }
}

/// Makes the targets of a view and draws its g-buffer.
fn target(gpu: &Gpu, request: &RenderRequest, scene: &SceneData) -> Result<Arc<Target>, GpuError> {
    let gbuffer = GbufferImages::new(gpu, request.size)?;
    let shaders = if request.scene.is_design {
        gbuffer.write(gpu, &design::gbuffer(&request.scene, request.size))?;
        BTreeSet::new()
    } else {
        draw_gbuffer(gpu, request, scene, &gbuffer)?.shaders
    };
    Ok(Arc::new(Target {
        gbuffer,
        shaders,
        radiance: gpu.buffer("radiance", vec4_bytes(request.size))?,
        camera: request.camera,
        coverage: OnceLock::new(),
    }))
}

/// Draws the g-buffer of a view, or draws it again with the same values, to time it.
pub(super) fn draw_gbuffer(
    gpu: &Gpu,
    request: &RenderRequest,
    scene: &SceneData,
    images: &GbufferImages,
) -> Result<Report, GpuError> {
    let mut recorder = gpu.record(GBUFFER_PASS)?;
    recorder.pass(GBUFFER_PASS, |recorder| {
        gbuffer_pass::record(recorder, scene, &request.camera, images.all())
    })?;
    recorder.submit()
}

fn validate(request: &RenderRequest) -> Result<(), PipelineError> {
    let shading = &request.shading;
    let counts = [
        ("samples", shading.samples),
        ("reference_samples", request.reference_samples),
    ];
    if let Some((field, _)) = counts.into_iter().find(|(_, count)| *count == 0) {
        return Err(PipelineError::NoSamples { field });
    }
    if request.has_reference_term() && request.is_under_environment() {
        pair_count(request.reference_samples)?;
    }
    if request.scene.has_anisotropy()
        && let Some(fault) = shading
            .widths
            .fault(shading.brdf, shading.masking_shadowing)
    {
        return Err(PipelineError::Widths(fault));
    }
    if shading.fresnel == Fresnel::Exact {
        let dielectric = request.scene.dielectric_f0();
        dielectric.map_err(PipelineError::Fresnel)?;
    }
    if shading.metallic_mix == MetallicMix::Brdf
        && let Some(what) = mixture_fault(request)
    {
        return Err(PipelineError::MetallicMix(what));
    }
    Ok(shading.tables().validate()?)
}

/// Why the specular terms of a dielectric and a metal, mixed, differ from one of mixed F0.
fn mixture_fault(request: &RenderRequest) -> Option<&'static str> {
    let lowers_f0 = |material: &Material| {
        let law = material.under_coat.map(|under| under.law.f0);
        law.is_some_and(|f0| f0 != UnderCoatLaw::UNCHANGED.f0)
    };
    if let Some(fault) = request
        .shading
        .metallic_mix
        .fault(request.shading.compensation)
    {
        Some(fault)
    } else if request.scene.materials.iter().any(lowers_f0) {
        Some("a coat whose renderer changes F0 of the base")
    } else if request.scene.has_specular_weight() {
        Some("specular weights (KHR_materials_specular)")
    } else {
        None
    }
}
