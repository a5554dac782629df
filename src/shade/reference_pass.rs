//! The device passes of the reference: dispatches over scrambles and bands of rows, then one that adds the term to the image.

use super::pass::{Shading, TABLE, with_gbuffer};
use crate::brdf::{Brdf, Compensation, MaskingShadowing};
use crate::environment::distribution::EnvironmentDistribution;
use crate::glsl::constants::GROUP_SIDE;
use crate::glsl::layout::{ShadeParams, SharedStruct};
use crate::gpu::{Bind, Buffer, Gpu, GpuError, Report, Sampler, image_groups};
use crate::pixels::GrayImage;
use crate::precompute::prefilter::{LevelMapping, Weight};
use std::ops::Range;

/// Fewest independent scrambles: with 16, the standard error is itself known to about 18 %.
pub const SCRAMBLE_COUNT_MIN: u32 = 16;
/// Most samples of one scramble, which one dispatch takes in full; also the samples up to which one dispatch takes several scrambles.
const SCRAMBLE_SAMPLES_MAX: u32 = 4096;

/// Which term of the surface a reference integrates.
#[derive(Clone, Copy, Debug)]
pub enum Lobe {
    /// The lobe of a method, and what may shape it.
    Specular { lobe: &'static str, brdf: &'static dyn Brdf, masking: MaskingShadowing, levels: Levels },
    /// The lobe of a diffuse method.
    Diffuse { lobe: &'static str },
}

/// What rungs of the ladder take from a prefiltered map: how its levels are spread, and by what it averages.
#[derive(Clone, Copy, Debug)]
pub struct Levels {
    pub mapping: &'static LevelMapping,
    pub weight: &'static Weight,
}

impl Lobe {
    /// The specialization constants: masking, whether the driver filters in f32, the bend of the levels' mapping, the weight, none, the
    /// compensation.
    fn constants(self, gpu: &Gpu, compensation: Compensation) -> [u32; 6] {
        let is_exact = u32::from(gpu.info().has_exact_filter);
        match self {
            Self::Specular { masking, levels: Levels { mapping, weight }, .. } => {
                [masking as u32, is_exact, (mapping.bend as f32).to_bits(), weight.code, 0, compensation as u32]
            }
            Self::Diffuse { .. } => [MaskingShadowing::default() as u32, is_exact, 0, 0, 0, compensation as u32],
        }
    }

    /// The part of a shader's name after the entry point.
    fn permutation(self) -> String {
        match self {
            Self::Specular { lobe, brdf, .. } => format!("{lobe}:{}", brdf.name()),
            Self::Diffuse { lobe } => lobe.into(),
        }
    }

    /// The shaders that take the samples and that add the term to the image.
    pub fn shaders(self) -> [String; 2] {
        ["reference", "reference_resolve"].map(|entry| format!("shade/{entry}.comp:{}", self.permutation()))
    }

    /// The timed pass.
    fn pass_name(self) -> &'static str {
        match self {
            Self::Specular { .. } => "shade-specular",
            Self::Diffuse { .. } => "shade-diffuse",
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
    /// Exactly `sample_count` samples a pixel, or the counts next to it that whole scrambles draw.
    pub fn exact(sample_count: u32) -> Result<Self, PartScramble> {
        let plan = Self::new(sample_count);
        if plan.sample_count() == u64::from(sample_count) {
            return Ok(plan);
        }
        let is_drawn = |count: &u32| Self::new(*count).sample_count() == u64::from(*count);
        let below = (1..sample_count).rev().find(is_drawn);
        Err(PartScramble { asked: sample_count, below, above: plan.sample_count() })
    }

    /// At least `sample_count` samples a pixel in at least [`SCRAMBLE_COUNT_MIN`] scrambles.
    fn new(sample_count: u32) -> Self {
        let scramble_count = SCRAMBLE_COUNT_MIN.max(sample_count.div_ceil(SCRAMBLE_SAMPLES_MAX));
        Self { scramble_count, samples_per_scramble: sample_count.div_ceil(scramble_count).next_multiple_of(2) }
    }

    /// Samples a pixel in all.
    pub fn sample_count(self) -> u64 {
        u64::from(self.scramble_count) * u64::from(self.samples_per_scramble)
    }
}

/// A number of samples that whole scrambles do not draw: a row that names it would show more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{asked} samples a pixel: the reference draws {SCRAMBLE_COUNT_MIN} or more scrambles of equal, even length; expected {}{above}",
    below.map_or_else(String::new, |below| format!("{below} or ")))]
pub struct PartScramble {
    pub asked: u32,
    /// The next smaller count that is drawn.
    pub below: Option<u32>,
    /// The next larger one.
    pub above: u64,
}

