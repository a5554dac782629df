//! The parameters of one image: method, model, placement of the light, points and tables.

use super::bend::{BENDS, Bend};
use super::coat::{COAT_RENDERERS, CoatLayering, CoatRenderer};
use super::frames::Frames;
use super::sheen::{SHEEN_LOOKUPS, SheenLookup};
use super::{Diffuse, Method, NONE};
use crate::base::glsl::constants::PIXEL_POINTS_SHIFTED;
use crate::base::math::sequence::{FramePoints, PixelPoints, R2_OF_FRAMES, SEQUENCES, Sequence};
use crate::base::names::Listed;
use crate::instrument::brdf::{
    Brdf, Compensation, Ggx, MaskingShadowing, SheenVisibility, WidthLaw,
};
use crate::instrument::environment::Placement;
use crate::instrument::precompute::PrecomputeSettings;

/// How an image is shaded, for any scene, camera and environment.
#[derive(Clone, Copy, Debug)]
pub struct Shading {
    pub placement: Placement,
    /// Multiplies the environment's radiance.
    pub environment_scale: f32,
    pub brdf: &'static dyn Brdf,
    pub masking_shadowing: MaskingShadowing,
    pub compensation: Compensation,
    pub method: &'static Method,
    pub diffuse: &'static Diffuse,
    /// Samples a pixel of a sampled method.
    pub samples: u32,
    pub sequence: &'static Sequence,
    /// Set of the sequence: 0 is plain, k > 0 are randomised copies.
    pub point_set: u32,
    pub pixel_points: PixelPoints,
    /// The sequence of frames that the image ends.
    pub frames: Frames,
    /// The index of the image in a sequence, which then assigns the points; `None` for an image
    /// alone.
    pub frame: Option<u32>,
    /// Added to the mip level of a filtered method.
    pub lod_bias: f32,
    pub precompute: PrecomputeSettings,
    /// Makes the two widths of anisotropic materials.
    pub widths: WidthLaw,
    /// How `split-sum-bent` looks up lobes of two widths.
    pub bend: &'static Bend,
    pub coat_layering: CoatLayering,
    pub coat_renderer: &'static CoatRenderer,
    pub sheen_visibility: SheenVisibility,
    pub sheen_lookup: &'static SheenLookup,
}

impl Default for Shading {
    /// GGX, split sum, no diffuse term, default tables.
    fn default() -> Self {
        Self {
            placement: Placement::default(),
            environment_scale: 1.0,
            brdf: &Ggx,
            masking_shadowing: MaskingShadowing::default(),
            compensation: Compensation::default(),
            method: Method::listed("split-sum"),
            diffuse: Diffuse::listed(NONE),
            samples: 64,
            sequence: &SEQUENCES[0],
            point_set: 0,
            pixel_points: PixelPoints::default(),
            frames: Frames::default(),
            frame: None,
            lod_bias: 0.0,
            precompute: PrecomputeSettings::default(),
            widths: WidthLaw::default(),
            bend: &BENDS[0],
            coat_layering: CoatLayering::default(),
            coat_renderer: &COAT_RENDERERS[0],
            sheen_visibility: SheenVisibility::default(),
            sheen_lookup: &SHEEN_LOOKUPS[0],
        }
    }
}

impl Shading {
    /// Returns the settings of the tables that the method gets.
    pub fn tables(&self) -> PrecomputeSettings {
        self.method.tables(self.precompute)
    }

    /// Returns the specialization constants of the specular pass.
    pub fn constants(&self) -> [u32; 9] {
        let mut constants = self.table_constants(self.masking_shadowing);
        constants[2] = (self.precompute.level_mapping.bend as f32).to_bits();
        constants[4] = match self.frame.map(|_| self.frames.points) {
            None => self.pixel_points as u32,
            Some(FramePoints::Owen) => PixelPoints::Owen as u32,
            Some(_) => PIXEL_POINTS_SHIFTED,
        };
        constants[8] = if self.method.uses_bend {
            self.bend.code()
        } else {
            self.sheen_lookup.code()
        };
        constants
    }

    /// Returns the table of points: sequence, set, and its kind.
    pub fn point_table(&self) -> (&'static Sequence, u32, PixelPoints) {
        match self.frame.map(|_| self.frames.points) {
            None => (self.sequence, self.point_set, self.pixel_points),
            Some(FramePoints::Owen) => (self.sequence, self.point_set, PixelPoints::Owen),
            Some(FramePoints::R2) => (&R2_OF_FRAMES, 0, PixelPoints::Owen),
            Some(FramePoints::Blue) => (self.sequence, 0, PixelPoints::Owen),
        }
    }

    /// Returns the seed of the scrambles of pixels; the first frame has the set's own.
    pub fn point_seed(&self) -> u32 {
        /// 2^32 over the golden ratio: no two frames of near sets have one seed.
        const STEP: u32 = 0x9e37_79b9;
        self.point_set
            .wrapping_add(self.frame.unwrap_or(0).wrapping_mul(STEP))
    }

    /// Returns the specialization constants of passes that read no map of the lobe.
    pub(super) fn table_constants(&self, masking: MaskingShadowing) -> [u32; 9] {
        // The second and the fourth belong to the reference, the eighth to the scene
        // (`Passes::tangents`).
        [
            masking as u32,
            0,
            0,
            0,
            0,
            self.compensation as u32,
            self.precompute.dfg_axes as u32,
            0,
            0,
        ]
    }
}
