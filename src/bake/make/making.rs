//! What to bake for an engine.

use crate::bake::container::{TEXELS_MAX, Texel};
use crate::bake::convention::Preset;
use crate::bake::map_form::MapForm;
use crate::bake::playcanvas_atlas;
use crate::bake::product::Product;
use crate::base::pixels::exr;
use crate::instrument::brdf::{Brdf, Ggx, MaskingShadowing};
use crate::instrument::environment::Environment;
use crate::instrument::precompute::prefilter::Weight;

/// Default sides, texels.
pub const IRRADIANCE_SIDE: u32 = 32;
pub const TABLE_SIDE: u32 = 64;

/// Smallest side of a face, texels.
const SIDE_MIN: u32 = 8;
/// Smallest side of an atlas, texels.
const ATLAS_SIDE_MIN: u32 = playcanvas_atlas::SIDE;

/// An engine, and the settings of its bake.
#[derive(Clone, Debug)]
pub struct Making<'a> {
    pub preset: &'static Preset,
    pub environment: &'a Environment,
    pub brdf: &'static dyn Brdf,
    pub masking: MaskingShadowing,
    pub weight: &'static Weight,
    pub texel: &'static Texel,
    /// Sides of a face, of the irradiance map and of the table, texels.
    pub side: u32,
    pub irradiance_side: u32,
    pub table_side: u32,
    /// Levels of the prefiltered map, from 2 to one per halving of `side`.
    pub level_count: u32,
}

impl<'a> Making<'a> {
    /// Starts with an engine's defaults: GGX, faces of `side` texels, its pixel format and number
    /// of levels.
    pub fn new(preset: &'static Preset, environment: &'a Environment, side: u32) -> Self {
        let convention = preset.convention();
        let product = preset.product();
        Self {
            preset,
            environment,
            brdf: &Ggx,
            masking: convention.masking,
            weight: convention.weight,
            texel: product.texel(),
            side,
            irradiance_side: IRRADIANCE_SIDE,
            table_side: TABLE_SIDE,
            level_count: product.levels(side),
        }
    }

    /// Reports settings that the engine's format cannot hold.
    pub fn check(&self) -> Result<(), String> {
        self.check_formats()?;
        self.check_sizes()?;
        self.check_texel()
    }

    /// Refuses an engine whose files this build cannot write.
    fn check_formats(&self) -> Result<(), String> {
        let product = self.preset.product();
        let mut names = [product.specular]
            .into_iter()
            .chain(product.tables.iter().copied());
        if !exr::IS_BUILT && names.any(is_exr) {
            return Err(format!(
                "--for {} writes OpenEXR; build with the feature exr",
                product.engine
            ));
        }
        Ok(())
    }

    fn check_sizes(&self) -> Result<(), String> {
        let product = self.preset.product();
        let engine = product.engine;
        let side = self.side;
        let level_count = self.level_count;
        let has_many_texels = 8 * u64::from(side).pow(2) > TEXELS_MAX;
        if !side.is_power_of_two() || side < SIDE_MIN || has_many_texels {
            return Err(format!(
                "faces of {side} texels; --for {engine} needs a power of 2 from 8 to 1024"
            ));
        }
        if matches!(self.form(), MapForm::PlayCanvasAtlas) && side < ATLAS_SIDE_MIN {
            return Err(format!(
                "an atlas of {side} texels; --for {engine} needs {ATLAS_SIDE_MIN} or 1024"
            ));
        }
        let level_count_max = side.ilog2() + 1;
        if let Some(count) = product.level_count
            && (level_count != count || count > level_count_max)
        {
            return Err(format!(
                "{level_count} levels, faces of {side} texels; --for {engine} needs {count} \
                 levels and faces of at least {}",
                1 << (count - 1)
            ));
        }
        let needs_all = self.preset.convention().levels_per_doubling.is_some();
        if needs_all && level_count != level_count_max {
            return Err(format!(
                "{level_count} levels; --for {engine} needs {level_count_max}, down to one texel"
            ));
        }
        if !(2..=level_count_max).contains(&level_count) {
            return Err(format!(
                "{level_count} levels; faces of {side} have 2 to {level_count_max}"
            ));
        }
        Ok(())
    }

    /// Returns the form of the prefiltered map.
    pub fn form(&self) -> MapForm {
        MapForm::of(self.preset.product().specular)
    }

    fn check_texel(&self) -> Result<(), String> {
        let product = self.preset.product();
        if product.excluded_texels.contains(&self.texel.name) {
            let known: Vec<&str> = formats(product).map(|texel| texel.name).collect();
            return Err(format!(
                "--format {}: {} does not draw it; expected one of {}",
                self.texel.name,
                product.engine,
                known.join(", ")
            ));
        }
        let known: Vec<&str> = formats(product).map(|texel| texel.name).collect();
        if !known.contains(&self.texel.name) {
            let form = MapForm::of(product.specular).name();
            return Err(format!(
                "{} in {form}; --for {} needs one of {}",
                self.texel.name,
                product.engine,
                known.join(", ")
            ));
        }
        Ok(())
    }
}

fn is_exr(name: &str) -> bool {
    name.ends_with(".exr") || matches!(MapForm::of(name), MapForm::Faces)
}

/// Lists the pixel formats that an engine's map may have.
pub fn formats(product: &Product) -> impl Iterator<Item = &'static Texel> {
    product.texels().into_iter()
}
