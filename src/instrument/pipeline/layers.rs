//! Layers over a base: images of one geometry, added with the shares of
//! [`crate::instrument::shade::coat`] and [`crate::instrument::shade::sheen`].
//!
//! So every method and the reference serve a layer, squared errors add, and a reference of the base
//! serves all layers. A coat lies over emission, emission over sheen, sheen over the base.

use super::request::Frame;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::glsl::constants::COSINE_MIN;
use crate::base::pixels::{Pixels, RgbImage};
use crate::instrument::brdf::{
    Brdf, MaskingShadowing, alpha_from_perceptual_roughness, perceptual_roughness_from_alpha,
};
use crate::instrument::precompute::dfg::Albedos;
use crate::instrument::precompute::prefilter::Kernel;
use crate::instrument::scene::Scene;
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::sync::Arc;

/// Levels of perceptual roughness of a layer with a map, which has 8 bits.
const ROUGHNESS_LEVELS: f64 = 255.0;

impl RenderRequest {
    /// Returns the requests of the base and of each layer over it.
    pub(super) fn layers(&self) -> Vec<Self> {
        let dark = self.unlit().dark();
        match dark.coat_layers().or_else(|| dark.sheen_layers()) {
            Some([base, over]) => {
                let mut layers = base.layers();
                layers.extend(over.occluded_layers());
                layers
            }
            None => match dark.specular_layers() {
                Some(layers) => layers.iter().flat_map(Self::occluded_layers).collect(),
                None => dark.occluded_layers(),
            },
        }
    }
}

/// The g-buffers of a layer at a pixel.
pub(super) struct LayerPixel {
    /// Weight or colour.
    pub(super) weight: DVec3,
    pub(super) alpha: f64,
    pub(super) n_dot_v: f64,
    pub(super) is_hit: bool,
}

impl Pipeline {
    pub(super) fn render_layers(
        &mut self,
        request: &RenderRequest,
    ) -> Result<Frame, PipelineError> {
        if request.scene.has_lights() {
            let frame = self.render_layers(&request.unlit())?;
            return self.with_lights(request, frame);
        }
        if let Some(layers) = request.coat_layers() {
            return self.render_coated(request, &layers);
        }
        let dark = request.dark();
        let frame = match dark.sheen_layers() {
            Some(layers) => self.render_sheened(&dark, &layers)?,
            None => self.render_base(&dark)?,
        };
        self.with_emission(request, frame)
    }

    /// Reads the pixels of the layer `over`, whose frame is `frame`. `weights` is a scene whose
    /// albedo is its weight.
    pub(super) fn layer_pixels(
        &mut self,
        over: &RenderRequest,
        frame: &Frame,
        weights: Scene,
    ) -> Result<Vec<LayerPixel>, PipelineError> {
        // The weights are of a scene that is never shaded.
        let weights = RenderRequest {
            scene: Arc::new(weights),
            ..over.clone()
        };
        let [weights, lobes] = [&weights, over].map(|request| {
            let (_, target) = self.resources.view(&self.gpu, request)?;
            Ok::<_, PipelineError>(target.gbuffer.read(&self.gpu)?)
        });
        let weights = weights?.albedo_metallic;
        let lobes = lobes?.normal_alpha;
        let has_map = over
            .scene
            .materials
            .iter()
            .any(|material| material.roughness_map.is_some());
        let pixel = |i: usize| {
            let [r, g, b, _] = weights.data[i];
            let mut alpha = f64::from(lobes.data[i][3]);
            if has_map {
                let roughness = perceptual_roughness_from_alpha(alpha);
                alpha = alpha_from_perceptual_roughness(
                    (ROUGHNESS_LEVELS * roughness).round() / ROUGHNESS_LEVELS,
                );
            }
            LayerPixel {
                weight: DVec3::new(r.into(), g.into(), b.into()),
                alpha,
                n_dot_v: f64::from(frame.n_dot_v.data[i].max(COSINE_MIN)),
                is_hit: frame.mask.data[i] == 1.0,
            }
        };
        Ok((0..frame.radiance.data.len()).map(pixel).collect())
    }

    /// Returns (A, B) of a lobe at each pixel; 0 where nothing is hit.
    pub(super) fn layer_albedos(
        &mut self,
        model: &'static dyn Brdf,
        masking: MaskingShadowing,
        pixels: &[LayerPixel],
    ) -> Vec<DVec2> {
        let mut known: HashMap<u64, Arc<Albedos>> = HashMap::new();
        let mut pair = |pixel: &LayerPixel| {
            let albedos = known.entry(pixel.alpha.to_bits()).or_insert_with(|| {
                self.resources
                    .albedos_of(Kernel::cosine(model), masking, pixel.alpha)
            });
            albedos.exact(pixel.n_dot_v)
        };
        pixels
            .iter()
            .map(|pixel| {
                if pixel.is_hit {
                    pair(pixel)
                } else {
                    DVec2::ZERO
                }
            })
            .collect()
    }
}

/// Adds images of one geometry by their shares in each pixel.
pub(super) fn combined<const N: usize>(frames: [&Frame; N], shares: &[[DVec3; N]]) -> Frame {
    let added = |images: [&RgbImage; N], add: fn([f64; N]) -> f64| {
        let texel = |(i, shares): (usize, &[DVec3; N])| -> [f32; 3] {
            std::array::from_fn(|c| {
                add(std::array::from_fn(|k| {
                    shares[k][c] * f64::from(images[k].data[i][c])
                })) as f32
            })
        };
        Pixels::new(
            images[0].width,
            images[0].height,
            shares.iter().enumerate().map(texel).collect(),
        )
    };
    let root = |parts: [f64; N]| parts.iter().map(|part| part * part).sum::<f64>().sqrt();
    let errors: Option<Vec<&RgbImage>> = frames
        .iter()
        .map(|frame| frame.standard_error.as_ref())
        .collect();
    let errors = errors.map(|errors| added(errors.try_into().expect("one for each frame"), root));
    let radiance = added(frames.map(|frame| &frame.radiance), |parts| {
        parts.iter().sum()
    });
    Frame {
        radiance,
        standard_error: errors,
        ..frames[0].clone()
    }
}

impl Frame {
    /// Adds stops and times of the frame of a layer.
    pub(super) fn after(self, over: Frame) -> Self {
        let convergences = [self.convergences, over.convergences].concat();
        Self {
            convergences,
            timings: self.timings.and(over.timings),
            ..self
        }
    }
}
