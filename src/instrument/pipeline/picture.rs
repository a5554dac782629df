//! Pictures that never leave the device, for a window on the same device.

use super::{Pipeline, PipelineError, RenderRequest};
use crate::instrument::gpu::Buffer;
use crate::instrument::tonemap::{self, ToneCurve};

/// A tone-mapped image on the device.
pub struct DevicePicture {
    /// A word a pixel, R in the lowest byte.
    pub words: Buffer,
    /// Whether a table was made for it.
    pub has_made_table: bool,
}

impl RenderRequest {
    /// Whether the passes of one layer make the whole image: the host adds others.
    fn is_one_layer(&self) -> bool {
        let is_added_to = self.is_sequence()
            || self.is_antialiased()
            || self.scene.has_lights()
            || self.scene.has_emission()
            || self.occlusion_layers().is_some();
        !is_added_to && self.layers().len() == 1
    }
}

impl Pipeline {
    /// Renders and tone-maps a picture; `None` if the host puts its layers together. Does not check
    /// whether radiance is negative or not finite: [`Pipeline::render`] does.
    pub fn picture_on_device(
        &mut self,
        request: &RenderRequest,
        curve: ToneCurve,
    ) -> Result<Option<DevicePicture>, PipelineError> {
        if !request.is_one_layer() {
            return Ok(None);
        }
        let picture = self.with_memory(|pipeline| {
            let prepared = pipeline.prepare(request)?;
            pipeline.shade(request, &prepared, &[])?;
            let gpu = &pipeline.gpu;
            let radiance = &prepared.target.radiance;
            let words = tonemap::pass::packed(gpu, request.size)?;
            tonemap::pass::run(gpu, curve, radiance, &words, request.size)?;
            Ok(DevicePicture {
                words,
                has_made_table: !prepared.precompute.passes.is_empty(),
            })
        })?;
        Ok(Some(picture))
    }
}
