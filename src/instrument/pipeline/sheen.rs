//! Sheen: the base and the sheen, added with the shares of [`crate::instrument::shade::sheen`].

use super::layers::combined;
use super::request::Frame;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::names::Listed;
use crate::instrument::brdf::{
    Compensation, Fresnel, MaskingShadowing, SHEEN_ALPHA_MIN, SheenVisibility,
};
use crate::instrument::precompute::PrefilterBy;
use crate::instrument::precompute::given::Given;
use crate::instrument::precompute::prefilter::WEIGHTS;
use crate::instrument::shade::occlusion::SpecularOcclusion;
use crate::instrument::shade::sheen::{SheenMap, shares};
use crate::instrument::shade::{Diffuse, Method, NONE, Shading};
use glam::DVec3;
use std::sync::Arc;

/// The diffuse method of a sheen that reads irradiance, whose image has no other term.
const IRRADIANCE: &str = "irradiance-map";

impl RenderRequest {
    /// Returns the requests of the base and of the sheen, if a material has any.
    pub(super) fn sheen_layers(&self) -> Option<[Self; 2]> {
        if !self.scene.has_sheen() {
            return None;
        }
        let base = Self {
            scene: Arc::new(self.scene.without_sheen()),
            ..self.clone()
        };
        let mut sheen = Self {
            scene: Arc::new(self.scene.sheen()),
            background: false,
            ..self.clone()
        };
        sheen.shading.diffuse = Diffuse::listed(NONE);
        sheen.shading.compensation = Compensation::None;
        sheen.shading.fresnel = Fresnel::Schlick;
        // As wide as a diffuse term, whichever method looks it up.
        sheen.shading.specular_occlusion = SpecularOcclusion::Ao;
        sheen.choose_sheen_method();
        Some([base, sheen])
    }

    /// Sets the method of the sheen's image, and what that method reads.
    fn choose_sheen_method(&mut self) {
        let shading = &mut self.shading;
        if shading.method.is_none() {
            return;
        }
        if shading.method.is_integrated() {
            shading.method = Method::SHEEN;
            set_sheen_lobe(shading, shading.sheen_visibility);
            return;
        }
        match shading.sheen_lookup.map {
            SheenMap::Irradiance => {
                shading.method = Method::listed(NONE);
                shading.diffuse = Diffuse::listed(IRRADIANCE);
            }
            SheenMap::Levels => shading.method = Method::SHEEN_LOOKUP,
            SheenMap::Charlie => {
                shading.method = Method::SHEEN_LOOKUP;
                // Both visibilities have one D.
                set_sheen_lobe(shading, SheenVisibility::Charlie);
                shading.precompute.prefilter = PrefilterBy::Harmonic;
                shading.precompute.prefilter_weight = &WEIGHTS[0];
                self.given = Given::default();
            }
        }
    }
}

fn set_sheen_lobe(shading: &mut Shading, visibility: SheenVisibility) {
    shading.brdf = listed_visibility(visibility);
    shading.masking_shadowing = MaskingShadowing::Correlated;
}

/// Returns a visibility as a model that lives as long as the program.
fn listed_visibility(visibility: SheenVisibility) -> &'static SheenVisibility {
    SheenVisibility::listed(Listed::name(&visibility))
}

impl Pipeline {
    /// Renders the base and the sheen of `request`, and adds them.
    pub(super) fn render_sheened(
        &mut self,
        request: &RenderRequest,
        [base, sheen]: &[RenderRequest; 2],
    ) -> Result<Frame, PipelineError> {
        let Shading {
            sheen_visibility,
            sheen_lookup,
            method,
            ..
        } = request.shading;
        let under = self.render_layers(base)?;
        let over = self.render_occluded(sheen)?;
        let mut pixels = self.layer_pixels(sheen, &over, request.scene.sheen_colors())?;
        pixels
            .iter_mut()
            .for_each(|pixel| pixel.alpha = pixel.alpha.max(SHEEN_ALPHA_MIN));
        let lookup = method.has_pass().then_some(sheen_lookup);
        let pairs = self.layer_albedos(
            listed_visibility(sheen_visibility),
            MaskingShadowing::Correlated,
            &pixels,
        );
        let shares = pixels.iter().zip(pairs).map(|(pixel, pair)| {
            let shares = shares(
                lookup,
                pixel.weight,
                pixel.alpha,
                pixel.n_dot_v,
                pair.element_sum(),
            );
            [shares.base, shares.sheen]
        });
        let shares: Vec<[DVec3; 2]> = shares.collect();
        Ok(combined([&under, &over], &shares).after(over))
    }
}
