//! Runs environment, precompute, gbuffer, shade and tonemap in this order.
//!
//! Tables, scenes and g-buffers are cached by their inputs: a sweep makes each once. With a
//! [`DiskCache`], tables and references are kept for later runs too.

mod antialias;
mod cache;
mod coat;
mod disk_cache;
mod fit;
pub mod frames;
mod inputs;
mod kept_reference;
mod ladder;
mod layers;
mod light_tables;
mod prepare;
mod request;
mod resources;

mod shared_work;
mod sheen;

pub use crate::instrument::gpu::{
    DeviceChoice, DeviceInfo, Options, PassTime, chosen_device, devices,
};
pub use cache::{CACHE_BYTES, Recent};
pub use disk_cache::{DiskCache, DiskCacheError, program_hash};
pub use fit::{BUFFER_BYTES_EVERYWHERE, BUFFER_BYTES_MAX, image_buffer_bytes};
pub use light_tables::LightTables;
pub use request::{Frame, FrameTimings, RenderRequest, Steadiness, TimingSamples};
pub use shared_work::SharedWork;

use crate::base::glsl::constants::POINTS_PER_DISPATCH;
use crate::base::pixels::{Pixels, Rgb8Image, RgbImage};
use crate::instrument::gbuffer;
use crate::instrument::gpu::{Buffer, Gpu, GpuError, Report};
use crate::instrument::precompute::SettingsError;
use crate::instrument::shade::Method;
use crate::instrument::shade::pass::Passes;
use crate::instrument::shade::reference_pass::{Convergence, PartPair, ReferenceRun};
use crate::instrument::tonemap::{self, ToneCurve};
use kept_reference::Reference;
use resources::{Prepared, ReferenceData, Resources, Shelves};
use shared_work::Kept;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

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
            | Self::Settings(_) => true,
            Self::InvalidRadiance { method, .. } => method.text.is_some(),
            Self::Gpu(_) => false,
        }
    }

    /// Whether [`Pipeline::interrupt_by`] stopped the work.
    pub fn is_interrupted(&self) -> bool {
        matches!(self, Self::Gpu(GpuError::Interrupted))
    }

    /// Whether a retry on a fresh device may succeed.
    pub fn is_transient(&self) -> bool {
        matches!(self, Self::Gpu(error) if error.is_transient())
    }
}

/// Returns whether a cache with its device set holds what `request` would render: then nothing is
/// rendered.
pub fn is_kept(cache: &DiskCache, request: &RenderRequest) -> bool {
    let is_kept = |layer| {
        kept_reference::key(layer).is_some_and(|key| cache.holds(&key.shaders, &key.text()))
    };
    request.layers().iter().all(is_kept)
}

/// Lists the shaders that a reference on disk depends on; `None` if frames of `request` are not
/// kept.
pub fn shaders_of_kept(request: &RenderRequest) -> Option<Vec<String>> {
    let keys = request
        .layers()
        .iter()
        .map(kept_reference::key)
        .collect::<Option<Vec<_>>>()?;
    Some(keys.into_iter().flat_map(|key| key.shaders).collect())
}

pub struct Pipeline {
    gpu: Gpu,
    resources: Resources,
    kept: Kept,
}

impl Pipeline {
    pub fn new(options: Options) -> Result<Self, PipelineError> {
        Self::on(Gpu::new(options)?)
    }

    /// Wraps an open device, which may be shared: shaders compiled by one user are compiled for
    /// all.
    pub fn on(gpu: Gpu) -> Result<Self, PipelineError> {
        Ok(Self {
            resources: Resources::new(&gpu)?,
            kept: Kept::default(),
            gpu,
        })
    }

    pub fn device(&self) -> &DeviceInfo {
        self.gpu.info()
    }

    /// Takes tables and references from `cache` if it has them, and stores new ones. Timed passes
    /// never use it.
    pub fn keep_on_disk(&mut self, mut cache: DiskCache) {
        cache.set_device(self.gpu.info());
        self.kept.disk = Some(cache);
    }

