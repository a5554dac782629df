//! The device passes of the reference: dispatches over parts of nets and image, then one that adds
//! the term.

use super::Method;
use super::pass::{DIFFUSE_PASS, Passes, SPECULAR_PASS, TABLE};
use crate::base::glsl::constants::{GROUP_SIDE, SCRAMBLE_COUNT};
use crate::base::glsl::layout::{ShadeParams, SharedStruct};
use crate::base::glsl::specialization::Specialization;
use crate::base::pixels::GrayImage;
use crate::instrument::brdf::Brdf;
use crate::instrument::environment::distribution::EnvironmentDistribution;
use crate::instrument::gpu::{Bind, Buffer, Gpu, GpuError, Part, Report, Sampler};
use crate::instrument::metrics::Epsilon;
use std::ops::Range;

/// Most samples of a pixel that one dispatch takes.
const DISPATCH_SAMPLES_MAX: u32 = 4096;

/// The term that a reference integrates, by the name of its lobe.
#[derive(Clone, Copy, Debug)]
pub enum Lobe {
    Specular(&'static str),
    Diffuse(&'static str),
}

impl Lobe {
    /// Returns the specialization constants of both passes of the lobe.
    fn specialization(self, gpu: &Gpu, passes: &Passes) -> Specialization {
        Specialization {
            exact_filter: u32::from(gpu.info().has_exact_filter),
            ..self.shading_specialization(passes)
        }
    }

    /// Returns the specialization constants that the lobe reads.
    pub fn shading_specialization(self, passes: &Passes) -> Specialization {
        let shading = passes.shading;
        let general = Specialization {
            anisotropy: passes.anisotropy(),
            ..passes.reflecting(shading.table_specialization())
        };
        match self {
            Self::Diffuse(_) => general,
            Self::Specular(_) => Specialization {
                masking: shading.masking_shadowing as u32,
                level_bend: shading.precompute.level_mapping.bend() as f32,
                level_roughnesses: shading.precompute.level_mapping.device_list(),
                prefilter_weight: shading.precompute.prefilter_weight.code,
                sheen_visibility: shading.sheen_visibility as u32,
                ..general
            },
        }
    }

    /// Names the shaders that take the samples and that add the term to the image.
    pub fn shaders(self, brdf: &dyn Brdf) -> [String; 2] {
        ["reference", "reference_resolve"].map(|entry| self.shader(entry, brdf))
    }

    /// Names the shader of the lobe under direct lights.
    pub fn lights_shader(self, brdf: &dyn Brdf) -> String {
        self.shader("lights", brdf)
    }

    fn shader(self, entry: &str, brdf: &dyn Brdf) -> String {
        let permutation = match self {
            Self::Specular(lobe) if lobe != Method::SHEEN.name => format!("{lobe}:{}", brdf.name()),
            Self::Specular(lobe) | Self::Diffuse(lobe) => lobe.into(),
        };
        format!("shade/{entry}.comp:{permutation}")
    }

    fn pass_name(self) -> &'static str {
        match self {
            Self::Specular(_) => SPECULAR_PASS,
            Self::Diffuse(_) => DIFFUSE_PASS,
        }
    }
}

/// One pair of samples in each of the [`SCRAMBLE_COUNT`] scrambles: every sample count is a
/// multiple of this.
const SAMPLES_PER_PAIR: u32 = 2 * SCRAMBLE_COUNT;

/// Returns the pairs per scramble for exactly `sample_count` samples a pixel; the error suggests
/// possible counts.
pub fn pair_count(sample_count: u32) -> Result<u32, PartPair> {
    let pairs = sample_count / SAMPLES_PER_PAIR;
    if pairs > 0 && sample_count.is_multiple_of(SAMPLES_PER_PAIR) {
        return Ok(pairs);
    }
    let below = (pairs > 0).then_some(pairs * SAMPLES_PER_PAIR);
    Err(PartPair {
        asked: sample_count,
        below,
        above: (u64::from(pairs) + 1) * u64::from(SAMPLES_PER_PAIR),
    })
}

/// The sample count is not a whole number of pairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{asked} samples a pixel; the reference needs a multiple of {SAMPLES_PER_PAIR} (pairs in \
         {SCRAMBLE_COUNT} scrambles), \
    such as {}{above}",
    below.map_or_else(String::new, |below| format!("{below} or ")))]
