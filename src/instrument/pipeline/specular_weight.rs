//! Dielectrics that reflect a share w of their interface (`KHR_materials_specular`): w times the
//! image with the whole interface, and 1 - w times the image without a specular term. Fresnel's term
//! is linear in both, so this is the model itself, for every method and the reference.

use super::layers::{Composition, Mixture, combined};
use super::picture::{DeviceMixture, DeviceRadiance, Weights};
use super::request::Frame;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::glsl::layout::LayerParams;
use crate::base::names::Listed;
use crate::instrument::brdf::Compensation;
use crate::instrument::scene::Scene;
use crate::instrument::shade::{Diffuse, Method, NONE, REFERENCE};
use glam::DVec3;
use std::sync::Arc;

/// The diffuse method that loses light to Fresnel also without a specular term.
const FRESNEL_INSIDE: &str = "fresnel-inside";

impl RenderRequest {
    /// Returns the requests with the whole interface and without one, if a material reflects less.
    pub(super) fn specular_layers(&self) -> Option<[Self; 2]> {
        if !self.scene.has_specular_weight() || self.shading.method.is_none() {
            return None;
        }
        let without = self.shaded(|shading| {
            shading.method = Method::listed(NONE);
            shading.compensation = Compensation::None;
            if shading.diffuse.name == FRESNEL_INSIDE {
                shading.diffuse = Diffuse::listed(REFERENCE);
            }
        });
        Some([self.clone(), without])
    }

    /// Returns the composition of the base.
    pub(super) fn base(&self) -> Composition {
        match self.specular_layers() {
            Some(layers) => {
                let parts = layers.map(|layer| layer.occluded());
                Composition::mixed(Interface(self.clone()), parts)
            }
            None => self.occluded(),
        }
    }
}

/// Mixes the images with the whole interface and without one.
struct Interface(RenderRequest);

impl Mixture for Interface {
    fn on_host(&self, pipeline: &mut Pipeline, frames: &[Frame]) -> Result<Frame, PipelineError> {
        let whole = &frames[0];
        let mut without = frames[1].clone();
        if without.standard_error.is_none() {
            // No term of it is a reference: it is exact.
            let errors = whole.standard_error.as_ref();
            without.standard_error = errors.map(|errors| errors.map(|_| [0.0; 3]));
        }
        let weights = pipeline.interface_weights(&self.0, self.0.scene.specular_weights())?;
        let shares: Vec<[DVec3; 2]> = weights
            .into_iter()
            .map(|weight| [weight, 1.0 - weight].map(DVec3::splat))
            .collect();
        Ok(combined([whole, &without], &shares))
    }

    fn on_device(
        &self,
        pipeline: &mut Pipeline,
        images: &[DeviceRadiance],
    ) -> Result<DeviceRadiance, PipelineError> {
        pipeline.mixed_on_device(&DeviceMixture {
            shader: "shade/layers/interface.comp",
            images: &[&images[0], &images[1]],
            layer: &self.0,
            weights: Some(Weights::f0(self.0.scene.specular_weights())),
            lobe: None,
            params: LayerParams::default(),
        })
    }
}

impl Pipeline {
    /// Reads the share of the interface at each pixel; 1 off the surfaces, whose background stays.
    fn interface_weights(
        &mut self,
        request: &RenderRequest,
        weights: Scene,
    ) -> Result<Vec<f64>, PipelineError> {
        let weights = RenderRequest {
            scene: Arc::new(weights),
            ..request.clone()
        };
        let (_, target) = self.resources.view(&self.gpu, &weights)?;
        let gbuffer = target.gbuffer.read(&self.gpu)?;
        let pixels = gbuffer
            .f0_material
            .data
            .iter()
            .zip(&gbuffer.position_mask.data);
        let weight = |(f0, position): (&[f32; 4], &[f32; 4])| {
            if position[3] == 0.0 {
                1.0
            } else {
                f64::from(f0[0])
            }
        };
        Ok(pixels.map(weight).collect())
    }
}
