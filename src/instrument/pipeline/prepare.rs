//! Prepares the inputs of shading: tables, scene, targets.

use super::antialias::Edges;
use super::inputs::{
    DfgInputs, IrradianceInputs, PrefilterInputs, SharedKey, TapTableInputs, filtered_key,
    mips_key, sh9_key,
};
use super::resources::{Prepared, ReferenceData, Resources, Target, harmonics};
use super::shared_work::{Kept, Levels, Maker};
use super::{PipelineError, RenderRequest};
use crate::base::math::sequence::{PixelPoints, SEQUENCES, Sequence};
use crate::instrument::environment::Environment;
use crate::instrument::environment::distribution::{EnvironmentDistribution, weighted_texels};
use crate::instrument::environment::layout::MapLayout;
use crate::instrument::gbuffer::design;
use crate::instrument::gbuffer::pass::{self as gbuffer_pass, GbufferImages, SceneData};
use crate::instrument::gpu::{Buffer, Format, Gpu, GpuError, Image, Report};
use crate::instrument::precompute::mips::level_count;
use crate::instrument::precompute::points::Points;
use crate::instrument::precompute::prefilter::harmonic;
use crate::instrument::precompute::{
    HALF_MAX, PrefilterBy, StorageFormat, dfg, filtered, irradiance, mips, prefilter, sh9,
};
use crate::instrument::shade::Shading;
use crate::instrument::shade::pass::Tables;
use crate::instrument::shade::reference_pass::{DistributionBuffers, Sums, pair_count};
use std::sync::Arc;

impl Resources {
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
        let environment = self.environment(maker, &request.environment)?;
        let samples_per_pixel = if request.shading.method.uses_samples {
            request.shading.samples
        } else {
            1
        };
        let storage = request.shading.tables().storage;

