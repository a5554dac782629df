//! The renderer of a run, a trait so that runs can be tested without a device.

use crate::base::pixels::{Rgb8Image, RgbImage};
use crate::instrument::ladder::Attribution;
use crate::instrument::pipeline::{
    DeviceInfo, Frame, IntermediateImage, LightTables, Pipeline, PipelineError, RenderRequest,
    Selection, TimingSamples,
};
use crate::instrument::precompute::taps::TapCount;
use crate::instrument::tonemap::ToneCurve;

#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub struct RenderFault {
    pub message: String,
    /// The device is gone: only a new process may succeed.
    pub device_lost: bool,
    /// The request itself must be changed.
    pub is_input: bool,
}

/// What a renderer gives, or why it cannot.
pub type Served<T> = Result<T, RenderFault>;

pub trait Renderer {
    fn device(&self) -> DeviceInfo;
    /// Checks before any work whether a request can be served.
    fn check(&self, request: &RenderRequest) -> Served<()>;
    /// Whether the image of a request is cached.
    fn has_kept(&self, _: &RenderRequest) -> bool {
        false
    }
    fn render(&mut self, request: &RenderRequest) -> Served<Frame>;
    fn tonemap(&mut self, radiance: &RgbImage, curve: ToneCurve) -> Served<Rgb8Image>;
    /// The tables that light a surface, without levels of the environment wider than `width_max`
    /// texels.
    fn light_tables(
        &mut self,
        request: &RenderRequest,
        width_max: u32,
        counts: &[TapCount],
    ) -> Served<LightTables>;
    /// What lies between the scene and the image of a request, tables in
    /// [`Selection::fitted_size`].
    fn intermediate(
        &mut self,
        request: &RenderRequest,
        selection: Selection,
    ) -> Served<IntermediateImage>;
    /// The error on the scene `design` by steps, over all pixels and over bands of n·v, with
    /// `samples` per pixel.
    fn attributions(
        &mut self,
        request: &RenderRequest,
        samples: u32,
        bands: &[[f64; 2]],
    ) -> Served<Vec<Attribution>>;
    /// Times the passes of a frame, or of its tables: executions that do not count, then rounds.
    fn time(
        &mut self,
        request: &RenderRequest,
        of_tables: bool,
        counts: [u32; 2],
    ) -> Served<TimingSamples>;
    /// Warnings since the last call.
    fn take_warnings(&mut self) -> Vec<String>;
}

impl From<PipelineError> for RenderFault {
    fn from(error: PipelineError) -> Self {
        Self {
            message: error.to_string(),
            device_lost: error.is_transient(),
            is_input: error.is_input(),
        }
    }
}

impl Renderer for Pipeline {
    fn device(&self) -> DeviceInfo {
        Pipeline::device(self).clone()
    }

    fn check(&self, request: &RenderRequest) -> Served<()> {
        Ok(Pipeline::check(self, request)?)
    }

    fn has_kept(&self, request: &RenderRequest) -> bool {
        Pipeline::has_kept(self, request)
    }

    fn render(&mut self, request: &RenderRequest) -> Served<Frame> {
        Ok(Pipeline::render(self, request)?)
    }

    fn tonemap(&mut self, radiance: &RgbImage, curve: ToneCurve) -> Served<Rgb8Image> {
        Ok(Pipeline::tonemap(self, radiance, curve)?.0)
    }

    fn light_tables(
        &mut self,
        request: &RenderRequest,
        width_max: u32,
        counts: &[TapCount],
    ) -> Served<LightTables> {
        Ok(Pipeline::light_tables(self, request, width_max, counts)?)
    }

    fn intermediate(
        &mut self,
        request: &RenderRequest,
        selection: Selection,
    ) -> Served<IntermediateImage> {
        let size = selection.fitted_size(request);
        Ok(Pipeline::intermediate_of_size(
            self, request, selection, size,
        )?)
    }

    fn attributions(
        &mut self,
        request: &RenderRequest,
        samples: u32,
        bands: &[[f64; 2]],
    ) -> Served<Vec<Attribution>> {
        Ok(Pipeline::attributions(self, request, samples, bands)?)
    }

    fn time(
        &mut self,
        request: &RenderRequest,
        of_tables: bool,
        [warmup, rounds]: [u32; 2],
    ) -> Served<TimingSamples> {
        let samples = if of_tables {
            Pipeline::time_precompute(self, request, warmup, rounds)?
        } else {
            Pipeline::time(self, request, warmup, rounds)?
        };
        Ok(samples)
    }

    fn take_warnings(&mut self) -> Vec<String> {
        Pipeline::take_warnings(self)
    }
}
