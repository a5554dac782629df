//! Sheen: the base and the sheen, added with the shares of [`crate::instrument::shade::sheen`].

use super::layers::{Composition, Mixture, combined};
use super::picture::{DeviceMixture, DeviceRadiance, LayerLobe, Weights};
use super::request::Frame;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::glsl::layout::LayerParams;
use crate::base::names::Listed;
use crate::instrument::brdf::{
    Compensation, Fresnel, MaskingShadowing, SHEEN_ALPHA_MIN, SheenVisibility,
};
use crate::instrument::precompute::PrefilterBy;
use crate::instrument::precompute::given::Given;
use crate::instrument::precompute::prefilter::WEIGHTS;
use crate::instrument::shade::occlusion::SpecularOcclusion;
use crate::instrument::shade::sheen::{SheenLookup, SheenMap, albedos_of, shares};
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

/// A sheen over its base: the base and the sheen.
struct SheenMixture {
    request: RenderRequest,
    sheen: RenderRequest,
}

impl RenderRequest {
    /// Returns the composition of the base and the sheen.
    pub(super) fn sheened(&self, [base, sheen]: [Self; 2]) -> Composition {
        let parts = [base.composition(), sheen.occluded()];
        let mixture = SheenMixture {
            request: self.clone(),
            sheen,
        };
        Composition::mixed(mixture, parts)
    }
}

impl SheenMixture {
    fn lookup(&self) -> Option<&'static SheenLookup> {
        let shading = &self.request.shading;
        shading.method.has_pass().then_some(shading.sheen_lookup)
    }

    fn lobe(&self) -> LayerLobe {
        LayerLobe {
            model: listed_visibility(self.request.shading.sheen_visibility),
            masking: MaskingShadowing::Correlated,
            alpha_min: SHEEN_ALPHA_MIN,
        }
    }
}

impl Mixture for SheenMixture {
    fn on_host(&self, pipeline: &mut Pipeline, frames: &[Frame]) -> Result<Frame, PipelineError> {
        let [under, over] = [&frames[0], &frames[1]];
        let lobe = self.lobe();
        let colors = self.request.scene.sheen_colors();
        let mut pixels = pipeline.layer_pixels(&self.sheen, over, colors)?;
        pixels
            .iter_mut()
            .for_each(|pixel| pixel.alpha = pixel.alpha.max(lobe.alpha_min));
        let lookup = self.lookup();
        let pairs = pipeline.layer_albedos(lobe.model, lobe.masking, &pixels);
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
        Ok(combined([under, over], &shares))
    }

    fn on_device(
        &self,
        pipeline: &mut Pipeline,
        images: &[DeviceRadiance],
    ) -> Result<DeviceRadiance, PipelineError> {
        let [scale, loss] = albedos_of(self.lookup()).map(|albedo| albedo as u32);
        pipeline.mixed_on_device(&DeviceMixture {
            shader: "shade/layers/sheen.comp",
            images: &[&images[0], &images[1]],
            layer: &self.sheen,
            weights: Some(Weights::albedo(self.request.scene.sheen_colors())),
            lobe: Some(self.lobe()),
            params: LayerParams {
                scale,
                loss,
                ..LayerParams::default()
            },
        })
    }
}