        let sh9 = match request.shading.diffuse.uses_sh9 {
            true => self.coefficients(maker, &request.environment, &environment)?,
            false => self.blank_buffer.clone(),
        };
        let layout = request.shading.precompute.layout;
        let filtered = match request.reads_filtered_levels() {
            true => self.filtered(maker, &request.environment, layout, &environment)?,
            false => self.blank(layout),
        };
        let irradiance_map = match request.shading.diffuse.uses_irradiance_map {
            true => {
                self.irradiance_map(maker, IrradianceInputs::of(request), storage, &filtered)?
            }
            false => self.blank(layout),
        };
        let prefiltered = match request.shading.method.uses_prefiltered() {
            true => self.prefiltered(maker, PrefilterInputs::of(request), storage, &filtered)?,
            false => self.blank(layout),
        };
        let dfg = match request.needs_dfg() {
            true => self.dfg_table(maker, DfgInputs::of(request), storage)?,
            false => self.blank_image.clone(),
        };
        let tap_table = match request.shading.method.tap_table {
            Some(count) => self.tap_table(maker, TapTableInputs::of(request, count), storage)?,
            None => self.blank_image.clone(),
        };
        let (sequence, set, of_pixel) = request.shading.point_table();
        let points = self.points(gpu, samples_per_pixel, sequence, set, of_pixel)?;
        let shifts = request
            .point_shifts()
            .map(|shifts| gpu.buffer_from("shifts", &shifts))
            .transpose()?;
        let shifts = shifts.unwrap_or_else(|| self.blank_buffer.clone());
        let (scene, target) = self.view(gpu, request)?;
        let tangents = match request.scene.has_anisotropy() {
            true => {
                let make = || Ok::<_, PipelineError>(Arc::new(request.scene.tangents()));
                let scene = self
                    .tangents
                    .get_or_make(request.scene.hash.clone(), make)?;
                let shown = RenderRequest {
                    scene,
                    ..request.clone()
                };
                Some(self.view(gpu, &shown)?.1)
            }
            false => None,
        };
        let lobes = request.reference_lobes();
        let reference = if lobes.is_empty() {
            None
        } else {
            Some(self.reference_data(gpu, request)?)
        };
        Ok(Prepared {
            tables: Tables {
                environment,
                filtered,
                prefiltered,
                dfg,
                tap_table,
                irradiance_map,
                sh9,
                points,
                shifts,
            },
            scene,
            target,
            tangents,
            precompute: std::mem::take(&mut maker.total),
            samples_per_pixel,
            reference,
            lobes,
        })
    }

    fn environment(
        &mut self,
        maker: &mut Maker,
        environment: &Environment,
    ) -> Result<Image, PipelineError> {
        let (gpu, pixels) = (maker.gpu, &environment.image);
        let size = [pixels.width, pixels.height];
        let empty = || {
            let image = gpu.image("environment", size, level_count(size), Format::Rgba32Float)?;
            gpu.write_image(&image, 0, &weighted_texels(pixels))?;
            Ok(Levels { image, first: 1 })
        };
        let fill = |levels: &Levels| mips::pass::run(gpu, &levels.image);
        Ok(maker
            .table(
                &mut self.tables.environments,
                &mips_key(environment),
                empty,
                fill,
            )?
            .image)
    }

    /// Returns the environment's levels in a layout.
    fn filtered(
        &mut self,
        maker: &mut Maker,
        environment: &Environment,
        layout: &MapLayout,
        image: &Image,
    ) -> Result<Image, PipelineError> {
        if layout.is_environments() {
            return Ok(image.clone());
        }
        let gpu = maker.gpu;
        let empty = || filtered::pass::map(gpu, layout, image.mip_size(0)).map(Levels::all);
        let fill = |map: &Levels| filtered::pass::run(gpu, layout, image, &map.image);
        Ok(maker
            .table(
                &mut self.tables.filtered,
                &filtered_key(environment, layout),
                empty,
                fill,
            )?
            .image)
    }

    fn blank(&self, layout: &MapLayout) -> Image {
        if layout.face_count == 6 {
            self.blank_cube.clone()
        } else {
            self.blank_image.clone()
        }
    }

    fn points(
        &mut self,
        gpu: &Gpu,
        count: u32,
        sequence: &'static Sequence,
        set: u32,
        of_pixel: PixelPoints,
    ) -> Result<Points, PipelineError> {
        let make = || Points::upload(gpu, count, sequence, set, of_pixel);
        Ok(self
            .points
            .get_or_make((count, sequence.name, set, of_pixel), make)?)
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
        let bytes = 16 * u64::from(request.size[0]) * u64::from(request.size[1]);
        let (sums, squared_error) = (
            Sums::new(gpu, request.size)?,
            gpu.buffer("squared error", bytes)?,
        );
        Ok(ReferenceData {
            distribution,
            sums,
            squared_error,
        })
    }

    fn coefficients(
        &mut self,
        maker: &mut Maker,
        environment: &Environment,
        image: &Image,
    ) -> Result<Buffer, PipelineError> {
        let gpu = maker.gpu;
        let fill = |coefficients: &Buffer| sh9::pass::run(gpu, image, coefficients);
        maker.table(
            &mut self.tables.coefficients,
            &sh9_key(environment),
            || sh9::pass::coefficients(gpu),
            fill,
        )
    }

    fn irradiance_map(
        &mut self,
        maker: &mut Maker,
        inputs: IrradianceInputs,
        storage: StorageFormat,
        environment: &Image,
    ) -> Result<Image, PipelineError> {
        let (gpu, key) = (maker.gpu, inputs.key());
        let empty = || irradiance::pass::map(gpu, inputs.layout, inputs.size).map(Levels::all);
        let transforms = &mut self.tables.harmonics;
        let made = maker.table(
            &mut self.tables.irradiance_maps,
            &key,
            empty,
            |map| match inputs.by {
                PrefilterBy::Sampled => irradiance::pass::run(
                    gpu,
                    inputs.layout,
                    environment,
                    inputs.sample_count,
                    &map.image,
                ),
                PrefilterBy::Harmonic => {
                    let harmonics =
                        harmonics(transforms, inputs.environment, harmonic::degree(1.0))?;
                    irradiance::pass::run_harmonic(gpu, inputs.layout, &harmonics, &map.image)
                }
            },
        )?;
        self.stored(gpu, &key, made.image, storage)
    }

    fn prefiltered(
        &mut self,
        maker: &mut Maker,
        inputs: PrefilterInputs,
        storage: StorageFormat,
        environment: &Image,
    ) -> Result<Image, PipelineError> {
        let (gpu, key) = (maker.gpu, inputs.key());
        let is_harmonic = inputs.by == PrefilterBy::Harmonic;
        let sample_count = if is_harmonic { 1 } else { inputs.sample_count };
        let points = self.points(gpu, sample_count, &SEQUENCES[0], 0, PixelPoints::Shared)?;
        let transforms = &mut self.tables.harmonics;
        let empty = || {
            prefilter::pass::map(gpu, inputs.layout, inputs.size, inputs.level_count)
                .map(Levels::all)
        };
        let made = maker.table(&mut self.tables.prefiltered, &key, empty, |map| {
            let (recipe, layout) = (inputs.recipe, inputs.layout);
            if let Some(given) = inputs.given {
                for (level, texels) in (0..).zip(&given.levels) {
                    gpu.write_image(&map.image, level, texels)?;
                }
                return Ok(Report::default());
            }
            if !is_harmonic {
                return prefilter::pass::run(gpu, recipe, layout, environment, &points, &map.image);
            }
            let degree =
                harmonic::degree_of_map(recipe.mapping.alpha_from_mip(1.0, inputs.level_count));
            let harmonics = harmonics(transforms, inputs.environment, degree)?;
            prefilter::pass::run_harmonic(
                gpu,
                recipe,
                layout,
                environment,
                (&points, &harmonics),
                &map.image,
            )
        })?;
        self.stored(gpu, &key, made.image, storage)
    }

    fn dfg_table(
        &mut self,
        maker: &mut Maker,
        inputs: DfgInputs,
        storage: StorageFormat,
    ) -> Result<Image, PipelineError> {
        let (gpu, key) = (maker.gpu, inputs.key());
        let empty = || dfg::pass::table(gpu, inputs.side).map(Levels::all);
        let made = maker.table(&mut self.tables.dfg_tables, &key, empty, |table| {
            if let Some(given) = inputs.given {
                gpu.write_image(&table.image, 0, &given.texels)?;
                return Ok(Report::default());
            }
            dfg::pass::run(
                gpu,
                inputs.brdf,
                inputs.masking,
                inputs.axes,
                inputs.sample_count,
                &table.image,
            )
        })?;
        self.stored(gpu, &key, made.image, storage)
    }

    fn tap_table(
        &mut self,
        maker: &mut Maker,
        inputs: TapTableInputs,
        storage: StorageFormat,
    ) -> Result<Image, PipelineError> {
        let (gpu, key) = (maker.gpu, inputs.key());
        let empty = || {
            gpu.image("tap table", inputs.size(), 1, Format::Rgba32Float)
                .map(Levels::all)
        };
        let made = maker.table(&mut self.tables.tap_tables, &key, empty, |table| {
            gpu.write_image(&table.image, 0, &inputs.texels().data)?;
            Ok(Report::default())
        })?;
        self.stored(gpu, &key, made.image, storage)
    }

    /// Returns the table in the format `storage`.
    fn stored(
        &mut self,
        gpu: &Gpu,
        key: &SharedKey,
        table: Image,
        storage: StorageFormat,
    ) -> Result<Image, PipelineError> {
        match storage {
            StorageFormat::F32 => Ok(table),
            StorageFormat::F16 => Ok(self
                .tables
                .halves
                .get_or_make(key.text(), || half_copy(gpu, key.kind, &table))?),
        }
    }

    /// Returns the scene on the device and its g-buffer.
    pub(super) fn view(
        &mut self,
        gpu: &Gpu,
        request: &RenderRequest,
    ) -> Result<(Arc<SceneData>, Arc<Target>), PipelineError> {
        let (hash, camera, size) = (&request.scene.hash, request.camera, request.size);
        let scene = self.scenes.get_or_make(hash.clone(), || {
            SceneData::new(gpu, &request.scene).map(Arc::new)
        })?;
        let target =
            self.targets
                .get_or_make((hash.clone(), camera, size), || -> Result<_, GpuError> {
                    let gbuffer = GbufferImages::new(gpu, size)?;
                    let texels = match request.scene.is_design {
                        true => {
                            let texels = design::gbuffer(&request.scene, size);
                            gbuffer.write(gpu, &texels)?;
                            texels
                        }
                        false => {
                            let mut recorder = gpu.record("gbuffer")?;
                            gbuffer_pass::record(&mut recorder, &scene, &camera, &gbuffer)?;
                            recorder.submit()?;
                            gbuffer.read(gpu)?
                        }
                    };
                    let radiance =
                        gpu.buffer("radiance", 16 * u64::from(size[0]) * u64::from(size[1]))?;
                    let (mask, n_dot_v) =
                        (Arc::new(texels.mask()), Arc::new(texels.n_dot_v(&camera)));
                    Ok(Arc::new(Target {
                        gbuffer,
                        radiance,
                        mask,
                        n_dot_v,
                    }))
                })?;
        Ok((scene, target))
    }

    /// Returns the edges of the view of `request`.
    pub(super) fn edges(
        &mut self,
        gpu: &Gpu,
        request: &RenderRequest,
    ) -> Result<Arc<Edges>, PipelineError> {
        let key = (request.scene.hash.clone(), request.camera, request.size);
        if let Some(edges) = self.edges.get(&key) {
            return Ok(edges);
        }
        let (_, target) = self.view(gpu, request)?;
        let (_, points) = self.view(gpu, &request.points_of_pixels())?;
        let edges = Arc::new(Edges::find(
            &target.gbuffer.read(gpu)?,
            &points.gbuffer.read(gpu)?,
            &request.camera,
        ));
        self.edges.get_or_make(key, || Ok(edges))
    }
}

