//! The bound: between units that overlap perfectly and units that never do.
//!
//! A pixel executes `o ceil(N / P) + i N` instructions, o outside and i inside the loop over samples; a dispatch takes P points. Its cycles
//! lie between the busiest unit's and the sum over all units, for as long as waves hide each other's latency and caches hold the maps.

use super::child::{ASSEMBLY, CompileFault, Compiled, Job, compile};
use super::family::{Card, FRAME, Family, STREAMED_BYTES, Texel, UNITS};
use super::isa::{self, Counts, IsaFault, ShaderCounts};
use crate::brdf::{Brdf, MaskingShadowing};
use crate::environment::layout::MapLayout;
use crate::glsl::constants::POINTS_PER_DISPATCH;
use crate::precompute::prefilter;
use crate::shade::Shading;
use crate::shade::pass::specular_shader;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Sample counts above are not tried.
pub const AFFORDED_MAX: u32 = 1 << 16;

/// Two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// All units at work at the same time, at their highest published rates.
    pub least: f64,
    /// One unit at a time, at their lowest published rates.
    pub most: f64,
}

/// The specular pass of an image.
pub fn job(shading: &Shading) -> Job {
    let Shading { method, brdf, precompute, .. } = *shading;
    Job::new(specular_shader(precompute.layout, method, brdf), &shading.constants(), STREAMED_BYTES)
}

/// The pass that makes the levels of a prefiltered map by samples: "pixels" are texels, each written once.
pub fn prefilter_job(layout: &MapLayout, brdf: &dyn Brdf, masking: MaskingShadowing, texel: Texel) -> Job {
    Job::new(prefilter::pass::shader(brdf, layout), &[masking as u32], texel.bytes())
}

/// The passes of these jobs on a family.
pub fn passes(program: &Path, family: &'static Family, jobs: &[Job]) -> Result<Vec<Pass>, CompileFault> {
    let compiled = compile(program, family, jobs)?;
    let pass = |(job, compiled): (&Job, &Compiled)| {
        let fault = |said: String| CompileFault::Shader { family: family.name, shader: job.shader.clone(), said };
        let pass = Pass::new(compiled).ok_or_else(|| fault("the driver gives no assembly".to_owned()))?;
        let mut pass = pass.map_err(|error| fault(error.to_string()))?;
        pass.counts.outside.dram_bytes = job.streamed_bytes;
        Ok(pass)
    };
    jobs.iter().zip(&compiled).map(pass).collect()
}

/// What the compiler made of a pass over pixels.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Pass {
    pub counts: ShaderCounts,
    /// Lanes that share an instruction.
    pub wave: u32,
    pub vector_registers: u32,
    /// Waves that one vector unit can hold, as Mesa counts them: on RDNA waves of 32 lanes.
    pub waves: u32,
}

impl Pass {
    /// Reads what a compute shader became; `None` without its assembly or statistics.
    pub fn new(compiled: &Compiled) -> Option<Result<Self, IsaFault>> {
        let [stage] = &compiled.executables[..] else { return None };
        let [vector_registers, waves] = ["VGPRs", "Subgroups per SIMD"].map(|name| stage.statistic(name));
        let (vector_registers, waves) = (vector_registers? as u32, waves? as u32);
        let counts = isa::count(stage.text(ASSEMBLY)?);
        Some(counts.map(|counts| Self { counts, wave: stage.subgroup_size, vector_registers, waves }))
    }

    /// What one pixel of `sample_count` samples executes.
    pub fn executed(&self, sample_count: u32) -> Counts {
        // Without a loop it takes no samples: one dispatch.
        let is_looped = self.counts.inside != Counts::default();
        let dispatches = if is_looped { sample_count.div_ceil(POINTS_PER_DISPATCH) } else { 1 };
        let mut all = self.counts.outside.times(f64::from(dispatches));
        all += self.counts.inside.times(f64::from(sample_count));
        all
    }

    /// Cycles of a compute unit a pixel.
    pub fn cycles(&self, family: &Family, texel: Texel, sample_count: u32) -> Bound {
        self.cycles_of(&self.executed(sample_count), family, texel)
    }

    /// Cycles of a part of what a pixel executes.
    pub fn cycles_of(&self, counts: &Counts, family: &Family, texel: Texel) -> Bound {
        let clocks = |end| family.clocks(counts, texel, self.wave, end);
        Bound { least: clocks(0).into_iter().fold(0.0, f64::max), most: clocks(1).into_iter().sum() }
    }

    /// Most samples a pixel that this pass takes at the cost of another one: where its upper end meets the other's lower end, and the
    /// reverse; both at one clock ([`Family::at_boost`]). Up to [`AFFORDED_MAX`].
    pub fn afforded(&self, family: &Family, texel: Texel, other: Bound) -> [u32; 2] {
        let most_where = |fits: &dyn Fn(Bound) -> bool| {
            (1..=AFFORDED_MAX).take_while(|n| fits(self.cycles(family, texel, *n))).last().unwrap_or(0)
        };
        [most_where(&|own| own.most <= other.least), most_where(&|own| own.least <= other.most)]
    }

    /// The unit that sets the lower end.
    pub fn busiest(&self, family: &Family, texel: Texel, sample_count: u32) -> &'static str {
        let clocks = family.clocks(&self.executed(sample_count), texel, self.wave, 0);
        let place = (0..UNITS.len()).max_by(|a, b| clocks[*a].total_cmp(&clocks[*b]));
        UNITS[place.expect("there are units")]
    }
}

impl Bound {
    /// Milliseconds that a card takes for [`FRAME`] at these cycles a pixel: the lower end at its boost clock, the upper one at the other.
    pub fn milliseconds(self, card: &Card) -> Self {
        let pixels = f64::from(FRAME[0]) * f64::from(FRAME[1]);
        let of = |cycles: f64, mhz: f64| cycles * pixels / (f64::from(card.compute_units) * mhz * 1e3);
        let [boost, game] = card.clock_mhz;
        Self { least: of(self.least, boost), most: of(self.most, game) }
    }
}
