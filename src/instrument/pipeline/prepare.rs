//! Prepares the inputs of shading: tables, scene, targets.
//!
//! Long because each table of a request is prepared by the same few steps.

use super::antialias::Edges;
use super::inputs::{
    DfgInputs, IrradianceInputs, PrefilterInputs, SharedKey, TapTableInputs, filtered_key,
    mips_key, sh9_key,
};
use super::resources::{PointKey, Prepared, ReferenceData, Resources, Target, ViewKey, harmonics};
use super::shared_work::{Kept, Levels, Maker};
use super::{PipelineError, RenderRequest};
use crate::base::math::sequence::{PixelPoints, SEQUENCES};
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
use crate::instrument::shade::pass::Tables;
use crate::instrument::shade::reference_pass::{DistributionBuffers, Sums, pair_count};
use crate::instrument::shade::{PointTable, Shading};
use std::convert::Infallible;
use std::sync::Arc;

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
        let reference = if lobes.is_empty() {
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
        let sh9 = if diffuse.uses_sh9 {
            self.coefficients(maker, &request.environment, &environment)?
        } else {
            self.blank_buffer.clone()
        };
        let filtered = if request.reads_filtered_levels() {
            self.filtered(maker, &request.environment, layout, &environment)?
        } else {
            self.blank(layout)
        };
        let irradiance_map = if diffuse.uses_irradiance_map {
            self.irradiance_map(maker, IrradianceInputs::of(request), storage, &filtered)?
        } else {
            self.blank(layout)
        };
        let prefiltered = if method.uses_prefiltered() {
            self.prefiltered(maker, PrefilterInputs::of(request), storage, &filtered)?
        } else {
            self.blank(layout)
        };
        let dfg = if request.needs_dfg() {
            self.dfg_table(maker, DfgInputs::of(request), storage)?
        } else {
            self.blank_image.clone()
        };
        let tap_table = match method.tap_table {
            Some(count) => self.tap_table(maker, TapTableInputs::of(request, count), storage)?,
            None => self.blank_image.clone(),
        };
        let points = self.points(gpu, samples_per_pixel, request.shading.point_table())?;
        let shifts = match request.point_shifts() {
            Some(shifts) => gpu.buffer_from("shifts", &shifts)?,
            None => self.blank_buffer.clone(),
        };
        Ok(Tables {
            environment,
            filtered,
            prefiltered,
            dfg,
            tap_table,
            irradiance_map,
            sh9,
            points,
            shifts,
        })
    }

    fn environment(
        &mut self,
        maker: &mut Maker,
        environment: &Environment,
    ) -> Result<Image, PipelineError> {
        let gpu = maker.gpu;
        let pixels = &environment.image;
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
        let gpu = maker.gpu;
        let key = inputs.key();
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
        let gpu = maker.gpu;
        let key = inputs.key();
        let is_harmonic = inputs.by == PrefilterBy::Harmonic;
        let sample_count = if is_harmonic { 1 } else { inputs.sample_count };
        let table = PointTable {
            sequence: &SEQUENCES[0],
            set: 0,
            pixel_points: PixelPoints::Shared,
        };
        let points = self.points(gpu, sample_count, table)?;
        let transforms = &mut self.tables.harmonics;
        let empty = || {
            prefilter::pass::map(gpu, inputs.layout, inputs.size, inputs.level_count)
                .map(Levels::all)
        };
        let made = maker.table(&mut self.tables.prefiltered, &key, empty, |map| {
            let recipe = inputs.recipe;
            let layout = inputs.layout;
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
        let gpu = maker.gpu;
        let key = inputs.key();
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
        let gpu = maker.gpu;
        let key = inputs.key();
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

/// Makes the targets of a view and draws its g-buffer.
fn target(gpu: &Gpu, request: &RenderRequest, scene: &SceneData) -> Result<Arc<Target>, GpuError> {
    let gbuffer = GbufferImages::new(gpu, request.size)?;
    let texels = if request.scene.is_design {
        let texels = design::gbuffer(&request.scene, request.size);
        gbuffer.write(gpu, &texels)?;
        texels
    } else {
        let mut recorder = gpu.record("gbuffer")?;
        gbuffer_pass::record(&mut recorder, scene, &request.camera, &gbuffer)?;
        recorder.submit()?;
        gbuffer.read(gpu)?
    };
    Ok(Arc::new(Target {
        gbuffer,
        radiance: gpu.buffer("radiance", vec4_bytes(request.size))?,
        mask: Arc::new(texels.mask()),
        n_dot_v: Arc::new(texels.n_dot_v(&request.camera)),
    }))
}

/// Bytes of a vec4 of f32 for each pixel.
fn vec4_bytes([width, height]: [u32; 2]) -> u64 {
    16 * u64::from(width) * u64::from(height)
}

/// Copies the texels to half precision, each at most [`HALF_MAX`].
fn half_copy(gpu: &Gpu, name: &str, table: &Image) -> Result<Image, GpuError> {
    let copy = gpu.faced_image(
        &format!("{name} in halves"),
        table.mip_size(0),
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
    let shading = &request.shading;
    let counts = [
        ("samples", shading.samples),
        ("reference_samples", request.reference_samples),
    ];
    if let Some((field, _)) = counts.into_iter().find(|(_, count)| *count == 0) {
        return Err(PipelineError::NoSamples { field });
    }
    if request.has_reference_term() {
        pair_count(request.reference_samples)?;
    }
    if request.scene.has_anisotropy()
        && let Some(fault) = shading
            .widths
            .fault(shading.brdf, shading.masking_shadowing)
    {
        return Err(PipelineError::Widths(fault));
    }
    Ok(shading.tables().validate()?)
}
