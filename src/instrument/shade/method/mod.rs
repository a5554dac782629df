//! The specular methods: names, parameters, f64 twins.

pub mod from_file;
pub mod ladder;
mod printed_document_0;
mod sampled;
mod sampled_unfiltered;
mod sampled_vndf;
mod sheen_lookup;
pub mod split_sum;
mod split_sum_bent;
mod split_sum_cap;
mod split_sum_engines;
mod split_sum_factors;
mod split_sum_major;
mod split_sum_strips;
mod split_sum_taps;

pub use printed_document_0::printed_lobe_alpha;

use super::diffuse::Diffuse;
use super::reference::integrate;
use super::twin::{SpecularTwin, Twin};
use super::{NONE, REFERENCE};
use crate::base::names::Listed;
use crate::instrument::brdf::Compensation;
use crate::instrument::precompute::taps::TapCount;
use crate::instrument::precompute::{PrecomputeSettings, PrefilterBy, StorageFormat};
use glam::DVec3;

/// A method to compute the specular term. Names are the stems of shader files (with `-` for `_`).
///
/// The flags name the axes that change its result: along any other axis an experiment has one cell.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    pub name: &'static str,
    pub title: &'static str,
    pub about: &'static str,
    /// Twin that device tests compare its frames with.
    pub twin: SpecularTwin,
    pub uses_samples: bool,
    /// Reads the points of a sequence and set (`math::sequence`).
    pub uses_point_set: bool,
    pub uses_lod_bias: bool,
    pub uses_bend: bool,
    /// Lookups of the prefiltered map per pixel.
    pub lookups: u32,
    /// Reads the DFG table for the specular term itself; see [`Method::needs_dfg`].
    pub uses_dfg: bool,
    /// The table of taps that it reads.
    pub tap_table: Option<TapCount>,
    /// Depends on the widths of the prefiltered map's levels without reading the map.
    pub uses_levels: bool,
    /// Depends on the weight of prefiltered maps without reading one.
    pub uses_weight: bool,
    /// Overrides how its filtered maps are made.
    pub prefilter: Option<PrefilterBy>,
    /// Overrides the number format of its tables.
    pub storage: Option<StorageFormat>,
    /// Whether its error has a ladder of steps (`crate::instrument::ladder`).
    pub has_ladder: bool,
    /// Whether it is a split sum to prefer to the textbook's.
    pub is_corrected: bool,
    /// Whether it has a factor other than the table's `f0 A + B`, so that it and the diffuse term
    /// do not add up to the light.
    pub has_other_factor: bool,
    /// Whether it repeats the slips of a printed formula, to show what they do.
    pub is_as_printed: bool,
    /// Replaces its name in the name of its shader: for methods in files.
    pub shader: Option<&'static str>,
    /// The text of its shader, for methods in files.
    pub text: Option<&'static str>,
    /// The integrand if the passes of the reference estimate the term without bias: a file of
    /// `shaders/shade/lobe/`.
    pub lobe: Option<&'static str>,
}

/// Every specular method. To add one: `shaders/shade/method/<stem>.glsl` (or `lobe/`), its file and
/// a line here.
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
    split_sum_factors::VTK,
    split_sum_factors::PLAYCANVAS,
    split_sum_factors::BABYLON,
    split_sum_cap::METHOD,
    split_sum_taps::ONE,
    split_sum_taps::TWO,
    split_sum_taps::FOUR,
    split_sum_bent::METHOD,
    split_sum_major::TWO,
    split_sum_major::FOUR,
    split_sum_strips::TWO,
    split_sum_strips::FOUR,
    printed_document_0::METHOD,
    Method::plain(
        NONE,
        "No specular term",
        "no specular term",
        Twin::Estimator(|_, _, _| DVec3::ZERO),
    ),
    INTEGRATED,
    ladder::FRESNEL,
    ladder::MASKING,
    ladder::MASKING_ALONE,
    ladder::VIEW,
    ladder::LEVELS,
    ladder::TEXELS,
    ladder::SAMPLES,
    ladder::STORAGE,
];

