//! Emission, added to the image-based terms of every method and of the reference.

use super::layers::{Composition, Mixture};
use super::picture::{DeviceMixture, DeviceRadiance, Weights};
use super::request::Frame;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::glsl::layout::LayerParams;
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

    /// Adds the emission of the scene to a composition without it.
    pub(super) fn emitting(&self, image: Composition) -> Composition {
        if self.scene.has_emission() {
            Composition::mixed(Emission(self.clone()), [image])
        } else {
            image
        }
    }
}

/// Adds the emission of a request's scene to its image.
struct Emission(RenderRequest);

impl Mixture for Emission {
    fn on_host(&self, pipeline: &mut Pipeline, frames: &[Frame]) -> Result<Frame, PipelineError> {
        let mut frame = frames[0].clone();
        let emitting = RenderRequest {
            scene: Arc::new(self.0.scene.emission()),
            ..self.0.clone()
        };
        let (_, target) = pipeline.resources.view(&pipeline.gpu, &emitting)?;
        let emission = target.gbuffer.read(&pipeline.gpu)?.albedo_metallic;
        let pixels = frame.radiance.data.iter_mut().zip(&frame.mask.data);
        for ((radiance, mask), emission) in pixels.zip(&emission.data) {
            if *mask == 1.0 {
                (0..3).for_each(|c| radiance[c] += emission[c]);
            }
        }
        Ok(frame)
    }

    fn on_device(
        &self,
        pipeline: &mut Pipeline,
        images: &[DeviceRadiance],
    ) -> Result<DeviceRadiance, PipelineError> {
        pipeline.mixed_on_device(&DeviceMixture {
            shader: "shade/layers/emission.comp",
            images: &[&images[0]],
            layer: &self.0.dark(),
            weights: Some(Weights::albedo(self.0.scene.emission())),
            lobe: None,
            params: LayerParams::default(),
        })
    }
}
