//! What can prevent a frame.

use crate::instrument::gpu::GpuError;
use crate::instrument::precompute::SettingsError;
use crate::instrument::scene::NoDielectric;
use crate::instrument::shade::Method;
use crate::instrument::shade::reference_pass::PartPair;

#[derive(Debug, thiserror::Error)]
pub enum PipelineError {
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A broken integrator must not pass as dark or clipped.
    #[error(
        "{}: {count} pixels of the radiance are not finite or are negative, the first at column \
         {x}, row {y}: {value:?}",
        method.name
    )]
    InvalidRadiance {
        method: &'static Method,
        count: usize,
        x: u32,
        y: u32,
        value: [f32; 3],
    },
    #[error("{field} is 0; expected at least 1")]
    NoSamples { field: &'static str },
    #[error(transparent)]
    PartPair(#[from] PartPair),
    #[error(transparent)]
    Settings(#[from] SettingsError),
    #[error("anisotropy: {0}")]
    Widths(String),
    #[error("metallic_mix: brdf does not support {0}; expected metallic_mix = \"f0\"")]
    MetallicMix(&'static str),
    #[error("fresnel: exact needs dielectrics of one grey F0 below 1, {0}")]
    Fresnel(NoDielectric),
    #[error(
        "the driver does not filter cubes across their edges; choose another layout: layout \
         = \"octahedral\""
    )]
    OpenCubes,
    /// Found before anything was allocated.
    #[error("{part} is too large for the device: it needs {needed}, the limit is {limit}")]
    TooLarge {
        part: String,
        needed: String,
        limit: String,
    },
}

impl PipelineError {
    /// Whether the request itself must change: no retry can serve it.
    pub fn is_input(&self) -> bool {
        match self {
            Self::OpenCubes
            | Self::TooLarge { .. }
            | Self::NoSamples { .. }
            | Self::PartPair(_)
            | Self::Widths(_)
            | Self::Fresnel(_)
            | Self::MetallicMix(_)
            | Self::Settings(_) => true,
            Self::InvalidRadiance { method, .. } => method.text.is_some(),
            Self::Gpu(_) => false,
        }
    }

    /// Whether [`super::Pipeline::interrupt_by`] stopped the work.
    pub fn is_interrupted(&self) -> bool {
        matches!(self, Self::Gpu(GpuError::Interrupted))
    }

    /// Whether a retry on a fresh device may succeed.
    pub fn is_transient(&self) -> bool {
        matches!(self, Self::Gpu(error) if error.is_transient())
    }
}
