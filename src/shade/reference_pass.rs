//! The device passes of the reference: dispatches over scrambles and bands of rows, then one that adds the term to the image.

use super::pass::{GBUFFER_SLOTS, ShadeSettings, groups, with_gbuffer};
use crate::brdf::{Brdf, MaskingShadowing};
use crate::gbuffer::pass::GbufferImages;
use crate::glsl::constants::GROUP_SIDE;
use crate::glsl::layout::{ShadeParams, SharedStruct};
use crate::gpu::{Bind, Buffer, ComputePipeline, Filter, Gpu, GpuError, Image, Report, Sampler, Slot, Wrap};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Fewest independent scrambles: with 16, the standard error is itself known to about 18 %.
pub const SCRAMBLE_COUNT_MIN: u32 = 16;
/// Most samples of one scramble, which one dispatch takes in full; also the samples up to which one dispatch takes several scrambles.
const SCRAMBLE_SAMPLES_MAX: u32 = 4096;

/// Which term of the surface a reference integrates.
#[derive(Clone, Copy, Debug)]
pub enum Lobe {
    Specular(&'static dyn Brdf, MaskingShadowing),
    Diffuse,
}

impl Lobe {
    fn key(self) -> (&'static str, MaskingShadowing) {
        match self {
            Self::Specular(brdf, masking_shadowing) => (brdf.name(), masking_shadowing),
            Self::Diffuse => ("lambert", MaskingShadowing::default()),
        }
    }

    /// The part of a shader's name after the entry point.
    fn permutation(self) -> String {
        match self {
            Self::Specular(brdf, _) => format!("specular:{}", brdf.name()),
            Self::Diffuse => "lambert".into(),
        }
    }

    /// The timed pass.
    fn pass_name(self) -> &'static str {
        match self {
            Self::Specular(..) => "shade-specular",
            Self::Diffuse => "shade-diffuse",
        }
    }
}

/// How a number of samples is spread over scrambles: `scramble_count` of `samples_per_scramble` (even) each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScramblePlan {
    pub scramble_count: u32,
    pub samples_per_scramble: u32,
}

impl ScramblePlan {
    /// At least `sample_count` samples a pixel in at least [`SCRAMBLE_COUNT_MIN`] scrambles.
    pub fn new(sample_count: u32) -> Self {
        let scramble_count = SCRAMBLE_COUNT_MIN.max(sample_count.div_ceil(SCRAMBLE_SAMPLES_MAX));
        Self { scramble_count, samples_per_scramble: sample_count.div_ceil(scramble_count).next_multiple_of(2) }
    }

    /// Samples a pixel in all.
    pub fn sample_count(self) -> u64 {
        u64::from(self.scramble_count) * u64::from(self.samples_per_scramble)
    }
}

/// The pipelines, made when they are first needed.
pub struct ReferencePass {
    integrate: HashMap<(&'static str, MaskingShadowing), ComputePipeline>,
    resolve: HashMap<&'static str, ComputePipeline>,
    nearest: Sampler,
    clamp: Sampler,
}

/// Mean and squared deviations over scrambles of the term at work: a vec4 a pixel each.
pub struct Sums {
    mean: Buffer,
    squared_deviations: Buffer,
}

impl Sums {
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, GpuError> {
        let bytes = 16 * u64::from(size[0]) * u64::from(size[1]);
        Ok(Self {
            mean: gpu.buffer("reference means", bytes)?,
            squared_deviations: gpu.buffer("reference deviations", bytes)?,
        })
    }
}

/// What one term of the reference reads and writes.
pub struct ReferenceRun<'a> {
    pub settings: &'a ShadeSettings,
    pub sample_count: u32,
    pub seed: u32,
    pub environment: &'a Image,
    /// [`crate::environment::EnvironmentDistribution::words`].
    pub distribution: &'a Buffer,
    pub dfg: &'a Image,
    pub gbuffer: &'a GbufferImages,
    pub radiance: &'a Buffer,
    /// Sum of the squared standard errors of the terms.
    pub squared_error: &'a Buffer,
}

