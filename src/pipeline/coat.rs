//! Clear coat: the base and the coat are images of one geometry, added with the shares of [`crate::shade::coat`].
//!
//! So every method and the reference serve a coat, squared errors add, and a reference of the base serves all coats.

use super::request::Frame;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::brdf::{Compensation, alpha_from_perceptual_roughness, perceptual_roughness_from_alpha};
use crate::glsl::constants::COSINE_MIN;
use crate::pixels::{Pixels, RgbImage};
use crate::precompute::dfg::Albedos;
use crate::precompute::prefilter::Kernel;
use crate::shade::coat::{CoatShares, CoatWeight, shares};
use crate::shade::{Diffuse, Method, NONE, Shading};
use crate::spelling::Listed;
use glam::DVec2;
use std::collections::HashMap;
use std::sync::Arc;

/// Levels of perceptual roughness of a coat with a map, which has 8 bits.
const ROUGHNESS_LEVELS: f64 = 255.0;

impl RenderRequest {
    /// Returns the requests of the base and, if a material has a coat, of the coat.
    pub(super) fn layers(&self) -> Vec<Self> {
        if !self.scene.has_coat() {
            return vec![self.clone()];
        }
        let base = Self { scene: Arc::new(self.scene.uncoated()), ..self.clone() };
        let Shading { coat_layering, coat_renderer, method, .. } = self.shading;
        let f0 = if coat_renderer.lookup.is_none() { coat_layering.f0() } else { 1.0 };
        let scene = Arc::new(self.scene.coat(f0 as f32, coat_renderer.alpha));
        let lookup = coat_renderer.lookup.filter(|_| method.has_pass()).map(Method::listed);
        let shading = Shading {
            method: lookup.unwrap_or(method),
            diffuse: Diffuse::listed(NONE),
            compensation: Compensation::None,
            ..self.shading
        };
        vec![base, Self { scene, shading, background: false, ..self.clone() }]
    }
}

impl Pipeline {
    /// Renders the base and the coat of `request`, and adds them.
    pub(super) fn render_coated(&mut self, request: &RenderRequest) -> Result<Frame, PipelineError> {
        let [base, coat] = request.layers().try_into().expect("a coated scene has two layers");
        let renderer = request.shading.coat_renderer;
        let whole = self.render_points(&base)?;
        let is_split = renderer.powers[0] != renderer.powers[1] && !request.shading.diffuse.is_none();
        let specular_only = base.shaded(|shading| shading.diffuse = Diffuse::listed(NONE));
        let specular = if is_split { Some(self.render_points(&specular_only)?) } else { None };
        let over = self.render_points(&coat)?;
        let shares = self.coat_shares(request, &coat, &over)?;
        let specular = specular.as_ref().unwrap_or(&whole);
        let radiance = combined(&shares, &whole.radiance, &specular.radiance, &over.radiance, |a, b, c| a + b + c);
        let standard_error = match (&whole.standard_error, &specular.standard_error, &over.standard_error) {
            (Some(whole), Some(specular), Some(over)) => {
                Some(combined(&shares, whole, specular, over, |a, b, c| (a * a + b * b + c * c).sqrt()))
            }
            _ => None,
        };
        let convergences = [&whole.convergences[..], &over.convergences].concat();
        let timings = whole.timings.clone().and(over.timings);
        Ok(Frame { radiance, standard_error, convergences, timings, ..whole })
    }

    /// Returns the shares of each pixel; `over` is the frame of the request `coat`.
    fn coat_shares(
        &mut self,
        request: &RenderRequest,
        coat: &RenderRequest,
        over: &Frame,
    ) -> Result<Vec<CoatShares>, PipelineError> {
        let Shading { coat_layering, coat_renderer, brdf, masking_shadowing, .. } = request.shading;
        // The weights are the albedo of a scene that is never shaded.
        let weights = RenderRequest { scene: Arc::new(request.scene.coat_weights()), ..coat.clone() };
        let [weights, lobes] = [&weights, coat].map(|request| {
            let (_, target) = self.resources.view(&self.gpu, request)?;
            Ok::<_, PipelineError>(target.gbuffer.read(&self.gpu)?)
        });
        let (weights, lobes) = (weights?.albedo_metallic, lobes?.normal_alpha);
        let needs_pair = coat_renderer.lookup.is_some() || coat_layering.loss() == CoatWeight::Albedo;
        let has_map = request.scene.materials.iter().any(|material| material.coat.roughness_map.is_some());
        let mut albedos: HashMap<u64, Arc<Albedos>> = HashMap::new();
        let mut share = |i: usize| {
            let n_dot_v = f64::from(over.n_dot_v.data[i].max(COSINE_MIN));
            let mut alpha = f64::from(lobes.data[i][3]);
            if has_map {
                let roughness = perceptual_roughness_from_alpha(alpha);
                alpha = alpha_from_perceptual_roughness((ROUGHNESS_LEVELS * roughness).round() / ROUGHNESS_LEVELS);
            }
            let kernel = Kernel::cosine(brdf);
            let own = || Arc::new(Albedos::new(kernel, masking_shadowing, alpha));
            let pair = match needs_pair && over.mask.data[i] == 1.0 {
                true => albedos.entry(alpha.to_bits()).or_insert_with(own).exact(n_dot_v),
                false => DVec2::X,
            };
            shares(coat_layering, coat_renderer, weights.data[i][0].into(), n_dot_v, pair)
        };
        Ok((0..over.radiance.data.len()).map(&mut share).collect())
    }
}

/// Adds the shares of base and coat. The diffuse term is what `whole` has beyond `specular`.
fn combined(
    shares: &[CoatShares],
    whole: &RgbImage,
    specular: &RgbImage,
    coat: &RgbImage,
    add: impl Fn(f64, f64, f64) -> f64,
) -> RgbImage {
    let texel = |(i, shares): (usize, &CoatShares)| -> [f32; 3] {
        std::array::from_fn(|channel| {
            let [whole, specular, coat] = [whole, specular, coat].map(|image| f64::from(image.data[i][channel]));
            let [of_specular, of_diffuse] = shares.base;
            add(of_diffuse * whole, (of_specular - of_diffuse) * specular, shares.coat * coat) as f32
        })
    };
    Pixels::new(whole.width, whole.height, shares.iter().enumerate().map(texel).collect())
}