    /// Returns whether the cache holds what `request` would render.
    pub fn has_kept(&self, request: &RenderRequest) -> bool {
        self.kept
            .disk
            .as_ref()
            .is_some_and(|cache| is_kept(cache, request))
    }

    /// Counts the shared results so far; timing rounds do not count.
    pub fn shared_work(&self) -> &SharedWork {
        &self.kept.work
    }

    /// Returns warnings of the cache since the last call; they concern no frame.
    pub fn take_warnings(&mut self) -> Vec<String> {
        self.kept
            .disk
            .as_mut()
            .map(DiskCache::take_warnings)
            .unwrap_or_default()
    }

    /// Makes work fail while `flag` is set ([`PipelineError::is_interrupted`]). `None` removes the
    /// flag.
    pub fn interrupt_by(&self, flag: Option<Arc<AtomicBool>>) {
        self.gpu.interrupt_by(flag);
    }

    /// Returns the messages of the validation layer so far; empty without validation.
    pub fn validation_messages(&self) -> Vec<String> {
        self.gpu.validation_messages()
    }

    /// Checks whether the device can serve `request`, as far as possible before anything is
    /// allocated.
    pub fn check(&self, request: &RenderRequest) -> Result<(), PipelineError> {
        fit::check(&self.gpu, request)?;
        if request.is_antialiased() {
            fit::check(&self.gpu, &request.points_of_pixels())
        } else {
            Ok(())
        }
    }

    fn prepare(&mut self, request: &RenderRequest) -> Result<Prepared, PipelineError> {
        self.check(request)?;
        self.resources.prepare(&self.gpu, &mut self.kept, request)
    }

    /// Does `work`. If memory runs out, frees all cached results and tries once more.
    fn with_memory<T>(
        &mut self,
        mut work: impl FnMut(&mut Self) -> Result<T, PipelineError>,
    ) -> Result<T, PipelineError> {
        match work(self) {
            Err(PipelineError::Gpu(error)) if error.is_out_of_memory() => {
                self.resources.forget_all();
                work(self)
            }
            result => result,
        }
    }

    /// Renders one radiance image, or the last one of a sequence.
    pub fn render(&mut self, request: &RenderRequest) -> Result<Frame, PipelineError> {
        if request.is_sequence() {
            return self.render_frames(request);
        }
        let frame = self.render_layers(request)?;
        if !request.is_antialiased() {
            return Ok(frame);
        }
        let edges =
            self.with_memory(|pipeline| pipeline.resources.edges(&pipeline.gpu, request))?;
        Ok(edges.resolve(frame))
    }

    /// [`Pipeline::render`] without antialiasing.
    fn render_points(&mut self, request: &RenderRequest) -> Result<Frame, PipelineError> {
        let Some(key) = kept_reference::key(request) else {
            return Ok(self.with_memory(|pipeline| pipeline.rendered(request))?.0);
        };
        self.check(request)?;
        let kept = self
            .kept
            .load(&key)
            .and_then(|bytes| Reference::from_bytes(&bytes, request.size));
        if let Some(Reference {
            radiance,
            standard_error,
            convergences,
        }) = kept
        {
            let (_, target) = self.resources.view(&self.gpu, request)?;
            let (mask, n_dot_v) = (target.mask.clone(), target.n_dot_v.clone());
            return Ok(Frame {
                radiance,
                standard_error,
                convergences,
                mask,
                n_dot_v,
                steadiness: None,
                timings: FrameTimings::default(),
            });
        }
        let (frame, shaders) = self.with_memory(|pipeline| pipeline.rendered(request))?;
        key.assert_names(&shaders);
        self.kept.store(&key, || {
            let (radiance, standard_error) = (frame.radiance.clone(), frame.standard_error.clone());
            Ok(Reference {
                radiance,
                standard_error,
                convergences: frame.convergences.clone(),
            }
            .to_bytes())
        })?;
        Ok(frame)
    }

