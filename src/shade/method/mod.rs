//! The specular methods: what each is called, what changes its result, and its f64 twin.

pub mod ladder;
pub mod ladder_texels;
mod none;
pub mod own;
mod reference;
mod sampled;
mod sampled_unfiltered;
mod sampled_vndf;
pub mod split_sum;
mod split_sum_engines;
mod split_sum_fitted;
mod split_sum_moment;
mod split_sum_parted;
mod split_sum_relative;

use super::NONE;
use super::diffuse::Diffuse;
use super::twin::SpecularTwin;
use crate::brdf::Compensation;
use crate::precompute::{PrecomputeSettings, PrefilterBy, StorageFormat};
use crate::spelling::listed;

/// How the specular term is computed. The names are the shader file stems (with `-` for `_`).
///
/// The flags say what changes its result: an experiment has one cell, not many, along an axis that a method ignores.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    pub name: &'static str,
    /// One sentence for `splitsum list`.
    pub about: &'static str,
    /// What the device tests hold its frames to.
    pub twin: SpecularTwin,
    /// The sample count.
    pub uses_samples: bool,
    /// The sequence of points and the choice among its sets (`math::sequence`).
    pub uses_point_set: bool,
    /// The bias of the mip level.
    pub uses_lod_bias: bool,
    /// How often a pixel looks the prefiltered map up.
    pub lookups: u32,
    /// The DFG table, for the specular term itself; see [`Method::needs_dfg`].
    pub uses_dfg: bool,
    /// The table of lobe shapes.
    pub uses_lobe_shapes: bool,
    /// The widths of the prefiltered map's levels, if not the map.
    pub uses_levels: bool,
    /// The weight of a prefiltered map, if not the map.
    pub uses_weight: bool,
    /// How the maps that are looked up filtered are made for it, whatever is asked.
    pub prefilter: Option<PrefilterBy>,
    /// In which numbers its tables are kept, whatever is asked.
    pub storage: Option<StorageFormat>,
    /// Whether its error has the steps of the ladder (`crate::ladder`).
    pub has_ladder: bool,
    /// The part of its shader's name that stands for it, where not its own name: a method in a file.
    pub shader: Option<&'static str>,
    /// The integrand, where the passes of the reference estimate the term without bias: a file of `shaders/shade/lobe/`.
    pub lobe: Option<&'static str>,
}

/// Every specular method. Adding one: `shaders/shade/method/<stem>.glsl` (or `lobe/`), its file here with its twin, and one line here.
pub static METHODS: &[Method] = &[
    sampled::METHOD,
    sampled_vndf::METHOD,
    sampled_unfiltered::METHOD,
    split_sum::METHOD,
    split_sum_engines::FILAMENT,
    split_sum_engines::FROSTBITE,
    split_sum_engines::GODOT,
    split_sum_engines::NRD,
    split_sum_engines::UNITY,
    split_sum_moment::METHOD,
    split_sum_fitted::METHOD,
    split_sum_relative::METHOD,
    split_sum_parted::METHOD,
    none::METHOD,
    reference::METHOD,
    ladder::FRESNEL,
    ladder::MASKING,
    ladder::MASKING_ALONE,
    ladder::VIEW,
    ladder::LEVELS,
    ladder_texels::TEXELS,
    ladder_texels::SAMPLES,
    ladder_texels::STORAGE,
];

impl Method {
    /// A method that depends on nothing but the scene. Each file sets its flags beside it; no method goes without a twin.
    const fn plain(name: &'static str, about: &'static str, twin: SpecularTwin) -> Self {
        Self {
            name,
            about,
            twin,
            uses_samples: false,
            uses_point_set: false,
            uses_lod_bias: false,
            lookups: 0,
            uses_dfg: false,
            uses_lobe_shapes: false,
            uses_levels: false,
            uses_weight: false,
            prefilter: None,
            storage: None,
            has_ladder: false,
            shader: None,
            lobe: None,
        }
    }

    /// The settings of its tables where those are asked for.
    pub fn tables(&self, asked: PrecomputeSettings) -> PrecomputeSettings {
        let (prefilter, storage) = (self.prefilter.unwrap_or(asked.prefilter), self.storage.unwrap_or(asked.storage));
        PrecomputeSettings { prefilter, storage, ..asked }
    }

    /// Whether it reads the prefiltered map.
    pub fn uses_prefiltered(&self) -> bool {
        self.lookups > 0
    }

    /// How often a pixel looks an environment map up, prefiltered or not, at that sample count; nothing where another image is integrated, or
    /// where a shader in a file may do so any number of times.
    pub fn lookups_of_pixel(&self, samples: Option<u32>) -> Option<u32> {
        if self.shader.is_some() {
            return None;
        }
        let count = if self.uses_samples { samples? } else { self.lookups };
        (count > 0).then_some(count)
    }

    /// Whether the passes of the reference estimate it: without bias, with a standard error.
    pub fn is_integrated(&self) -> bool {
        self.lobe.is_some()
    }

    /// Whether it leaves the term out.
    pub fn is_none(&self) -> bool {
        self.name == NONE
    }

    /// Whether a shader of its own makes the term: the reference has other passes.
    pub fn has_pass(&self) -> bool {
        !self.is_none() && !self.is_integrated()
    }

    /// Whether a frame reads the DFG table: for the specular term itself, or to weight what else the surface reflects beside it.
    pub fn needs_dfg(&self, compensation: Compensation, diffuse: &Diffuse, has_lights: bool) -> bool {
        let is_compensated = compensation != Compensation::None;
        self.uses_dfg || (!self.is_none() && (is_compensated || !diffuse.is_none() || has_lights))
    }
}

listed!(
    Method,
    "method",
    METHODS,
    /// Finds a listed method, or `file:PATH` ([`own`]).
    fn by_name(name: &str) -> Option<&'static Self> {
        Self::all().find(|method| method.name == name).or_else(|| own::loaded(name))
    }
);
