//! The tables of a request: each is taken from the caches, or made.

use super::PipelineError;
use super::inputs::{
    DfgInputs, IrradianceInputs, PrefilterInputs, SharedKey, TapTableInputs, filtered_key,
    mips_key, sh9_key, sh9_texture_key,
};
use super::resources::{Resources, harmonics};
use super::shared_work::{Levels, Maker};
use crate::base::math::sequence::{PixelPoints, SEQUENCES};
use crate::instrument::environment::Environment;
use crate::instrument::environment::distribution::weighted_texels;
use crate::instrument::environment::layout::MapLayout;
use crate::instrument::gpu::{Buffer, Format, Gpu, GpuError, Image, Report};
use crate::instrument::precompute::mips::level_count;
use crate::instrument::precompute::prefilter::harmonic;
use crate::instrument::precompute::sh9::{self, Projection};
use crate::instrument::precompute::{
    HALF_MAX, PrefilterBy, StorageFormat, dfg, filtered, irradiance, mips, prefilter,
};
use crate::instrument::shade::PointTable;

impl Resources {
    pub(super) fn environment(
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
    pub(super) fn filtered(
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

    pub(super) fn coefficients(
        &mut self,
        maker: &mut Maker,
        environment: &Environment,
        projection: Projection,
        image: &Image,
    ) -> Result<Buffer, PipelineError> {
        let gpu = maker.gpu;
        let fill = |coefficients: &Buffer| sh9::pass::run(gpu, image, projection, coefficients);
        maker.table(
            &mut self.tables.coefficients,
            &sh9_key(environment, projection),
            || sh9::pass::coefficients(gpu),
            fill,
        )
    }

    /// Returns the texture of irradiance over π of these coefficients.
    pub(super) fn sh9_texture(
        &mut self,
        maker: &mut Maker,
        environment: &Environment,
        projection: Projection,
        coefficients: &Buffer,
    ) -> Result<Image, PipelineError> {
        let gpu = maker.gpu;
        let fill = |texture: &Levels| sh9::pass::evaluate(gpu, coefficients, &texture.image);
        let made = maker.table(
            &mut self.tables.irradiance_maps,
            &sh9_texture_key(environment, projection),
            || sh9::pass::texture(gpu).map(Levels::all),
            fill,
        )?;
        Ok(made.image)
    }

    pub(super) fn irradiance_map(
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

    pub(super) fn prefiltered(
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
            let narrowest = recipe.mapping.narrowest_alpha(inputs.level_count);
            let degree = harmonic::degree_of_map(narrowest);
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

    pub(super) fn dfg_table(
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
                inputs.fresnel_f0,
                inputs.sample_count,
                &table.image,
            )
        })?;
        self.stored(gpu, &key, made.image, storage)
    }

    pub(super) fn tap_table(
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
