//! The inputs and shaders of each shared result.
//!
//! A pass gets these inputs and the environment's image, and nothing else of the request: nothing
//! else can change its table. Keys destructure their inputs, so that a new field does not compile
//! before the key has it.

use super::RenderRequest;
use crate::base::glsl::constants::FRESNEL_SCHLICK;
use crate::base::names::Listed;
use crate::base::pixels::Pixels;
use crate::instrument::brdf::{Brdf, FresnelWeight, MaskingShadowing};
use crate::instrument::environment::Environment;
use crate::instrument::environment::layout::MapLayout;
use crate::instrument::precompute::dfg::DfgAxes;
use crate::instrument::precompute::given::{GivenMap, GivenTable};
use crate::instrument::precompute::prefilter::pass::Recipe;
use crate::instrument::precompute::prefilter::{self, Kernel, LevelMapping};
use crate::instrument::precompute::sh9::{self, Projection};
use crate::instrument::precompute::taps::{Chain, TapCount, TapTable};
use crate::instrument::precompute::{
    PrecomputeSettings, PrefilterBy, dfg, filtered, irradiance, mips,
};
use crate::instrument::shade::Shading;
use std::collections::BTreeSet;

/// The name of a shared result.
#[derive(Clone, Debug)]
pub(super) struct SharedKey {
    /// The kind, as tallies, passes and the disk name it.
    pub(super) kind: &'static str,
    /// Every input, one per line. An environment is named by its contents: a map and its clipped
    /// version have one name.
    pub(super) inputs: String,
    /// Every shader between the inputs and the result.
    pub(super) shaders: Vec<String>,
}

impl SharedKey {
    /// Returns the lines that name it on disk, without its code.
    pub(super) fn text(&self) -> String {
        format!("kind={}\n{}", self.kind, self.inputs)
    }

    /// Panics if a shader ran that the key does not name: its changes would go unnoticed.
    pub(super) fn assert_names(&self, ran: &BTreeSet<String>) {
        let unnamed: Vec<&String> = ran
            .iter()
            .filter(|shader| !self.shaders.contains(shader))
            .collect();
        assert!(
            unnamed.is_empty(),
            "the key of {} leaves out {unnamed:?}",
            self.kind
        );
    }
}

pub(super) fn mips_key(environment: &Environment) -> SharedKey {
    let inputs = format!("environment={}\n", environment.hash);
    SharedKey {
        kind: "mips",
        inputs,
        shaders: vec![mips::pass::SHADER.to_owned()],
    }
}

/// Lists the shaders between an environment and its levels in a layout.
fn level_shaders(layout: &MapLayout) -> Vec<String> {
    [mips::pass::SHADER.to_owned()]
        .into_iter()
        .chain(filtered::pass::shaders(layout))
        .collect()
}

/// Key of the environment's levels in a layout that is not its own.
pub(super) fn filtered_key(environment: &Environment, layout: &MapLayout) -> SharedKey {
    let inputs = format!("environment={}\nlayout={}\n", environment.hash, layout.name);
    SharedKey {
        kind: "mips",
        inputs,
        shaders: level_shaders(layout),
    }
}

/// Key of the nine coefficients of the environment's finest level.
pub(super) fn sh9_key(environment: &Environment, projection: Projection) -> SharedKey {
    let inputs = format!(
        "environment={}\nprojection={projection:?}\n",
        environment.hash
    );
    SharedKey {
        kind: "sh9",
        inputs,
        shaders: sh9::pass::SHADERS.map(str::to_owned).to_vec(),
    }
}

/// Key of the texture of their irradiance.
pub(super) fn sh9_texture_key(environment: &Environment, projection: Projection) -> SharedKey {
    let coefficients = sh9_key(environment, projection);
    let texture = std::iter::once(sh9::pass::TEXTURE_SHADER.to_owned());
    SharedKey {
        kind: "sh9-texture",
        inputs: format!("{}size={:?}\n", coefficients.inputs, sh9::TEXTURE_SIZE),
        shaders: coefficients.shaders.into_iter().chain(texture).collect(),
    }
}

