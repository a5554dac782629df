//! Emission, added to the image-based terms of every method and of the reference.

use super::request::Frame;
use super::{Pipeline, PipelineError, RenderRequest};
use std::sync::Arc;

impl RenderRequest {
    /// Returns the request without emission.
    pub(super) fn dark(&self) -> Self {
        if !self.scene.has_emission() {
            return self.clone();
        }
        Self {
            scene: Arc::new(self.scene.dark()),
            ..self.clone()
        }
    }
}

impl Pipeline {
    /// Adds the emission of the request's scene to a frame without it.
    pub(super) fn with_emission(
        &mut self,
        request: &RenderRequest,
        mut frame: Frame,
    ) -> Result<Frame, PipelineError> {
        if !request.scene.has_emission() {
            return Ok(frame);
        }
        let emitting = RenderRequest {
            scene: Arc::new(request.scene.emission()),
            ..request.clone()
        };
        let (_, target) = self.resources.view(&self.gpu, &emitting)?;
        let emission = target.gbuffer.read(&self.gpu)?.albedo_metallic;
        let pixels = frame.radiance.data.iter_mut().zip(&frame.mask.data);
        for ((radiance, mask), emission) in pixels.zip(&emission.data) {
            if *mask == 1.0 {
                (0..3).for_each(|c| radiance[c] += emission[c]);
            }
        }
        Ok(frame)
    }
}