pub struct PartPair {
    pub asked: u32,
    /// The next smaller possible count.
    pub below: Option<u32>,
    /// The next larger one.
    pub above: u64,
}

/// Bytes of the sums of a pixel: two vec4 a scramble.
pub const SUM_BYTES_PER_PIXEL: u64 = 32 * SCRAMBLE_COUNT as u64;

/// Samples before the error is first checked.
pub const PILOT_SAMPLES: u32 = 64;
/// The variance of scrambled nets falls with about this power of the count (measured, 256 to
/// 11,520: 1.39, 1.55).
const VARIANCE_EXPONENT: f64 = 1.4;

/// When a reference stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Samples a pixel: exactly this many ([`pair_count`]), or at most this many if
    /// `relative_error` is set.
    pub sample_count: u32,
    /// Stops earlier, once the relative standard error of every term is at most this.
    pub relative_error: Option<f64>,
}

impl Stop {
    fn first(self) -> u32 {
        self.relative_error
            .map_or(self.sample_count, |_| self.sample_count.min(PILOT_SAMPLES))
    }

    /// Returns the next sample count after `done` samples left `error`; `None` if that suffices or
    /// is all.
    ///
    /// Nets of a power of two of points are best, so the count doubles, as often as the error
    /// suggests.
    fn next(self, done: u32, error: f64) -> Option<u32> {
        let wanted = self
            .relative_error
            .filter(|wanted| error > *wanted && done < self.sample_count)?;
        let doublings = (2.0 / VARIANCE_EXPONENT * (error / wanted).log2())
            .round()
            .max(1.0);
        Some((f64::from(done) * doublings.exp2()).min(f64::from(self.sample_count)) as u32)
    }
}

/// Where a term of the reference stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convergence {
    /// The timed pass of the term, `shade-specular` or `shade-diffuse`.
    pub term: &'static str,
    /// Samples a pixel.
    pub sample_count: u64,
    /// `sqrt(mean of se² / (mean² + ε))`, ε as in `relmse`, over masked pixels and channels; se:
    /// standard error.
    pub relative_error: f64,
    /// Whether the requested relative error was reached; always true without one.
    pub is_met: bool,
}

/// Sums of every scramble of the current term: two vec4 per pixel and scramble. Dispatches see the
/// rows of their part.
pub struct Sums {
    buffer: Buffer,
    row_bytes: u64,
}

/// The sums of a term before it was added to the image: a reference with more samples continues
/// them.
pub struct Drawn {
    pair_count: u32,
    sums: Vec<[[f32; 4]; 2]>,
}

impl Drawn {
    pub fn bytes(&self) -> usize {
        size_of_val(&self.sums[..])
    }
}

impl Sums {
    pub fn new(gpu: &Gpu, [width, height]: [u32; 2]) -> Result<Self, GpuError> {
        let row_bytes = SUM_BYTES_PER_PIXEL * u64::from(width);
        let bytes = row_bytes * u64::from(height);
        Ok(Self {
            buffer: gpu.buffer_bound_in_parts("reference sums", bytes)?,
            row_bytes,
        })
    }

    /// Splits the image into parts whose sums one binding can hold.
    fn parts(
        &self,
        gpu: &Gpu,
        size: [u32; 2],
        samples_per_pixel: u32,
    ) -> impl Iterator<Item = Part> {
        let rows_max = gpu.max_buffer_bytes() / self.row_bytes;
        gpu.parts_of_rows(size, rows_max as u32, samples_per_pixel.into())
    }

    /// Binds the sums of the rows of a part.
    fn bind(&self, part: Part) -> Bind<'_> {
        let rows = u64::from(part.groups.count[1] * GROUP_SIDE);
        let start = u64::from(part.first_row) * self.row_bytes;
        let end = (start + rows * self.row_bytes).min(self.buffer.size());
        Bind::ReadWritePart(&self.buffer, start..end)
    }

    fn read(&self, gpu: &Gpu) -> Result<Vec<[[f32; 4]; 2]>, GpuError> {
        gpu.read_buffer(&self.buffer)
    }

    /// Writes earlier sums back; returns whether they fit.
    fn write(&self, gpu: &Gpu, sums: &[[[f32; 4]; 2]]) -> Result<bool, GpuError> {
        let bytes: &[u8] = bytemuck::cast_slice(sums);
        let fits = bytes.len() as u64 == self.buffer.size();
        if fits {
            gpu.write_buffer(&self.buffer, bytes)?;
        }
        Ok(fits)
    }
}

