//! Clear coat: the base and the coat, added with the shares of [`crate::instrument::shade::coat`].

use super::layers::{Composition, Mixture, combined};
use super::picture::{DeviceMixture, DeviceRadiance, LayerLobe, Weights};
use super::request::Frame;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::glsl::layout::LayerParams;
use crate::base::names::Listed;
use crate::instrument::brdf::{Compensation, Fresnel};
use crate::instrument::shade::coat::CoatLaw;
use crate::instrument::shade::{Diffuse, Method, NONE, Shading};
use glam::{DVec2, DVec3};
use std::sync::Arc;

impl RenderRequest {
    /// Returns the requests of the base and of the coat, if a material has one.
    pub(super) fn coat_layers(&self) -> Option<[Self; 2]> {
        if !self.scene.has_coat() {
            return None;
        }
        let Shading {
            coat_layering,
            coat_renderer,
            method,
            ..
        } = self.shading;
        let base = Self {
            scene: Arc::new(self.scene.below_coat(coat_renderer.base)),
            ..self.clone()
        };
        let f0 = if coat_renderer.lookup.is_none() {
            coat_layering.f0()
        } else {
            1.0
        };
        let scene = Arc::new(self.scene.coat(f0 as f32, coat_renderer.alpha));
        let lookup = coat_renderer
            .lookup
            .filter(|_| method.has_pass())
            .map(Method::listed);
        let shading = Shading {
            method: lookup.unwrap_or(method),
            diffuse: Diffuse::listed(NONE),
            compensation: Compensation::None,
            // The coat has F at n.v, and F0 of its own.
            fresnel: Fresnel::Schlick,
            ..self.shading
        };
        Some([
            base,
            Self {
                scene,
                shading,
                background: false,
                ..self.clone()
            },
        ])
    }
}

/// A coat over its base: the base, its specular term alone if the terms lose unequal parts, and the
/// coat.
struct CoatMixture {
    request: RenderRequest,
    coat: RenderRequest,
    law: CoatLaw,
    is_split: bool,
}

impl RenderRequest {
    /// Returns the composition of the base and the coat.
    pub(super) fn coated(&self, [base, coat]: [Self; 2]) -> Composition {
        let law = CoatLaw::new(self.shading.coat_layering, self.shading.coat_renderer);
        let is_split = law.specular_power != law.diffuse_power && !self.shading.diffuse.is_none();
        let mut parts = vec![base.composition()];
        if is_split {
            // Emission is attenuated as the diffuse term.
            let specular_only = base
                .dark()
                .shaded(|shading| shading.diffuse = Diffuse::listed(NONE));
            parts.push(Composition::Again(Box::new(specular_only.composition())));
        }
        parts.push(coat.occluded());
        let mixture = CoatMixture {
            request: self.clone(),
            coat,
            law,
            is_split,
        };
        Composition::mixed(mixture, parts)
    }
}

impl Mixture for CoatMixture {
    fn on_host(&self, pipeline: &mut Pipeline, frames: &[Frame]) -> Result<Frame, PipelineError> {
        let Self {
            request,
            coat,
            law,
            is_split,
        } = self;
        let whole = &frames[0];
        let specular = if *is_split { &frames[1] } else { whole };
        let over = &frames[frames.len() - 1];
        let pixels = pipeline.layer_pixels(coat, over, request.scene.coat_weights())?;
        let Shading {
            brdf,
            masking_shadowing,
            ..
        } = request.shading;
        let pairs = if law.needs_pair() {
            pipeline.layer_albedos(brdf, masking_shadowing, &pixels)
        } else {
            vec![DVec2::X; pixels.len()]
        };
        let frame_shares = pixels.iter().zip(pairs).map(|(pixel, pair)| {
            let pair = if pixel.is_hit { pair } else { DVec2::X };
            let shares = law.shares(pixel.weight.x, pixel.n_dot_v, pair);
            // The diffuse term is what `whole` has beyond `specular`.
            [
                shares.base_diffuse,
                shares.base_specular - shares.base_diffuse,
                shares.coat,
            ]
            .map(DVec3::splat)
        });
        let frame_shares: Vec<[DVec3; 3]> = frame_shares.collect();
        Ok(combined([whole, specular, over], &frame_shares))
    }

    fn on_device(
        &self,
        pipeline: &mut Pipeline,
        images: &[DeviceRadiance],
    ) -> Result<DeviceRadiance, PipelineError> {
        let Self {
            request,
            coat,
            law,
            is_split,
        } = self;
        let [whole, over] = [&images[0], &images[images.len() - 1]];
        let specular = if *is_split { &images[1] } else { whole };
        let Shading {
            brdf,
            masking_shadowing,
            ..
        } = request.shading;
        let lobe = LayerLobe {
            model: brdf,
            masking: masking_shadowing,
            alpha_min: 0.0,
        };
        pipeline.mixed_on_device(&DeviceMixture {
            shader: "shade/layers/coat.comp",
            images: &[whole, specular, over],
            layer: coat,
            weights: Some(Weights::albedo(request.scene.coat_weights())),
            lobe: law.needs_pair().then_some(lobe),
            params: LayerParams {
                scale: law.scale as u32,
                loss: law.loss as u32,
                is_lookup: law.is_lookup.into(),
                specular_power: law.specular_power,
                diffuse_power: law.diffuse_power,
                ..LayerParams::default()
            },
        })
    }
}
