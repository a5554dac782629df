//! Sheen: the base and the sheen, added with the shares of [`crate::instrument::shade::sheen`].

use super::layers::combined;
use super::request::Frame;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::names::Listed;
use crate::instrument::brdf::{
    Brdf, Compensation, MaskingShadowing, SHEEN_ALPHA_MIN, SheenVisibility,
};
use crate::instrument::precompute::PrefilterBy;
use crate::instrument::precompute::given::Given;
use crate::instrument::precompute::prefilter::WEIGHTS;
use crate::instrument::shade::sheen::{SheenMap, shares};
use crate::instrument::shade::{Diffuse, Method, NONE, Shading};
use std::sync::Arc;

/// The image of the sheen that reads irradiance has it as its only term.
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
        let (mut shading, mut given) = (self.shading, self.given.clone());
        (shading.diffuse, shading.compensation) = (Diffuse::listed(NONE), Compensation::None);
        let lobe = |visibility| {
            (
                visible(visibility) as &'static dyn Brdf,
                MaskingShadowing::Correlated,
            )
        };
        match shading.sheen_lookup.map {
            _ if shading.method.is_none() => {}
            _ if shading.method.is_integrated() => {
                shading.method = Method::SHEEN;
                (shading.brdf, shading.masking_shadowing) = lobe(shading.sheen_visibility);
            }
            SheenMap::Irradiance => {
                (shading.method, shading.diffuse) =
                    (Method::listed(NONE), Diffuse::listed(IRRADIANCE));
            }
            SheenMap::Levels => shading.method = Method::SHEEN_LOOKUP,
            SheenMap::Charlie => {
                (shading.method, given) = (Method::SHEEN_LOOKUP, Given::default());
                // Both visibilities have one D.
                (shading.brdf, shading.masking_shadowing) = lobe(SheenVisibility::Charlie);
                shading.precompute.prefilter = PrefilterBy::Harmonic;
                shading.precompute.prefilter_weight = &WEIGHTS[0];
            }
        }
        Some([
            base,
            Self {
                scene: Arc::new(self.scene.sheen()),
                shading,
                given,
                background: false,
                ..self.clone()
            },
        ])
    }
}

fn visible(visibility: SheenVisibility) -> &'static SheenVisibility {
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
        let over = self.render_points(sheen)?;
        let mut pixels = self.layer_pixels(sheen, &over, request.scene.sheen_colors())?;
        pixels
            .iter_mut()
            .for_each(|pixel| pixel.alpha = pixel.alpha.max(SHEEN_ALPHA_MIN));
        let lookup = method.has_pass().then_some(sheen_lookup);
        let pairs = self.layer_albedos(
            visible(sheen_visibility),
            MaskingShadowing::Correlated,
            &pixels,
        );
        let shares = pixels.iter().zip(pairs).map(|(pixel, pair)| {
            shares(
                lookup,
                pixel.weight,
                pixel.alpha,
                pixel.n_dot_v,
                pair.element_sum(),
            )
        });
        let shares: Vec<_> = shares.collect();
        Ok(combined([&under, &over], &shares).after(over))
    }
}