impl Drawn {
    /// Computes [`Convergence::relative_error`]; an estimate is `scale` times its sum.
    fn relative_error(&self, mask: &GrayImage, scale: f64, epsilon: Epsilon) -> f64 {
        let scrambles = f64::from(SCRAMBLE_COUNT);
        let mut sum = 0.0;
        let mut count = 0u64;
        let pixels = self
            .sums
            .chunks_exact(SCRAMBLE_COUNT as usize)
            .zip(&mask.data);
        for (estimates, _) in pixels.filter(|(_, hit)| **hit > 0.0) {
            for channel in 0..3 {
                let estimate = |[high, low]: &[[f32; 4]; 2]| {
                    (f64::from(high[channel]) + f64::from(low[channel])) * scale
                };
                let mean = estimates.iter().map(estimate).sum::<f64>() / scrambles;
                let squared = estimates
                    .iter()
                    .map(|sums| (estimate(sums) - mean).powi(2))
                    .sum::<f64>();
                sum += epsilon.relative(squared / (scrambles * (scrambles - 1.0)), mean);
            }
            count += 3;
        }
        if count > 0 {
            (sum / count as f64).sqrt()
        } else {
            0.0
        }
    }
}

#[derive(Clone)]
pub struct DistributionBuffers {
    words: Buffer,
    slots: Buffer,
    slot_count: u32,
}

impl DistributionBuffers {
    pub fn new(gpu: &Gpu, distribution: &EnvironmentDistribution) -> Result<Self, GpuError> {
        Ok(Self {
            words: gpu.buffer_from("environment distribution", &distribution.words)?,
            slots: gpu.uniform_from(
                "slots of the environment distribution",
                &distribution.slot_texels(),
            )?,
            slot_count: distribution.slots.len() as u32,
        })
    }
}

/// Inputs and outputs of one reference term.
pub struct ReferenceRun<'a> {
    pub passes: Passes<'a>,
    pub stop: Stop,
    /// ε of `relmse`.
    pub epsilon: Epsilon,
    pub seed: u32,
    /// 1 if a surface is hit.
    pub mask: &'a GrayImage,
    pub distribution: &'a DistributionBuffers,
    pub sums: &'a Sums,
    /// Sum of the squared standard errors of the terms: a vec4 per pixel.
    pub squared_error: &'a Buffer,
}

/// What one reference term leaves besides its image.
pub struct TermRun {
    pub report: Report,
    pub convergence: Convergence,
    pub drawn: Drawn,
}