pub(super) struct IrradianceInputs<'a> {
    pub(super) environment: &'a Environment,
    pub(super) layout: &'static MapLayout,
    pub(super) size: [u32; 2],
    pub(super) by: PrefilterBy,
    pub(super) sample_count: [u32; 2],
}

impl<'a> IrradianceInputs<'a> {
    pub(super) fn from_request(request: &'a RenderRequest) -> Self {
        let settings = &request.shading.tables();
        Self {
            environment: &request.environment,
            layout: settings.layout,
            size: settings.irradiance_size,
            by: settings.prefilter,
            sample_count: settings.irradiance_sample_count,
        }
    }

    pub(super) fn key(&self) -> SharedKey {
        let Self {
            environment,
            layout,
            size,
            by,
            sample_count,
        } = self;
        let inputs = format!(
            "environment={}\nlayout={}\nsize={size:?}\nsamples={sample_count:?}\nby={}\n",
            environment.hash,
            layout.name,
            by.name(),
        );
        let shaders = [
            level_shaders(layout),
            vec![irradiance::pass::shader(layout)],
        ]
        .concat();
        SharedKey {
            kind: "irradiance",
            inputs,
            shaders,
        }
    }
}

/// Inputs of the prefiltered map, made from the environment's levels.
pub(super) struct PrefilterInputs<'a> {
    pub(super) environment: &'a Environment,
    pub(super) layout: &'static MapLayout,
    pub(super) recipe: Recipe,
    pub(super) size: [u32; 2],
    pub(super) level_count: u32,
    pub(super) by: PrefilterBy,
    pub(super) sample_count: u32,
    /// A map from files that replaces it.
    pub(super) given: Option<&'a GivenMap>,
}

impl<'a> PrefilterInputs<'a> {
    pub(super) fn from_request(request: &'a RenderRequest) -> Self {
        let settings = &request.shading.tables();
        let given = request.given.prefiltered.as_deref();
        Self {
            environment: &request.environment,
            layout: settings.layout,
            recipe: Recipe::new(
                request.shading.brdf,
                request.shading.masking_shadowing,
                settings,
            ),
            size: given.map_or(settings.prefilter_size, |map| [map.side; 2]),
            level_count: settings.prefilter_level_count,
            by: settings.prefilter,
            sample_count: settings.prefilter_sample_count,
            given,
        }
    }

    pub(super) fn key(&self) -> SharedKey {
        let Self {
            environment,
            layout,
            recipe,
            size,
            level_count,
            by,
            sample_count,
            given,
        } = self;
        if let Some(map) = given {
            return SharedKey {
                kind: "prefilter",
                inputs: format!("given={}\n", map.hash),
                shaders: Vec::new(),
            };
        }
        let Recipe {
            kernel:
                Kernel {
                    brdf,
                    weight,
                    masking,
                },
            mapping,
            lod_bias,
        } = recipe;
        let inputs = format!(
            "environment={}\nlayout={}\nbrdf={}\nsize={size:?}\nlevels={level_count}\n\
             samples={sample_count}\nmapping={}\nweight={}\nmasking={masking:?}\n\
             lod_bias={lod_bias}\nby={}\n",
            environment.hash,
            layout.name,
            brdf.name(),
            mapping.name,
            weight.name,
            by.name(),
        );
        let shaders = [
            level_shaders(layout),
            vec![prefilter::pass::shader(*brdf, layout)],
        ]
        .concat();
        SharedKey {
            kind: "prefilter",
            inputs,
            shaders,
        }
    }
}

pub(super) struct DfgInputs<'a> {
    pub(super) brdf: &'static dyn Brdf,
    pub(super) masking: MaskingShadowing,
    pub(super) side: u32,
    pub(super) axes: DfgAxes,
    /// The specialization constant.
    pub(super) fresnel_f0: f32,
    pub(super) sample_count: u32,
    /// A table from files that replaces it.
    pub(super) given: Option<&'a GivenTable>,
}

