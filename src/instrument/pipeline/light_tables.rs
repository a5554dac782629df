//! Reads back the tables of one environment, model and masking.

use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::names::Listed;
use crate::base::pixels::{Pixels, RgbImage};
use crate::instrument::environment::layout::MapLayout;
use crate::instrument::gpu::{Gpu, Image};
use crate::instrument::precompute::PrecomputeSettings;
use crate::instrument::precompute::dfg::DfgAxes;
use crate::instrument::precompute::prefilter::LevelMapping;
use crate::instrument::precompute::taps::TapCount;
use crate::instrument::shade::{Diffuse, METHODS, Method, Shading};

/// Most texels of the finest prefiltered level: a page can hold these for a few models and
/// environments.
const PREFILTERED_TEXELS_MAX: u32 = 1 << 15;

/// The tables of the split sums, the sampled methods and `sh9`.
#[derive(Clone, Debug)]
pub struct LightTables {
    pub layout: &'static MapLayout,
    /// Perceptual roughness of each level of the prefiltered map.
    pub level_mapping: &'static LevelMapping,
    /// Radiance by level, down to one texel, the faces of a level below each other; the finest
    /// levels may be missing.
    pub environment: Vec<RgbImage>,
    /// Radiance coefficients in the order of `shaders/lib/sh.glsl`.
    pub sh9: Vec<[f32; 3]>,
    /// Mean radiance of the lobe, by level.
    pub prefiltered: Vec<RgbImage>,
    /// (A, B) of the DFG table: scale of f0 and bias.
    pub dfg: Pixels<[f32; 2]>,
    /// Positions of its texels.
    pub dfg_axes: DfgAxes,
    /// Tables of taps, in the order that was asked for.
    pub tap_tables: Vec<Pixels<[f32; 4]>>,
}

impl Pipeline {
    /// Makes the tables for the environment, model, masking and settings of `request`, or takes
    /// existing ones. Levels of the environment with more than `texels_max` texels are not read;
    /// the finest prefiltered level has at most `PREFILTERED_TEXELS_MAX`.
    pub fn light_tables(
        &mut self,
        request: &RenderRequest,
        texels_max: u32,
        counts: &[TapCount],
    ) -> Result<LightTables, PipelineError> {
        self.with_memory(|pipeline| pipeline.read_light_tables(request, texels_max, counts))
    }

    fn read_light_tables(
        &mut self,
        request: &RenderRequest,
        texels_max: u32,
        counts: &[TapCount],
    ) -> Result<LightTables, PipelineError> {
        let mut request = RenderRequest {
            shading: Shading {
                method: Method::listed("split-sum"),
                diffuse: Diffuse::listed("sh9"),
                ..request.shading
            },
            ..request.clone()
        };
        let PrecomputeSettings {
            layout,
            level_mapping,
            dfg_axes,
            ..
        } = request.shading.precompute;
        limit_prefiltered_texels(&mut request.shading.precompute);
        let prepared = self.prepare(&request)?;
        let tables = &prepared.tables;
        let rgb = |[r, g, b, _]: [f32; 4]| [r, g, b];
        let level = |image: &Image, mip: u32| read_level(&self.gpu, image, mip);
        let levels = tables.filtered.mip_count();
        let is_small = |&mip: &u32| {
            tables.filtered.mip_size(mip).iter().product::<u32>() * layout.face_count <= texels_max
        };
        let first_level = (0..levels).find(is_small).unwrap_or(levels - 1);
        let dfg = read_texels(&self.gpu, &tables.dfg)?;
        let sh9: Vec<[f32; 4]> = self.gpu.read_buffer(&tables.sh9)?;
        let mut light_tables = LightTables {
            layout,
            level_mapping,
            environment: (first_level..levels)
                .map(|mip| level(&tables.filtered, mip))
                .collect::<Result<_, _>>()?,
            sh9: sh9.into_iter().map(rgb).collect(),
            prefiltered: (0..tables.prefiltered.mip_count())
                .map(|mip| level(&tables.prefiltered, mip))
                .collect::<Result<_, _>>()?,
            dfg_axes,
            dfg: dfg.map(|[a, b, ..]: [f32; 4]| [a, b]),
            tap_tables: Vec::with_capacity(counts.len()),
        };
        for count in counts {
            let table = self.read_tap_table(&mut request, *count)?;
            light_tables.tap_tables.push(table);
        }
        Ok(light_tables)
    }

    /// Reads a table of taps; changes the request's method to one that reads this table.
    fn read_tap_table(
        &mut self,
        request: &mut RenderRequest,
        count: TapCount,
    ) -> Result<Pixels<[f32; 4]>, PipelineError> {
        request.shading.method = METHODS
            .iter()
            .find(|method| method.tap_table == Some(count))
            .expect("a method for each table");
        let table = self.prepare(request)?.tables.tap_table;
        read_texels(&self.gpu, &table)
    }
}

/// Halves the prefiltered map down to [`PREFILTERED_TEXELS_MAX`], as far as its number of levels
/// allows.
fn limit_prefiltered_texels(settings: &mut PrecomputeSettings) {
    let layout = settings.layout;
    let least = layout.side_min << settings.prefilter_level_count;
    let size = &mut settings.prefilter_size;
    while layout.face_count * size[0] * size[1] > PREFILTERED_TEXELS_MAX
        && size[0].min(size[1]) >= least
    {
        *size = size.map(|side| side / 2);
    }
}

/// Reads a level from the device, its faces below each other, without alpha.
pub(super) fn read_level(gpu: &Gpu, image: &Image, mip: u32) -> Result<RgbImage, PipelineError> {
    let [width, height] = image.mip_size(mip);
    Ok(Pixels::new(
        width,
        height * image.face_count(),
        gpu.read_image(image, mip)?,
    )
    .map(|[r, g, b, _]| [r, g, b]))
}

/// Reads level 0 of an image of one face from the device.
pub(super) fn read_texels(gpu: &Gpu, image: &Image) -> Result<Pixels<[f32; 4]>, PipelineError> {
    let [width, height] = image.mip_size(0);
    Ok(Pixels::new(width, height, gpu.read_image(image, 0)?))
}