    /// Renders a frame; also returns the shaders that ran for it, without the shaders of its
    /// tables.
    fn rendered(
        &mut self,
        request: &RenderRequest,
    ) -> Result<(Frame, BTreeSet<String>), PipelineError> {
        let prepared = self.prepare(request)?;
        let (report, convergences) = self.shade(request, &prepared)?;
        let (radiance, standard_error) = read_radiance(&self.gpu, &prepared, request)?;
        let frame = Frame {
            radiance,
            standard_error,
            convergences,
            mask: prepared.target.mask.clone(),
            n_dot_v: prepared.target.n_dot_v.clone(),
            steadiness: None,
            timings: FrameTimings {
                precompute: prepared.precompute.passes,
                frame: report.passes,
                wall_ms: report.wall_ms,
            },
        };
        Ok((frame, report.shaders))
    }

    /// Applies the tone curve on the device.
    pub fn tonemap(
        &mut self,
        radiance: &RgbImage,
        curve: ToneCurve,
    ) -> Result<(Rgb8Image, PassTime), PipelineError> {
        let size = [radiance.width, radiance.height];
        let texels: Vec<[f32; 4]> = radiance
            .data
            .iter()
            .map(|&[r, g, b]| [r, g, b, 0.0])
            .collect();
        self.with_memory(|pipeline| {
            let radiance = pipeline.gpu.buffer_from("radiance", &texels)?;
            let packed = tonemap::pass::packed(&pipeline.gpu, size)?;
            let report = tonemap::pass::run(&pipeline.gpu, curve, &radiance, &packed, size)?;
            let time = report.passes.into_iter().next().unwrap_or(PassTime {
                pass: "tonemap",
                ms: 0.0,
            });
            Ok((tonemap::pass::read(&pipeline.gpu, &packed, size)?, time))
        })
    }

    /// Times the passes of a frame, tone curve included: `warmup` rounds that do not count, then
    /// `rounds`. Of a sequence it times one frame.
    pub fn time(
        &mut self,
        request: &RenderRequest,
        warmup: u32,
        rounds: u32,
    ) -> Result<TimingSamples, PipelineError> {
        let layers = if request.is_sequence() {
            request.of_frame(0).layers()
        } else {
            request.layers()
        };
        let prepared = layers
            .iter()
            .map(|layer| self.prepare(layer))
            .collect::<Result<Vec<_>, _>>()?;
        let packed = tonemap::pass::packed(&self.gpu, request.size)?;
        let (curve, radiance) = (ToneCurve::default(), &prepared[0].target.radiance);
        let mut samples = TimingSamples::default();
        for round in 0..warmup + rounds {
            let mut report = Report::default();
            for (layer, prepared) in layers.iter().zip(&prepared) {
                report.add(self.shade(layer, prepared)?.0);
            }
            report.add(tonemap::pass::run(
                &self.gpu,
                curve,
                radiance,
                &packed,
                request.size,
            )?);
            if round >= warmup {
                samples.push(&report.passes, report.wall_ms);
            }
        }
        Ok(samples)
    }

    /// Times the precompute passes of `request`. Each round makes all tables again, but those that
    /// no pass makes (taps).
    pub fn time_precompute(
        &mut self,
        request: &RenderRequest,
        warmup: u32,
        rounds: u32,
    ) -> Result<TimingSamples, PipelineError> {
        let mut samples = TimingSamples::default();
        for round in 0..warmup + rounds {
            let tap_tables =
                std::mem::replace(&mut self.resources.tables, Shelves::new()).tap_tables;
            self.resources.tables.tap_tables = tap_tables;
            self.check(request)?;
            let report = self
                .resources
                .prepare(&self.gpu, &mut Kept::default(), request)?
                .precompute;
            if round >= warmup {
                samples.push(&report.passes, report.wall_ms);
            }
        }
        Ok(samples)
    }

