//! Ambient occlusion of the image-based terms (`crate::instrument::shade::occlusion`): factors of
//! the specular term and of the rest, for every method and the reference.

use super::layers::combined;
use super::request::Frame;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::glsl::constants::COSINE_MIN;
use crate::base::names::Listed;
use crate::instrument::shade::occlusion::SpecularOcclusion;
use crate::instrument::shade::{Diffuse, NONE, Shading};
use glam::DVec3;
use std::sync::Arc;

/// The images of a surface whose terms are occluded.
pub(super) struct OcclusionLayers {
    /// All terms, not occluded.
    pub(super) whole: RenderRequest,
    /// The specular term alone, if it is one of two terms with different factors.
    pub(super) specular: Option<RenderRequest>,
}

impl RenderRequest {
    /// Returns the requests without occlusion, if a material has a map of it.
    pub(super) fn occlusion_layers(&self) -> Option<OcclusionLayers> {
        if !self.scene.has_occlusion() {
            return None;
        }
        let whole = Self {
            scene: Arc::new(self.scene.unoccluded()),
            ..self.clone()
        };
        let Shading {
            method,
            diffuse,
            specular_occlusion,
            ..
        } = self.shading;
        let is_split =
            specular_occlusion != SpecularOcclusion::Ao && !method.is_none() && !diffuse.is_none();
        let specular =
            is_split.then(|| whole.shaded(|shading| shading.diffuse = Diffuse::listed(NONE)));
        Some(OcclusionLayers { whole, specular })
    }

    /// Returns the requests of the images that the occluded image is made of.
    pub(super) fn occluded_layers(&self) -> Vec<Self> {
        match self.occlusion_layers() {
            Some(OcclusionLayers { whole, specular }) => {
                std::iter::once(whole).chain(specular).collect()
            }
            None => vec![self.clone()],
        }
    }
}

impl Pipeline {
    /// Renders the terms of a surface, occluded.
    pub(super) fn render_occluded(
        &mut self,
        request: &RenderRequest,
    ) -> Result<Frame, PipelineError> {
        let Some(OcclusionLayers { whole, specular }) = request.occlusion_layers() else {
            return self.render_points(request);
        };
        let whole = self.render_points(&whole)?;
        let factors = self.occlusion_factors(request, &whole)?;
        let Some(specular) = specular else {
            let is_specular = request.shading.diffuse.is_none();
            let share = |Factors { specular, rest }| if is_specular { specular } else { rest };
            let shares: Vec<[DVec3; 1]> = factors
                .into_iter()
                .map(|factors| [DVec3::splat(share(factors))])
                .collect();
            return Ok(combined([&whole], &shares));
        };
        let specular = self.render_points(&specular)?;
        // The rest is what `whole` has beyond `specular`.
        let shares: Vec<[DVec3; 2]> = factors
            .into_iter()
            .map(|Factors { specular, rest }| [rest, specular - rest].map(DVec3::splat))
            .collect();
        Ok(combined([&whole, &specular], &shares).after(specular))
    }

    /// Reads the factors at each pixel; 1 off the surfaces, whose background stays.
    fn occlusion_factors(
        &mut self,
        request: &RenderRequest,
        frame: &Frame,
    ) -> Result<Vec<Factors>, PipelineError> {
        let occlusions = RenderRequest {
            scene: Arc::new(request.scene.occlusions()),
            ..request.clone()
        };
        let [occlusions, surfaces] = [&occlusions, request].map(|request| {
            let (_, target) = self.resources.view(&self.gpu, request)?;
            Ok::<_, PipelineError>(target.gbuffer.read(&self.gpu)?)
        });
        let occlusions = occlusions?.albedo_metallic;
        let alphas = surfaces?.normal_alpha;
        let kind = request.shading.specular_occlusion;
        let factors = |pixel: usize| {
            if frame.mask.data[pixel] == 0.0 {
                return Factors {
                    specular: 1.0,
                    rest: 1.0,
                };
            }
            let occlusion = f64::from(occlusions.data[pixel][0]);
            let n_dot_v = f64::from(frame.n_dot_v.data[pixel].max(COSINE_MIN)).min(1.0);
            let alpha = f64::from(alphas.data[pixel][3]);
            Factors {
                specular: kind.factor(occlusion, n_dot_v, alpha),
                rest: occlusion,
            }
        };
        Ok((0..frame.radiance.data.len()).map(factors).collect())
    }
}

/// Factors of the specular term and of all others.
struct Factors {
    specular: f64,
    rest: f64,
}
