//! The renderer as a run sees it, so that runs can be tested without a device.

use crate::ladder::Attribution;
use crate::pipeline::{
    DeviceInfo, Frame, LightTables, Pipeline, PipelineError, RenderRequest, SharedWork, TimingSamples,
};
use crate::pixels::{Rgb8Image, RgbImage};
use crate::tonemap::ToneCurve;

/// Why the renderer could not deliver.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub struct RenderFault {
    pub message: String,
    /// The device is gone: nothing more can be rendered in this process, but a new one may succeed.
    pub device_lost: bool,
    /// The request cannot be served whatever is tried: it must be changed.
    pub is_input: bool,
}

/// Renders, tone-maps and times.
pub trait Renderer {
    /// The device.
    fn device(&self) -> DeviceInfo;
    /// Whether a request can be served, as far as that can be told before any work.
    fn check(&self, request: &RenderRequest) -> Result<(), RenderFault>;
    /// Whether a cache holds the image of a request.
    fn has_kept(&self, _: &RenderRequest) -> bool {
        false
    }
    /// One radiance image.
    fn render(&mut self, request: &RenderRequest) -> Result<Frame, RenderFault>;
    /// The display image of a radiance image.
    fn tonemap(&mut self, radiance: &RgbImage, curve: ToneCurve) -> Result<Rgb8Image, RenderFault>;
    /// The tables that light a surface, without the levels of the environment that are wider than `width_max` texels.
    fn light_tables(&mut self, request: &RenderRequest, width_max: u32) -> Result<LightTables, RenderFault>;
    /// The error of a split sum on the scene `design` by steps, over all pixels and over bands of n·v; what is drawn takes `samples` a pixel.
    fn attributions(
        &mut self,
        request: &RenderRequest,
        samples: u32,
        bands: &[[f64; 2]],
    ) -> Result<Vec<Attribution>, RenderFault>;
    /// Times of the passes that run for every frame, or of those that make its tables; `warmup` executions come first and do not count.
    fn time(
        &mut self,
        request: &RenderRequest,
        of_tables: bool,
        warmup: u32,
        rounds: u32,
    ) -> Result<TimingSamples, RenderFault>;
    /// Host time in which the device worked or was waited for so far, ms.
    fn waited_ms(&self) -> f64;
    /// Work done once for several images so far, and the part of it that the disk had.
    fn shared_work(&self) -> SharedWork;
    /// Warnings since the last call. None is a fault of a cell.
    fn take_warnings(&mut self) -> Vec<String>;
}

impl From<PipelineError> for RenderFault {
    fn from(error: PipelineError) -> Self {
        Self { message: error.to_string(), device_lost: error.is_transient(), is_input: error.is_input() }
    }
}

impl Renderer for Pipeline {
    fn device(&self) -> DeviceInfo {
        Pipeline::device(self).clone()
    }

    fn check(&self, request: &RenderRequest) -> Result<(), RenderFault> {
        Ok(Pipeline::check(self, request)?)
    }

    fn has_kept(&self, request: &RenderRequest) -> bool {
        Pipeline::has_kept(self, request)
    }

    fn render(&mut self, request: &RenderRequest) -> Result<Frame, RenderFault> {
        Ok(Pipeline::render(self, request)?)
    }

    fn tonemap(&mut self, radiance: &RgbImage, curve: ToneCurve) -> Result<Rgb8Image, RenderFault> {
        Ok(Pipeline::tonemap(self, radiance, curve)?.0)
    }

    fn light_tables(&mut self, request: &RenderRequest, width_max: u32) -> Result<LightTables, RenderFault> {
        Ok(Pipeline::light_tables(self, request, width_max)?)
    }

    fn attributions(
        &mut self,
        request: &RenderRequest,
        samples: u32,
        bands: &[[f64; 2]],
    ) -> Result<Vec<Attribution>, RenderFault> {
        Ok(Pipeline::attributions(self, request, samples, bands)?)
    }

    fn time(
        &mut self,
        request: &RenderRequest,
        of_tables: bool,
        warmup: u32,
        rounds: u32,
    ) -> Result<TimingSamples, RenderFault> {
        Ok(match of_tables {
            true => Pipeline::time_precompute(self, request, warmup, rounds)?,
            false => Pipeline::time(self, request, warmup, rounds)?,
        })
    }

    fn waited_ms(&self) -> f64 {
        Pipeline::waited_ms(self)
    }

    fn shared_work(&self) -> SharedWork {
        Pipeline::shared_work(self).clone()
    }

    fn take_warnings(&mut self) -> Vec<String> {
        Pipeline::take_warnings(self)
    }
}