    /// Runs the g-buffer and every shading pass; the radiance stays in the target.
    fn shade(
        &mut self,
        request: &RenderRequest,
        prepared: &Prepared,
    ) -> Result<(Report, Vec<Convergence>), PipelineError> {
        let (Prepared { tables, target, .. }, gpu) = (prepared, &self.gpu);
        let passes = passes(request, prepared);
        let mut recorder = gpu.record("gbuffer")?;
        // For the scene `design` the host wrote the g-buffer.
        if !request.scene.is_design {
            recorder.pass("gbuffer", |r| {
                gbuffer::pass::record(r, &prepared.scene, passes.camera, passes.gbuffer)
            })?;
        }
        recorder.fill(passes.radiance, 0);
        let mut report = recorder.submit()?;

        if request.shading.method.has_pass() {
            let points_per_dispatch = prepared.samples_per_pixel.min(POINTS_PER_DISPATCH);
            for part in gpu.parts(request.size, 1, points_per_dispatch.into()) {
                for points in tables.points.ranges() {
                    report.add(
                        gpu.submit_pass("shade-specular", |r| passes.specular(r, points, part))?,
                    );
                }
            }
        }
        let mut convergences = Vec::new();
        if let Some(ReferenceData {
            distribution,
            sums,
            squared_error,
        }) = &prepared.reference
        {
            let mut recorder = gpu.record("reference")?;
            recorder.fill(squared_error, 0);
            report.add(recorder.submit()?);
            let (stop, seed, mask) = (request.reference_stop(), request.seed, &*target.mask);
            let epsilon = request.epsilon();
            let run = ReferenceRun {
                passes,
                stop,
                epsilon,
                seed,
                mask,
                distribution,
                sums,
                squared_error,
            };
            for lobe in &prepared.lobes {
                let (times, convergence) = run.run(gpu, *lobe)?;
                report.add(times);
                convergences.push(convergence);
            }
        }
        for part in gpu.parts(request.size, 1, 1) {
            let mut recorder = gpu.record("shade")?;
            if request.shading.diffuse.has_pass() {
                recorder.pass("shade-diffuse", |r| passes.diffuse(r, part))?;
            }
            if request.background {
                recorder.pass("background", |r| passes.background(r, part))?;
            }
            report.add(recorder.submit()?);
        }
        Ok((report, convergences))
    }
}

fn passes<'a>(request: &'a RenderRequest, prepared: &'a Prepared) -> Passes<'a> {
    let Prepared { tables, target, .. } = prepared;
    Passes {
        shading: &request.shading,
        camera: &request.camera,
        tables,
        gbuffer: &target.gbuffer,
        tangents: prepared.tangents.as_ref().map(|target| &target.gbuffer),
        radiance: &target.radiance,
    }
}

fn read_radiance(
    gpu: &Gpu,
    prepared: &Prepared,
    request: &RenderRequest,
) -> Result<(RgbImage, Option<RgbImage>), PipelineError> {
    let [width, height] = request.size;
    let read = |buffer: &Buffer| -> Result<RgbImage, PipelineError> {
        let texels: Vec<[f32; 4]> = gpu.read_buffer(buffer)?;
        Ok(Pixels::new(
            width,
            height,
            texels.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
        ))
    };
    let radiance = read(&prepared.target.radiance)?;
    let invalid = |texel: &[f32; 3]| texel.iter().any(|x| !x.is_finite() || *x < 0.0);
    if let Some(index) = radiance.data.iter().position(invalid) {
        return Err(PipelineError::InvalidRadiance {
            method: request.shading.method,
            count: radiance.data.iter().filter(|texel| invalid(texel)).count(),
            x: index as u32 % width,
            y: index as u32 / width,
            value: radiance.data[index],
        });
    }
    let root = |image: RgbImage| image.map(|texel| texel.map(f32::sqrt));
    let squared_error = prepared
        .reference
        .as_ref()
        .map(|reference| read(&reference.squared_error))
        .transpose()?;
    Ok((radiance, squared_error.map(root)))
}