impl<'a> DfgInputs<'a> {
    pub(super) fn from_request(request: &'a RenderRequest) -> Self {
        let Shading {
            brdf,
            masking_shadowing: masking,
            precompute,
            ..
        } = request.shading;
        let given = request.given.dfg.as_deref();
        let side = given.map_or(precompute.dfg_size, |table| table.side);
        Self {
            brdf,
            masking,
            side,
            axes: precompute.dfg_axes,
            fresnel_f0: request.fresnel_f0(),
            sample_count: precompute.dfg_sample_count,
            given,
        }
    }

    pub(super) fn key(&self) -> SharedKey {
        let Self {
            brdf,
            masking,
            side,
            axes,
            fresnel_f0,
            sample_count,
            given,
        } = self;
        if let Some(table) = given {
            let inputs = format!("given={}\naxes={axes:?}\n", table.hash);
            return SharedKey {
                kind: "dfg",
                inputs,
                shaders: Vec::new(),
            };
        }
        let model = brdf.name();
        let fresnel = fresnel_line(*fresnel_f0);
        let inputs = format!(
            "brdf={model}\nmasking={masking:?}\nsize={side}\naxes={axes:?}\nsamples={sample_count}\n{fresnel}"
        );
        SharedKey {
            kind: "dfg",
            inputs,
            shaders: vec![dfg::pass::shader(*brdf)],
        }
    }
}

/// Returns the line of a key for the exact reflectance of an index; nothing for Schlick's.
fn fresnel_line(fresnel_f0: f32) -> String {
    if fresnel_f0 == FRESNEL_SCHLICK {
        String::new()
    } else {
        format!("fresnel_f0={fresnel_f0}\n")
    }
}

/// Inputs of a table of taps, which is made on the host.
pub(super) struct TapTableInputs {
    pub(super) count: TapCount,
    pub(super) kernel: Kernel,
    pub(super) masking: MaskingShadowing,
    /// F0 whose exact reflectance lobes have, or `FRESNEL_SCHLICK`.
    pub(super) fresnel_f0: f32,
    pub(super) mapping: &'static LevelMapping,
    pub(super) level_count: u32,
}

impl TapTableInputs {
    pub(super) fn from_request(request: &RenderRequest, count: TapCount) -> Self {
        let Shading {
            brdf,
            masking_shadowing: masking,
            ..
        } = request.shading;
        let PrecomputeSettings {
            prefilter_weight,
            level_mapping: mapping,
            prefilter_level_count: level_count,
            ..
        } = request.shading.tables();
        Self {
            count,
            kernel: Kernel::new(brdf, prefilter_weight, masking),
            masking,
            fresnel_f0: request.fresnel_f0(),
            mapping,
            level_count,
        }
    }

    pub(super) fn key(&self) -> SharedKey {
        let Self {
            count,
            kernel:
                Kernel {
                    brdf,
                    weight,
                    masking: weight_masking,
                },
            masking,
            fresnel_f0,
            mapping,
            level_count,
        } = self;
        let fresnel = fresnel_line(*fresnel_f0);
        let inputs = format!(
            "brdf={}\nweight={}\nweight_masking={weight_masking:?}\nmasking={masking:?}\n\
             mapping={}\nlevels={level_count}\ntaps={}\n{fresnel}",
            brdf.name(),
            weight.name,
            mapping.name,
            *count as u32,
        );
        // The model's shader identifies the model.
        SharedKey {
            kind: "taps",
            inputs,
            shaders: vec![dfg::pass::shader(*brdf)],
        }
    }

    pub(super) fn texels(&self) -> Pixels<[f32; 4]> {
        let chain = Chain::new(self.kernel, self.mapping, self.level_count);
        let fresnel = FresnelWeight::of_constant(self.fresnel_f0);
        TapTable::fit_reflecting(&chain, self.kernel.brdf, self.masking, fresnel, self.count).texels
    }

    /// Returns width and height of the table.
    pub(super) fn size(&self) -> [u32; 2] {
        TapTable::size(self.count)
    }
}
