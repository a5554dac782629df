//! Runs environment, precompute, gbuffer, shade and tonemap in this order.
//!
//! Tables, scenes and g-buffers are cached by their inputs: a sweep makes each once. With a
//! [`DiskCache`], tables and references are kept for later runs too.

mod antialias;
mod cache;
mod coat;
mod disk_cache;
mod emission;
mod error;
mod fit;
pub mod frames;
mod inputs;
mod intermediate;
mod kept_reference;
mod ladder;
mod layers;
mod light_tables;
mod lights;
mod made_tables;
mod occlusion;
mod passes;
mod picture;
mod prepare;
pub mod reprojection;
mod request;
mod resources;
mod shared_work;
mod sheen;
mod specular_weight;
mod timing;

pub use crate::instrument::gpu::{
    DeviceChoice, DeviceInfo, Options, PassTime, chosen_device, devices,
};
pub use cache::{CACHE_BYTES, Recent};
pub use disk_cache::{DiskCache, DiskCacheError, program_hash};
pub use error::PipelineError;
pub use fit::{BUFFER_BYTES_EVERYWHERE, BUFFER_BYTES_MAX, image_buffer_bytes};
pub use intermediate::{Encoding, Extent, Intermediate, IntermediateImage, Selection};
pub use light_tables::LightTables;
pub use picture::{DevicePicture, DeviceRadiance};
pub use request::{Frame, FrameTimings, Illumination, RenderRequest, Steadiness, TimingSamples};
pub use shared_work::SharedWork;

use crate::base::pixels::{Rgb8Image, RgbImage};
use crate::instrument::gpu::{Buffer, Gpu, Report};
use crate::instrument::shade::reference_pass::{Convergence, Drawn};
use crate::instrument::tonemap::{self, ToneCurve};
use kept_reference::Reference;
use passes::{RadianceImages, Shaded, read_radiance};
use resources::{Coverage, Prepared, Resources};
use shared_work::Kept;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

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
    /// The last reference, to be continued with more samples.
    begun: Option<Begun>,
}

/// The sums of a reference that was rendered.
struct Begun {
    /// [`kept_reference::rounds_key`] of its request.
    key: String,
    drawn: Vec<Drawn>,
}

/// Most memory of sums that wait to be continued, bytes.
const BEGUN_BYTES: usize = 64 << 20;

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
            begun: None,
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
        fit::check(&self.gpu, request)
    }

    fn prepare(&mut self, request: &RenderRequest) -> Result<Prepared, PipelineError> {
        self.check(request)?;
        self.resources.prepare(&self.gpu, &mut self.kept, request)
    }

    /// Calls `work`. If memory runs out, frees all cached results and tries once more.
    fn with_memory<T>(
        &mut self,
        mut work: impl FnMut(&mut Self) -> Result<T, PipelineError>,
    ) -> Result<T, PipelineError> {
        match work(self) {
            Err(PipelineError::Gpu(error)) if error.is_out_of_memory() => {
                self.resources.forget_all();
                self.begun = None;
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
        let frame = self.composed(&request.composition())?;
        if !request.is_antialiased() {
            return Ok(frame);
        }
        let edges =
            self.with_memory(|pipeline| pipeline.resources.edges(&pipeline.gpu, request))?;
        Ok(edges.resolve(frame))
    }

    /// [`Pipeline::render`] without antialiasing.
    fn render_points(&mut self, request: &RenderRequest) -> Result<Frame, PipelineError> {
        if let Illumination::Lights(lights) = &request.illumination {
            return self.render_under_lights(request, lights);
        }
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
            let Coverage { mask, n_dot_v } = target.coverage(&self.gpu)?;
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
            Ok(Reference {
                radiance: frame.radiance.clone(),
                standard_error: frame.standard_error.clone(),
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
        let key = kept_reference::rounds_key(request);
        let is_same = |begun: &Begun| key.as_ref() == Some(&begun.key);
        let begun = self.begun.as_ref().filter(|begun| is_same(begun));
        let Shaded {
            report,
            convergences,
            drawn,
        } = self.shade(request, &prepared, begun.map_or(&[], |begun| &begun.drawn))?;
        if let Some(key) = key {
            let bytes: usize = drawn.iter().map(Drawn::bytes).sum();
            self.begun = (bytes <= BEGUN_BYTES).then_some(Begun { key, drawn });
        }
        let frame = self.read_frame(request, prepared, &report, convergences)?;
        Ok((frame, report.shaders))
    }

    /// Reads what the passes of a request left in its target.
    fn read_frame(
        &self,
        request: &RenderRequest,
        prepared: Prepared,
        report: &Report,
        convergences: Vec<Convergence>,
    ) -> Result<Frame, PipelineError> {
        let RadianceImages {
            radiance,
            standard_error,
        } = read_radiance(&self.gpu, &prepared, request)?;
        let Coverage { mask, n_dot_v } = prepared.target.coverage(&self.gpu)?;
        Ok(Frame {
            radiance,
            standard_error,
            convergences,
            mask,
            n_dot_v,
            steadiness: None,
            timings: FrameTimings {
                precompute: prepared.precompute.passes,
                frame: report.passes.clone(),
                wall_ms: report.wall_ms,
            },
        })
    }

    /// Applies the tone curve on the device.
    pub fn tonemap(
        &mut self,
        radiance: &RgbImage,
        curve: ToneCurve,
    ) -> Result<(Rgb8Image, PassTime), PipelineError> {
        let (packed, time) = self.tonemap_on_device(radiance, curve)?;
        let size = [radiance.width, radiance.height];
        let image =
            self.with_memory(|pipeline| Ok(tonemap::pass::read(&pipeline.gpu, &packed, size)?))?;
        Ok((image, time))
    }

    /// Applies the tone curve; the result stays on the device, a word a pixel with R in the lowest
    /// byte.
    pub fn tonemap_on_device(
        &mut self,
        radiance: &RgbImage,
        curve: ToneCurve,
    ) -> Result<(Buffer, PassTime), PipelineError> {
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
            Ok((packed, time))
        })
    }
}
