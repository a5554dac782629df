//! Counts, registers and waves of compiled shading passes.

use super::child::{ASSEMBLY, CompileFault, compile};
use super::family::Family;
use super::isa::{self, IsaFault, ShaderCounts};
use crate::instrument::gpu::{Executable, ShaderVariant};
use std::path::Path;

pub fn passes(
    program: &Path,
    family: &'static Family,
    variants: &[ShaderVariant],
) -> Result<Vec<Pass>, CompileFault> {
    let compiled = compile(program, family, variants)?;
    let pass = |(variant, stages): (&ShaderVariant, &Vec<Executable>)| {
        let fault = |stderr: String| CompileFault::Shader {
            family: family.name,
            shader: variant.shader.clone(),
            stderr,
        };
        let pass =
            Pass::new(stages).ok_or_else(|| fault("the driver gives no assembly".to_owned()))?;
        pass.map_err(|error| fault(error.to_string()))
    };
    variants.iter().zip(&compiled).map(pass).collect()
}

#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    pub counts: ShaderCounts,
    /// Lanes that share an instruction.
    pub wave: u32,
    /// Vector registers per lane.
    pub vector_registers: u32,
    /// Waves per vector unit, as Mesa counts them: on RDNA waves of 32 lanes.
    pub waves: u32,
}

impl Pass {
    /// Reads a compiled compute shader; `None` without its assembly or statistics.
    pub fn new(stages: &[Executable]) -> Option<Result<Self, IsaFault>> {
        let [stage] = stages else { return None };
        let vector_registers = stage.statistic("VGPRs")? as u32;
        let waves = stage.statistic("Subgroups per SIMD")? as u32;
        let counts = isa::count(stage.text(ASSEMBLY)?);
        Some(counts.map(|counts| Self {
            counts,
            wave: stage.subgroup_size,
            vector_registers,
            waves,
        }))
    }
}
