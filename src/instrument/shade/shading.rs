//! The parameters of one image: method, model, placement of the light, points and tables.

use super::bend::{BENDS, Bend};
use super::coat::{COAT_RENDERERS, CoatLayering, CoatRenderer};
use super::frames::Frames;
use super::metallic::MetallicMix;
use super::occlusion::SpecularOcclusion;
use super::sheen::{SHEEN_LOOKUPS, SheenLookup};
use super::{Diffuse, Method, NONE};
use crate::base::glsl::constants::{
    PIXEL_POINTS_SHIFTED, SHADE_FLAG_MIX_BRDFS, SHADE_FLAG_NO_SPECULAR,
};
use crate::base::glsl::specialization::Specialization;
use crate::base::math::sequence::{FramePoints, PixelPoints, R2_OF_FRAMES, SEQUENCES, Sequence};
use crate::base::names::Listed;
use crate::instrument::brdf::{
    Brdf, Compensation, Fresnel, Ggx, MaskingShadowing, SheenVisibility, WidthLaw,
};
use crate::instrument::environment::Placement;
use crate::instrument::precompute::PrecomputeSettings;

/// The points of a sampled method as the device stores them.
#[derive(Clone, Copy, Debug)]
pub struct PointTable {
    pub sequence: &'static Sequence,
    pub set: u32,
    pub pixel_points: PixelPoints,
}

/// How an image is shaded, for any scene, camera and environment.
#[derive(Clone, Copy, Debug)]
pub struct Shading {
    pub placement: Placement,
    /// Multiplies the environment's radiance.
    pub environment_scale: f32,
    pub brdf: &'static dyn Brdf,
    pub masking_shadowing: MaskingShadowing,
    pub compensation: Compensation,
    pub fresnel: Fresnel,
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
    pub specular_occlusion: SpecularOcclusion,
    pub metallic_mix: MetallicMix,
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
            fresnel: Fresnel::default(),
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
            specular_occlusion: SpecularOcclusion::default(),
            metallic_mix: MetallicMix::default(),
        }
    }
}

impl Shading {
    /// Returns the settings of the tables that the method gets.
    pub fn tables(&self) -> PrecomputeSettings {
        self.method.tables(self.precompute)
    }

    /// Returns the specialization constants of the specular pass, for lobes of one width.
    pub fn specialization(&self) -> Specialization {
        Specialization {
            masking: self.masking_shadowing as u32,
            level_bend: self.precompute.level_mapping.bend() as f32,
            level_roughnesses: self.precompute.level_mapping.device_list(),
            pixel_points: match self.points_of_frame() {
                None => self.pixel_points as u32,
                Some(FramePoints::Owen) => PixelPoints::Owen as u32,
                Some(FramePoints::R2 | FramePoints::Blue) => PIXEL_POINTS_SHIFTED,
            },
            sheen_lookup: self.sheen_lookup.code(),
            ..self.table_specialization()
        }
    }

    /// Returns the specialization constants of passes that read no map of the lobe. The default of
    /// `bend` reads the DFG table at the surface's alpha.
    pub(super) fn table_specialization(&self) -> Specialization {
        let general = Specialization {
            compensation: self.compensation as u32,
            dfg_axes: self.precompute.dfg_axes as u32,
            ..Specialization::default()
        };
        Specialization {
            bend: if self.method.uses_bend {
                self.bend.code()
            } else {
                general.bend
            },
            ..general
        }
    }

    /// Returns the bits of `ShadeParams::flags`.
    pub fn flags(&self) -> u32 {
        let flag = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
        flag(self.method.is_none(), SHADE_FLAG_NO_SPECULAR)
            | flag(self.metallic_mix == MetallicMix::Brdf, SHADE_FLAG_MIX_BRDFS)
    }

    /// How a sequence of frames assigns the points; `None` for an image alone.
    fn points_of_frame(&self) -> Option<FramePoints> {
        self.frame.map(|_| self.frames.points)
    }

    /// Returns the points that the device stores, before pixels scramble or shift them.
    pub fn point_table(&self) -> PointTable {
        let owen = |sequence, set| PointTable {
            sequence,
            set,
            pixel_points: PixelPoints::Owen,
        };
        match self.points_of_frame() {
            None => PointTable {
                sequence: self.sequence,
                set: self.point_set,
                pixel_points: self.pixel_points,
            },
            Some(FramePoints::Owen) => owen(self.sequence, self.point_set),
            Some(FramePoints::R2) => owen(&R2_OF_FRAMES, 0),
            Some(FramePoints::Blue) => owen(self.sequence, 0),
        }
    }

    /// Returns the seed of the scrambles of pixels; the first frame has the seed of the set.
    pub fn point_seed(&self) -> u32 {
        /// 2^32 over the golden ratio: no two frames of near sets have one seed.
        const STEP: u32 = 0x9e37_79b9;
        self.point_set
            .wrapping_add(self.frame.unwrap_or(0).wrapping_mul(STEP))
    }
}