/// Copies the texels to half precision, each at most [`HALF_MAX`].
fn half_copy(gpu: &Gpu, name: &str, table: &Image) -> Result<Image, GpuError> {
    let (label, size) = (format!("{name} in halves"), table.mip_size(0));
    let copy = gpu.faced_image(
        &label,
        size,
        table.face_count(),
        table.mip_count(),
        Format::Rgba16Float,
    )?;
    for mip in 0..table.mip_count() {
        let texels = gpu.read_image(table, mip)?;
        let bounded: Vec<[f32; 4]> = texels
            .iter()
            .map(|texel| texel.map(|x| x.min(HALF_MAX)))
            .collect();
        gpu.write_image(&copy, mip, &bounded)?;
    }
    Ok(copy)
}

fn validate(request: &RenderRequest) -> Result<(), PipelineError> {
    for (field, count) in [
        ("samples", request.shading.samples),
        ("reference_samples", request.reference_samples),
    ] {
        if count == 0 {
            return Err(PipelineError::NoSamples { field });
        }
    }
    if request.has_reference_term() {
        pair_count(request.reference_samples)?;
    }
    let Shading {
        widths,
        brdf,
        masking_shadowing,
        ..
    } = request.shading;
    let fault = request
        .scene
        .has_anisotropy()
        .then(|| widths.fault(brdf, masking_shadowing))
        .flatten();
    fault.map_or(Ok(()), |what| Err(PipelineError::Widths(what)))?;
    Ok(request.shading.tables().validate()?)
}
