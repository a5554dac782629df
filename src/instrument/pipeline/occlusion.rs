//! Ambient occlusion of the image-based terms (`crate::instrument::shade::occlusion`): factors of
//! the specular term and of the rest, for every method and the reference.

use super::layers::{Composition, Mixture, combined};
use super::picture::{DeviceMixture, DeviceRadiance, Weights};
use super::request::Frame;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::glsl::constants::{COSINE_MIN, OCCLUDED_BOTH, OCCLUDED_REST, OCCLUDED_SPECULAR};
use crate::base::glsl::layout::LayerParams;
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
        let whole = self.unoccluded();
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

    fn unoccluded(&self) -> Self {
        Self {
            scene: Arc::new(self.scene.unoccluded()),
            ..self.clone()
        }
    }

    /// Returns the composition of a surface's terms, occluded.
    pub(super) fn occluded(&self) -> Composition {
        let Some(OcclusionLayers { whole, specular }) = self.occlusion_layers() else {
            return Composition::Points(Box::new(self.clone()));
        };
        let parts = std::iter::once(whole).chain(specular);
        let parts: Vec<_> = parts
            .map(|request| Composition::Points(Box::new(request)))
            .collect();
        Composition::mixed(Occlusion(self.clone()), parts)
    }
}

/// Occludes the terms of a request's image. A second image has the specular term alone.
struct Occlusion(RenderRequest);

impl Mixture for Occlusion {
    fn on_host(&self, pipeline: &mut Pipeline, frames: &[Frame]) -> Result<Frame, PipelineError> {
        let factors = pipeline.occlusion_factors(&self.0, &frames[0])?;
        let [whole, specular] = frames else {
            let is_specular = self.0.shading.diffuse.is_none();
            let share = |Factors { specular, rest }| if is_specular { specular } else { rest };
            let shares: Vec<[DVec3; 1]> = factors
                .into_iter()
                .map(|factors| [DVec3::splat(share(factors))])
                .collect();
            return Ok(combined([&frames[0]], &shares));
        };
        // The rest is what `whole` has beyond `specular`.
        let shares: Vec<[DVec3; 2]> = factors
            .into_iter()
            .map(|Factors { specular, rest }| [rest, specular - rest].map(DVec3::splat))
            .collect();
        Ok(combined([whole, specular], &shares))
    }

    fn on_device(
        &self,
        pipeline: &mut Pipeline,
        images: &[DeviceRadiance],
    ) -> Result<DeviceRadiance, PipelineError> {
        let shading = &self.0.shading;
        let occluded = match images {
            [_, _] => OCCLUDED_BOTH,
            _ if shading.diffuse.is_none() => OCCLUDED_SPECULAR,
            _ => OCCLUDED_REST,
        };
        let images: Vec<&DeviceRadiance> = images.iter().collect();
        pipeline.mixed_on_device(&DeviceMixture {
            shader: "shade/layers/occlusion.comp",
            images: &images,
            layer: &self.0.unoccluded(),
            weights: Some(Weights::albedo(self.0.scene.occlusions())),
            lobe: None,
            params: LayerParams {
                specular_occlusion: shading.specular_occlusion as u32,
                occluded,
                ..LayerParams::default()
            },
        })
    }
}

impl Pipeline {
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