/// Samples of the first look at the error of a reference that stops by it.
const PILOT_SAMPLES: u32 = 64;
/// Such a reference then starts afresh with as many samples as the error suggests: longer nets pay more than more of the short ones,
/// so that keeping the pilot would save less than it costs. The variance of scrambled nets falls with about this power of the count (measured between 256 and 11,520 samples: 1.39, 1.55).
const VARIANCE_EXPONENT: f64 = 1.4;
/// Margin of that prediction: a second miss costs more than a tenth too many.
const PREDICTION_MARGIN: f64 = 1.1;

/// When a reference stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Samples a pixel: exactly so many ([`ScramblePlan::exact`]), or at most so many when `relative_error` is given.
    pub sample_count: u32,
    /// Stops earlier, once the relative standard error of every term is at most this.
    pub relative_error: Option<f64>,
}

impl Stop {
    /// Samples to start with.
    fn first(self) -> u32 {
        self.relative_error.map_or(self.sample_count, |_| self.sample_count.min(PILOT_SAMPLES))
    }

    /// Samples to try after `done` of them left `error`; `None` when that is good enough or all there is.
    fn next(self, done: u32, error: f64) -> Option<u32> {
        let wanted = self.relative_error.filter(|wanted| error > *wanted && done < self.sample_count)?;
        let growth = (error / wanted).powf(2.0 / VARIANCE_EXPONENT) * PREDICTION_MARGIN;
        Some((f64::from(done) * growth).min(f64::from(self.sample_count)) as u32)
    }
}

/// Where a term of the reference stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convergence {
    /// The timed pass of the term, `shade-specular` or `shade-diffuse`.
    pub term: &'static str,
    /// Samples a pixel.
    pub sample_count: u64,
    /// `sqrt(mean of se² / (mean² + ε))` with the ε of the metric `relmse`, over the masked pixels and channels, se the standard error of the pixel's mean.
    pub relative_error: f64,
    /// Whether the requested relative error was reached (or the sample count, where none was requested).
    pub is_met: bool,
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

    /// [`Convergence::relative_error`] of what the sums hold now.
    fn relative_error(&self, gpu: &Gpu, mask: &GrayImage, epsilon: f64) -> Result<f64, GpuError> {
        let means: Vec<[f32; 4]> = gpu.read_buffer(&self.mean)?;
        let deviations: Vec<[f32; 4]> = gpu.read_buffer(&self.squared_deviations)?;
        let (mut sum, mut count) = (0.0, 0u64);
        for ((mean, deviation), _) in means.iter().zip(&deviations).zip(&mask.data).filter(|(_, hit)| **hit > 0.0) {
            let scrambles = f64::from(mean[3]);
            for channel in 0..3 {
                let squared_error = f64::from(deviation[channel]) / (scrambles * (scrambles - 1.0));
                sum += squared_error / (f64::from(mean[channel]).powi(2) + epsilon);
            }
            count += 3;
        }
        Ok(if count > 0 { (sum / count as f64).sqrt() } else { 0.0 })
    }
}

/// An environment's distribution on the device.
#[derive(Clone)]
pub struct DistributionBuffers {
    words: Buffer,
    slots: Buffer,
    slot_count: u32,
}

impl DistributionBuffers {
    pub fn new(gpu: &Gpu, distribution: &EnvironmentDistribution) -> Result<Self, GpuError> {
        Ok(Self {
            words: gpu.buffer_from("environment distribution", distribution.words())?,
            slots: gpu.uniform_from("slots of the environment distribution", &distribution.slot_texels())?,
            slot_count: distribution.slot_count(),
        })
    }
}

/// What one term of the reference reads and writes.
pub struct ReferenceRun<'a> {
    pub shading: Shading<'a>,
    pub stop: Stop,
    /// Keeps the relative error of dark pixels from ruling: beside squared radiance.
    pub epsilon: f64,
    pub seed: u32,
    /// 1 where a surface is hit.
    pub mask: &'a GrayImage,
    pub distribution: &'a DistributionBuffers,
    pub sums: &'a Sums,
    /// Sum of the squared standard errors of the terms: a vec4 a pixel.
    pub squared_error: &'a Buffer,
}

