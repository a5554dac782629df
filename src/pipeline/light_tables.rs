//! What lights a surface, read back from the device: the tables of one environment, model and masking.

use super::{Pipeline, PipelineError, RenderRequest};
use crate::environment::layout::MapLayout;
use crate::gpu::{Gpu, Image};
use crate::pixels::{Pixels, RgbImage};
use crate::precompute::PrecomputeSettings;
use crate::precompute::dfg::DfgAxes;
use crate::precompute::prefilter::LevelMapping;
use crate::shade::{Diffuse, Method, Shading};
use crate::spelling::Listed;

/// Texels of the finest prefiltered level: what a page can hold for a few models and environments.
const PREFILTERED_TEXELS_MAX: u32 = 1 << 15;

/// The method whose table of lobes is read; bakes write it.
pub(super) const LOBES_OF: &str = "split-sum-relative";

/// The tables by which the split sums, the sampled methods and `sh9` shade.
#[derive(Clone, Debug)]
pub struct LightTables {
    /// How the maps lie in texels.
    pub layout: &'static MapLayout,
    /// Which roughness each level of the prefiltered map holds.
    pub level_mapping: &'static LevelMapping,
    /// Radiance level by level, down to one texel, the faces of a level below each other; the finest levels are left out.
    pub environment: Vec<RgbImage>,
    /// Radiance coefficients in the order of `shaders/lib/sh.glsl`.
    pub sh9: Vec<[f32; 3]>,
    /// Mean radiance of the lobe, level by level.
    pub prefiltered: Vec<RgbImage>,
    /// The DFG table: what scales f0, and what is added.
    pub dfg: Pixels<[f32; 2]>,
    /// Where its texels lie.
    pub dfg_axes: DfgAxes,
    /// The table of lobe shapes, all of its parts.
    pub lobe_shapes: Pixels<[f32; 4]>,
}

impl Pipeline {
    /// Makes the tables for the environment, model, masking and settings of `request`, or takes those that are there. Levels of the
    /// environment of more than `texels_max` are not read; the prefiltered map has at most `PREFILTERED_TEXELS_MAX`.
    pub fn light_tables(&mut self, request: &RenderRequest, texels_max: u32) -> Result<LightTables, PipelineError> {
        self.with_memory(|pipeline| pipeline.read_light_tables(request, texels_max))
    }

    fn read_light_tables(&mut self, request: &RenderRequest, texels_max: u32) -> Result<LightTables, PipelineError> {
        let mut request = RenderRequest {
            shading: Shading { method: Method::listed(LOBES_OF), diffuse: Diffuse::listed("sh9"), ..request.shading },
            lights: Vec::new(),
            ..request.clone()
        };
        let PrecomputeSettings { layout, prefilter_level_count, level_mapping, dfg_axes, .. } =
            request.shading.precompute;
        let size = &mut request.shading.precompute.prefilter_size;
        // Halved no further than its levels allow.
        let least = layout.side_min << prefilter_level_count;
        while layout.face_count * size[0] * size[1] > PREFILTERED_TEXELS_MAX && size[0].min(size[1]) >= least {
            *size = size.map(|side| side / 2);
        }
        let prepared = self.prepare(&request)?;
        let tables = &prepared.tables;
        let rgb = |[r, g, b, _]: [f32; 4]| [r, g, b];
        let level = |image: &Image, mip: u32| read_level(&self.gpu, image, mip);
        let levels = tables.filtered.mip_count();
        let is_small =
            |&mip: &u32| tables.filtered.mip_size(mip).iter().product::<u32>() * layout.face_count <= texels_max;
        let first_level = (0..levels).find(is_small).unwrap_or(levels - 1);
        let [width, height] = tables.dfg.mip_size(0);
        let dfg = Pixels::new(width, height, self.gpu.read_image(&tables.dfg, 0)?);
        let [width, height] = tables.lobe_shapes.mip_size(0);
        let lobe_shapes = Pixels::new(width, height, self.gpu.read_image(&tables.lobe_shapes, 0)?);
        let sh9: Vec<[f32; 4]> = self.gpu.read_buffer(&tables.sh9)?;
        Ok(LightTables {
            layout,
            level_mapping,
            environment: (first_level..levels).map(|mip| level(&tables.filtered, mip)).collect::<Result<_, _>>()?,
            sh9: sh9.into_iter().map(rgb).collect(),
            prefiltered: (0..tables.prefiltered.mip_count())
                .map(|mip| level(&tables.prefiltered, mip))
                .collect::<Result<_, _>>()?,
            dfg_axes,
            dfg: dfg.map(|[a, b, ..]: [f32; 4]| [a, b]),
            lobe_shapes,
        })
    }
}

/// A level of an image on the device, its faces below each other, without its alpha.
pub(super) fn read_level(gpu: &Gpu, image: &Image, mip: u32) -> Result<RgbImage, PipelineError> {
    let [width, height] = image.mip_size(mip);
    Ok(Pixels::new(width, height * image.face_count(), gpu.read_image(image, mip)?).map(|[r, g, b, _]| [r, g, b]))
}