impl ReferencePass {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            integrate: HashMap::new(),
            resolve: HashMap::new(),
            nearest: gpu.sampler(Filter::Nearest, Wrap::Equirect)?,
            clamp: gpu.sampler(Filter::Linear, Wrap::Clamp)?,
        })
    }

    /// Makes the pipelines of a term, if they are not made yet.
    pub fn prepare(&mut self, gpu: &Gpu, lobe: Lobe) -> Result<(), GpuError> {
        let key = lobe.key();
        if let Entry::Vacant(entry) = self.integrate.entry(key) {
            let slots = [&GBUFFER_SLOTS[..], &[Slot::Sampled], &[Slot::Buffer; 3]].concat();
            let shader = format!("shade/reference.comp:{}", lobe.permutation());
            let pipeline = gpu.compute_pipeline(&shader, &slots, ShadeParams::SIZE, &[key.1 as u32])?;
            entry.insert(pipeline);
        }
        if let Entry::Vacant(entry) = self.resolve.entry(key.0) {
            let slots = [&GBUFFER_SLOTS[..], &[Slot::Sampled], &[Slot::Buffer; 4]].concat();
            let shader = format!("shade/reference_resolve.comp:{}", lobe.permutation());
            let pipeline = gpu.compute_pipeline(&shader, &slots, ShadeParams::SIZE, &[key.1 as u32])?;
            entry.insert(pipeline);
        }
        Ok(())
    }

    /// Adds one term to `radiance` and its squared standard error to `squared_error`; the pipelines must be prepared.
    pub fn run(&self, gpu: &Gpu, lobe: Lobe, sums: &Sums, run: &ReferenceRun<'_>) -> Result<Report, GpuError> {
        let plan = ScramblePlan::new(run.sample_count);
        let [width, height] = run.gbuffer.size;
        // Setting up a pixel costs as much as a few samples, so that a dispatch takes as many scrambles as it may.
        let scrambles_per_dispatch =
            (SCRAMBLE_SAMPLES_MAX / plan.samples_per_scramble.max(1)).clamp(1, plan.scramble_count);
        let samples_per_row =
            u64::from(width) * u64::from(plan.samples_per_scramble) * u64::from(scrambles_per_dispatch);
        let mut total = Report::default();
        for scramble in (0..plan.scramble_count).step_by(scrambles_per_dispatch as usize) {
            for rows in gpu.row_bands(height, samples_per_row, GROUP_SIDE) {
                let params = ShadeParams {
                    sample_count: plan.samples_per_scramble,
                    scramble,
                    scramble_count: scrambles_per_dispatch.min(plan.scramble_count - scramble),
                    seed: run.seed,
                    ..run.settings.params(run.gbuffer.size, rows.start)
                };
                let rest = [
                    Bind::Sample(run.environment, &self.nearest),
                    Bind::Read(run.distribution),
                    Bind::ReadWrite(&sums.mean),
                    Bind::ReadWrite(&sums.squared_deviations),
                ];
                let binds = with_gbuffer(run.gbuffer, &self.nearest, &rest);
                let groups = groups(width, rows.end - rows.start);
                let mut recorder = gpu.record("reference")?;
                recorder.pass(lobe.pass_name(), |r| {
                    r.dispatch(&self.integrate[&lobe.key()], &binds, &params.to_bytes(), groups)
                })?;
                total.add(recorder.submit()?);
            }
        }
        let rest = [
            Bind::Sample(run.dfg, &self.clamp),
            Bind::Read(&sums.mean),
            Bind::Read(&sums.squared_deviations),
            Bind::ReadWrite(run.radiance),
            Bind::ReadWrite(run.squared_error),
        ];
        let binds = with_gbuffer(run.gbuffer, &self.nearest, &rest);
        let params = run.settings.params(run.gbuffer.size, 0);
        let mut recorder = gpu.record("reference resolve")?;
        recorder.pass(lobe.pass_name(), |r| {
            r.dispatch(&self.resolve[lobe.key().0], &binds, &params.to_bytes(), groups(width, height))
        })?;
        total.add(recorder.submit()?);
        Ok(total)
    }
}