impl ReferenceRun<'_> {
    /// Adds one term to the radiance and its squared standard error to `squared_error`.
    pub fn run(&self, gpu: &Gpu, lobe: Lobe) -> Result<(Report, Convergence), GpuError> {
        let mut total = Report::default();
        let mut samples = self.stop.first();
        let (plan, relative_error) = loop {
            let plan = ScramblePlan::new(samples);
            total.add(self.integrate(gpu, lobe, 0..plan.scramble_count, plan.samples_per_scramble)?);
            let error = self.sums.relative_error(gpu, self.mask, self.epsilon)?;
            match self.stop.next(samples, error) {
                Some(more) => samples = more,
                None => break (plan, error),
            }
        };
        total.add(self.resolve(gpu, lobe)?);
        let convergence = Convergence {
            term: lobe.pass_name(),
            sample_count: plan.sample_count(),
            relative_error,
            is_met: self.stop.relative_error.is_none_or(|wanted| relative_error <= wanted),
        };
        Ok((total, convergence))
    }

    /// Adds what one scramble of the term makes of it to the radiance. Its error is unknown.
    pub fn scramble(
        &self,
        gpu: &Gpu,
        lobe: Lobe,
        scramble: u32,
        samples_per_scramble: u32,
    ) -> Result<Report, GpuError> {
        let mut recorder = gpu.record("reference")?;
        recorder.fill(&self.sums.mean, 0);
        let mut total = recorder.submit()?;
        total.add(self.integrate(gpu, lobe, scramble..scramble + 1, samples_per_scramble)?);
        total.add(self.resolve(gpu, lobe)?);
        Ok(total)
    }

    /// Takes scrambles into the sums, which start afresh with the first.
    fn integrate(
        &self,
        gpu: &Gpu,
        lobe: Lobe,
        scrambles: Range<u32>,
        samples_per_scramble: u32,
    ) -> Result<Report, GpuError> {
        let Shading { settings, tables, gbuffer, .. } = self.shading;
        let [width, height] = gbuffer.size;
        // Setting up a pixel costs as much as a few samples, so that a dispatch takes as many scrambles as it may.
        let least_samples = u64::from(width * GROUP_SIDE) * u64::from(samples_per_scramble.max(1));
        let scrambles_in_budget =
            (gpu.submission_samples() / least_samples).min(u64::from(SCRAMBLE_SAMPLES_MAX)) as u32;
        let scrambles_per_dispatch = (SCRAMBLE_SAMPLES_MAX / samples_per_scramble.max(1))
            .min(scrambles_in_budget)
            .clamp(1, scrambles.len() as u32);
        let samples_per_row = u64::from(width) * u64::from(samples_per_scramble) * u64::from(scrambles_per_dispatch);
        let [shader, _] = lobe.shaders();
        let constants = lobe.constants(gpu, settings.compensation);
        let rest = [
            Bind::Sample(&tables.environment, Sampler::TEXELS),
            Bind::Read(&self.distribution.words),
            Bind::ReadWrite(&self.sums.mean),
            Bind::ReadWrite(&self.sums.squared_deviations),
            Bind::SampleMip(&tables.environment, Sampler::MAP, 0),
            Bind::Uniform(&self.distribution.slots, 0..self.distribution.slots.size()),
            Bind::Sample(&tables.dfg, TABLE),
        ];
        let binds = with_gbuffer(gbuffer, &rest);
        let mut total = Report::default();
        for scramble in scrambles.clone().step_by(scrambles_per_dispatch as usize) {
            for rows in gpu.row_bands(height, samples_per_row) {
                let params = ShadeParams {
                    sample_count: samples_per_scramble,
                    scramble,
                    scramble_count: scrambles_per_dispatch.min(scrambles.end - scramble),
                    seed: self.seed,
                    slot_count: self.distribution.slot_count,
                    ..settings.params(gbuffer.size, rows.start)
                };
                let groups = image_groups(width, rows.end - rows.start);
                total.add(gpu.submit_pass(lobe.pass_name(), |r| {
                    r.dispatch(&shader, &constants, &binds, &params.to_bytes(), groups)
                })?);
            }
        }
        Ok(total)
    }

    /// Adds the term that the sums hold to the image.
    fn resolve(&self, gpu: &Gpu, lobe: Lobe) -> Result<Report, GpuError> {
        let Shading { settings, tables, gbuffer, radiance, .. } = self.shading;
        let [width, height] = gbuffer.size;
        let rest = [
            Bind::Sample(&tables.dfg, TABLE),
            Bind::Read(&self.sums.mean),
            Bind::Read(&self.sums.squared_deviations),
            Bind::ReadWrite(radiance),
            Bind::ReadWrite(self.squared_error),
        ];
        let (binds, push) = (with_gbuffer(gbuffer, &rest), settings.params(gbuffer.size, 0).to_bytes());
        let [_, shader] = lobe.shaders();
        gpu.submit_pass(lobe.pass_name(), |r| {
            r.dispatch(&shader, &lobe.constants(gpu, settings.compensation), &binds, &push, image_groups(width, height))
        })
    }
}