/// The unbiased estimator of the specular integral, by many random samples of BRDF and environment.
const INTEGRATED: Method = Method {
    uses_samples: true,
    lobe: Some("specular"),
    ..Method::plain(
        REFERENCE,
        "Reference",
        "unbiased: BRDF and environment sampling combined, many samples, unfiltered",
        Twin::Mean(|environment, surface, _, tolerance| {
            integrate(environment, surface, tolerance).specular
        }),
    )
};

impl Method {
    /// A method that depends on the scene only. Each file sets its flags; every method has a twin.
    const fn plain(
        name: &'static str,
        title: &'static str,
        about: &'static str,
        twin: SpecularTwin,
    ) -> Self {
        Self {
            name,
            title,
            about,
            twin,
            uses_samples: false,
            uses_point_set: false,
            uses_lod_bias: false,
            uses_bend: false,
            lookups: 0,
            uses_dfg: false,
            tap_table: None,
            uses_levels: false,
            uses_weight: false,
            prefilter: None,
            storage: None,
            has_ladder: false,
            is_corrected: false,
            has_other_factor: false,
            is_as_printed: false,
            shader: None,
            text: None,
            lobe: None,
        }
    }

    /// Returns the settings of its tables if `asked` is requested.
    pub fn tables(&self, asked: PrecomputeSettings) -> PrecomputeSettings {
        PrecomputeSettings {
            prefilter: self.prefilter.unwrap_or(asked.prefilter),
            storage: self.storage.unwrap_or(asked.storage),
            ..asked
        }
    }

    /// Its role; `None` for references, their ladder, and formulas with printed slips, which no
    /// page recommends.
    pub fn role(&self) -> Option<Role> {
        let is_in_file = self.shader.is_some();
        if self.is_integrated() || self.is_none() || self.is_as_printed {
            None
        } else if self.uses_samples {
            Some(Role::Sampling)
        } else if self.has_ladder {
            Some(Role::Textbook)
        } else if !self.uses_dfg && !is_in_file {
            None
        } else if self.is_corrected || is_in_file {
            Some(Role::Corrected)
        } else {
            Some(Role::Other)
        }
    }

    /// Its name with a sample count: "Sampling, 16 samples".
    pub fn words(&self, samples: Option<u32>) -> String {
        match samples {
            Some(1) => format!("{}, 1 sample", self.title),
            Some(count) => format!("{}, {count} samples", self.title),
            None => self.title.to_owned(),
        }
    }

    pub fn uses_prefiltered(&self) -> bool {
        self.lookups > 0
    }

    /// Returns how often a pixel looks up an environment map, prefiltered or not, at that sample
    /// count; `None` if another image is integrated, or for a shader in a file.
    pub fn lookups_of_pixel(&self, samples: Option<u32>) -> Option<u32> {
        if self.shader.is_some() {
            return None;
        }
        let count = if self.uses_samples {
            samples?
        } else {
            self.lookups
        };
        (count > 0).then_some(count)
    }

    /// Whether a frame reads the DFG table: for the specular term itself, or to weigh the other
    /// terms.
    pub fn needs_dfg(&self, compensation: Compensation, diffuse: &Diffuse) -> bool {
        let is_compensated = compensation != Compensation::None;
        self.uses_dfg || (!self.is_none() && (is_compensated || !diffuse.is_none()))
    }
}

impl Listed for Method {
    const WHAT: &'static str = "method";
    const LISTED_IN: Option<&'static str> = Some("a name of `splitsum list methods`");

    fn all() -> impl Iterator<Item = &'static Self> + Clone {
        METHODS.iter()
    }

    fn name(&self) -> &'static str {
        self.name
    }

    /// Finds a listed method, or `file:PATH` ([`from_file`]).
    fn by_name(name: &str) -> Option<&'static Self> {
        Self::all()
            .find(|method| method.name == name)
            .or_else(|| from_file::loaded(name))
    }
}

/// Role of a method, which sets its colour in figures and captions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    Textbook,
    /// A split sum to prefer to the textbook's, or a method in a file.
    Corrected,
    Sampling,
    /// Another split sum, such as an engine's.
    Other,
}
