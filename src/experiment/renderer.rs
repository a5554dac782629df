//! What a run needs of a renderer, so that runs can be tested without a device.

use crate::pipeline::{DeviceInfo, Frame, RenderRequest};
use crate::pixels::{Rgb8Image, RgbImage};
use crate::tonemap::ToneCurve;

/// Why the renderer could not deliver.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub struct RenderFault {
    pub message: String,
    /// The device is gone: nothing more can be rendered in this process, but a new one may succeed.
    pub device_lost: bool,
}

/// Times of repeated executions, ms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimingSamples {
    /// One entry a pass, with one time a round.
    pub passes: Vec<(&'static str, Vec<f64>)>,
    /// Host time of each round, from submission to completion.
    pub wall_ms: Vec<f64>,
}

/// Renders, tone-maps and times.
pub trait Renderer {
    /// What it renders on.
    fn device(&self) -> DeviceInfo;
    /// One radiance image.
    fn render(&mut self, request: &RenderRequest) -> Result<Frame, RenderFault>;
    /// The display image of a radiance image.
    fn tonemap(&mut self, radiance: &RgbImage, curve: ToneCurve) -> Result<Rgb8Image, RenderFault>;
    /// Times of the passes that run for every frame; `warmup` executions come first and do not count.
    fn time(&mut self, request: &RenderRequest, warmup: u32, rounds: u32) -> Result<TimingSamples, RenderFault>;
    /// Times of the passes that run once per environment or model.
    fn time_precompute(
        &mut self,
        request: &RenderRequest,
        warmup: u32,
        rounds: u32,
    ) -> Result<TimingSamples, RenderFault>;
}