impl ReferenceRun<'_> {
    /// Adds one term to the radiance and its squared standard error to `squared_error`; `begun` are
    /// earlier sums of the same term.
    pub fn run(&self, gpu: &Gpu, lobe: Lobe, begun: Option<&Drawn>) -> Result<TermRun, GpuError> {
        let mut total = Report::default();
        let mut samples = self.stop.first();
        let mut done = 0;
        let usable = begun.filter(|begun| begun.pair_count <= samples / SAMPLES_PER_PAIR);
        if let Some(begun) = usable
            && self.sums.write(gpu, &begun.sums)?
        {
            done = begun.pair_count;
        }
        let scale = f64::from(self.passes.shading.environment_scale);
        let (relative_error, drawn) = loop {
            let pairs = samples / SAMPLES_PER_PAIR;
            total.add(self.integrate(gpu, lobe, done..pairs)?);
            done = pairs;
            let drawn = Drawn {
                pair_count: done,
                sums: self.sums.read(gpu)?,
            };
            let error = drawn.relative_error(self.mask, scale / f64::from(done), self.epsilon);
            match self.stop.next(samples, error) {
                Some(more) => samples = more,
                None => break (error, drawn),
            }
        };
        total.add(self.resolve(gpu, lobe, done)?);
        let convergence = Convergence {
            term: lobe.pass_name(),
            sample_count: samples.into(),
            relative_error,
            is_met: self
                .stop
                .relative_error
                .is_none_or(|wanted| relative_error <= wanted),
        };
        Ok(TermRun {
            report: total,
            convergence,
            drawn,
        })
    }

    /// Returns the term by scramble and pixel, at exactly `pair_count` pairs: the same points for
    /// every lobe.
    pub fn scrambles(
        &self,
        gpu: &Gpu,
        lobe: Lobe,
        pair_count: u32,
    ) -> Result<Vec<Vec<[f32; 4]>>, GpuError> {
        self.integrate(gpu, lobe, 0..pair_count)?;
        self.resolve(gpu, lobe, pair_count)?;
        let weighed: Vec<[[f32; 4]; 2]> = gpu.read_buffer(&self.sums.buffer)?;
        let count = SCRAMBLE_COUNT as usize;
        Ok((0..count)
            .map(|k| {
                weighed
                    .iter()
                    .skip(k)
                    .step_by(count)
                    .map(|[high, _]| *high)
                    .collect()
            })
            .collect())
    }

    /// Adds these pairs of every scramble's net to the sums. Pair 0 resets them.
    fn integrate(&self, gpu: &Gpu, lobe: Lobe, pairs: Range<u32>) -> Result<Report, GpuError> {
        let Passes {
            shading,
            tables,
            gbuffer,
            ..
        } = self.passes;
        let [shader, _] = lobe.shaders(shading.brdf);
        let constants = lobe.specialization(gpu, &self.passes).words();
        let mut total = Report::default();
        // Setting up a pixel costs as much as a few samples: a dispatch takes as many pairs as it
        // may.
        let samples_per_band = u64::from(gbuffer.size[0] * GROUP_SIDE * SAMPLES_PER_PAIR);
        let step = (gpu.submission_samples() / samples_per_band)
            .clamp(1, u64::from(DISPATCH_SAMPLES_MAX / SAMPLES_PER_PAIR)) as u32;
        for first_pair in pairs.clone().step_by(step as usize) {
            let pair_count = step.min(pairs.end - first_pair);
            let samples = pair_count * SAMPLES_PER_PAIR;
            for part in self.sums.parts(gpu, gbuffer.size, samples) {
                let rest = [
                    Bind::Sample(&tables.environment, Sampler::TEXELS),
                    Bind::Read(&self.distribution.words),
                    self.sums.bind(part),
                    Bind::SampleMip(&tables.environment, Sampler::MAP, 0),
                    Bind::Uniform(&self.distribution.slots, 0..self.distribution.slots.size()),
                    Bind::Sample(&tables.dfg, TABLE),
                ];
                let binds = self.passes.binds(&rest);
                let params = ShadeParams {
                    first_pair,
                    pair_count,
                    seed: self.seed,
                    slot_count: self.distribution.slot_count,
                    ..self.passes.params(part.first_row)
                };
                total.add(gpu.submit_pass(lobe.pass_name(), |r| {
                    r.dispatch(&shader, &constants, &binds, &params.to_bytes(), part.groups)
                })?);
            }
        }
        Ok(total)
    }

    /// Adds the term of `pair_count` pairs to the image, and leaves each scramble's radiance in the
    /// sums.
    fn resolve(&self, gpu: &Gpu, lobe: Lobe, pair_count: u32) -> Result<Report, GpuError> {
        let Passes {
            shading,
            tables,
            gbuffer,
            radiance,
            ..
        } = self.passes;
        let [_, shader] = lobe.shaders(shading.brdf);
        let mut total = Report::default();
        for part in self.sums.parts(gpu, gbuffer.size, SCRAMBLE_COUNT) {
            let rest = [
                Bind::Sample(&tables.dfg, TABLE),
                self.sums.bind(part),
                Bind::ReadWrite(radiance),
                Bind::ReadWrite(self.squared_error),
            ];
            let binds = self.passes.binds(&rest);
            let push = ShadeParams {
                pair_count,
                ..self.passes.params(part.first_row)
            }
            .to_bytes();
            total.add(gpu.submit_pass(lobe.pass_name(), |r| {
                r.dispatch(
                    &shader,
                    &lobe.specialization(gpu, &self.passes).words(),
                    &binds,
                    &push,
                    part.groups,
                )
            })?);
        }
        Ok(total)
    }
}
