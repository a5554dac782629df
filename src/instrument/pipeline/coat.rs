//! Clear coat: the base and the coat, added with the shares of [`crate::instrument::shade::coat`].

use super::layers::combined;
use super::request::Frame;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::names::Listed;
use crate::instrument::brdf::{Compensation, Fresnel};
use crate::instrument::shade::coat::{CoatWeight, shares};
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

impl Pipeline {
    /// Renders the base and the coat of `request`, and adds them.
    pub(super) fn render_coated(
        &mut self,
        request: &RenderRequest,
        [base, coat]: &[RenderRequest; 2],
    ) -> Result<Frame, PipelineError> {
        let Shading {
            coat_layering,
            coat_renderer,
            brdf,
            masking_shadowing,
            ..
        } = request.shading;
        let whole = self.render_layers(base)?;
        let is_split = coat_renderer.specular_power != coat_renderer.diffuse_power
            && !request.shading.diffuse.is_none();
        // Emission is attenuated as the diffuse term.
        let specular_only = base
            .dark()
            .shaded(|shading| shading.diffuse = Diffuse::listed(NONE));
        let specular = if is_split {
            Some(self.render_layers(&specular_only)?)
        } else {
            None
        };
        let over = self.render_occluded(coat)?;
        let pixels = self.layer_pixels(coat, &over, request.scene.coat_weights())?;
        let needs_pair =
            coat_renderer.lookup.is_some() || coat_layering.loss() == CoatWeight::Albedo;
        let pairs = if needs_pair {
            self.layer_albedos(brdf, masking_shadowing, &pixels)
        } else {
            vec![DVec2::X; pixels.len()]
        };
        let frame_shares = pixels.iter().zip(pairs).map(|(pixel, pair)| {
            let pair = if pixel.is_hit { pair } else { DVec2::X };
            let shares = shares(
                coat_layering,
                coat_renderer,
                pixel.weight.x,
                pixel.n_dot_v,
                pair,
            );
            // The diffuse term is what `whole` has beyond `specular`.
            [
                shares.base_diffuse,
                shares.base_specular - shares.base_diffuse,
                shares.coat,
            ]
            .map(DVec3::splat)
        });
        let frame_shares: Vec<[DVec3; 3]> = frame_shares.collect();
        Ok(combined(
            [&whole, specular.as_ref().unwrap_or(&whole), &over],
            &frame_shares,
        )
        .after(over))
    }
}
