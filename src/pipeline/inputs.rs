//! What each precomputed table is made of, and by which shaders.
//!
//! A pass is given these inputs and the environment's image and nothing else of the request, so nothing else can change its table. A key
//! takes the inputs apart by name: a new field does not compile until the key has it.

use super::RenderRequest;
use crate::brdf::{Brdf, MaskingShadowing};
use crate::environment::Environment;
use crate::precompute::dfg::pass::DfgPass;
use crate::precompute::irradiance::pass::IrradiancePass;
use crate::precompute::mips::pass::MipsPass;
use crate::precompute::prefilter::pass::PrefilterPass;
use crate::precompute::sh9::pass::Sh9Pass;

/// The inputs of a kind of table.
pub(super) trait Inputs {
    /// What tallies, passes and the disk call the kind.
    const KIND: &'static str;
    /// Every input, one line each. An environment is named by its content: a map and its clip have one name.
    fn key(&self) -> String;
    /// Every shader between the inputs and the table.
    fn shaders(&self) -> Vec<String>;
}

/// The environment's mip chain.
pub(super) struct MipsInputs<'a> {
    pub(super) environment: &'a Environment,
}

/// Nine coefficients of the environment's finest level.
pub(super) struct Sh9Inputs<'a> {
    pub(super) environment: &'a Environment,
}

/// The map of irradiance, from the environment's levels.
pub(super) struct IrradianceInputs<'a> {
    pub(super) environment: &'a Environment,
    pub(super) size: [u32; 2],
    pub(super) sample_count: [u32; 2],
}

/// The prefiltered map, from the environment's levels.
pub(super) struct PrefilterInputs<'a> {
    pub(super) environment: &'a Environment,
    pub(super) brdf: &'static dyn Brdf,
    pub(super) size: [u32; 2],
    pub(super) level_count: u32,
    pub(super) sample_count: u32,
}

/// The DFG table.
pub(super) struct DfgInputs {
    pub(super) brdf: &'static dyn Brdf,
    pub(super) masking: MaskingShadowing,
    pub(super) side: u32,
    pub(super) sample_count: u32,
}

impl Inputs for MipsInputs<'_> {
    const KIND: &'static str = "mips";

    fn key(&self) -> String {
        let Self { environment } = self;
        format!("environment={}\n", environment.hash)
    }

    fn shaders(&self) -> Vec<String> {
        vec![MipsPass::SHADER.to_owned()]
    }
}

impl Inputs for Sh9Inputs<'_> {
    const KIND: &'static str = "sh9";

    fn key(&self) -> String {
        let Self { environment } = self;
        format!("environment={}\n", environment.hash)
    }

    fn shaders(&self) -> Vec<String> {
        Sh9Pass::SHADERS.map(str::to_owned).to_vec()
    }
}

impl<'a> IrradianceInputs<'a> {
    pub(super) fn of(request: &'a RenderRequest) -> Self {
        let settings = &request.precompute;
        let (size, sample_count) = (settings.irradiance_size, settings.irradiance_sample_count);
        Self { environment: &request.environment, size, sample_count }
    }
}

impl Inputs for IrradianceInputs<'_> {
    const KIND: &'static str = "irradiance";

    fn key(&self) -> String {
        let Self { environment, size, sample_count } = self;
        format!("environment={}\nsize={size:?}\nsamples={sample_count:?}\n", environment.hash)
    }

    fn shaders(&self) -> Vec<String> {
        [MipsPass::SHADER, IrradiancePass::INTEGRATE_SHADER].map(str::to_owned).to_vec()
    }
}

impl<'a> PrefilterInputs<'a> {
    pub(super) fn of(request: &'a RenderRequest) -> Self {
        let settings = &request.precompute;
        Self {
            environment: &request.environment,
            brdf: request.brdf,
            size: settings.prefilter_size,
            level_count: settings.prefilter_level_count,
            sample_count: settings.prefilter_sample_count,
        }
    }
}

impl Inputs for PrefilterInputs<'_> {
    const KIND: &'static str = "prefilter";

    fn key(&self) -> String {
        let Self { environment, brdf, size, level_count, sample_count } = self;
        let (environment, brdf) = (&environment.hash, brdf.name());
        format!("environment={environment}\nbrdf={brdf}\nsize={size:?}\nlevels={level_count}\nsamples={sample_count}\n")
    }

    fn shaders(&self) -> Vec<String> {
        vec![MipsPass::SHADER.to_owned(), PrefilterPass::shader(self.brdf)]
    }
}

impl DfgInputs {
    pub(super) fn of(request: &RenderRequest) -> Self {
        let settings = &request.precompute;
        Self {
            brdf: request.brdf,
            masking: request.masking_shadowing,
            side: settings.dfg_size,
            sample_count: settings.dfg_sample_count,
        }
    }
}

impl Inputs for DfgInputs {
    const KIND: &'static str = "dfg";

    fn key(&self) -> String {
        let Self { brdf, masking, side, sample_count } = self;
        format!("brdf={}\nmasking={masking:?}\nsize={side}\nsamples={sample_count}\n", brdf.name())
    }

    fn shaders(&self) -> Vec<String> {
        vec![DfgPass::shader(self.brdf)]
    }
}
