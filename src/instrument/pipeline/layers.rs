//! Layers over a base: images of one geometry, added with the shares of
//! [`crate::instrument::shade::coat`] and [`crate::instrument::shade::sheen`].
//!
//! So every method and the reference serve a layer, squared errors add, and a reference of the base
//! serves all layers. A coat lies over emission, emission over sheen, sheen over the base.

use super::picture::DeviceRadiance;
use super::request::Frame;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::glsl::constants::{ALBEDOS_BY_MATERIAL, ALPHA_MIN, COSINE_MIN, LAYER_LEVELS};
use crate::base::pixels::{Pixels, RgbImage};
use crate::instrument::brdf::{
    Brdf, MaskingShadowing, alpha_from_perceptual_roughness, perceptual_roughness_from_alpha,
};
use crate::instrument::precompute::dfg::Albedos;
use crate::instrument::precompute::prefilter::Kernel;
use crate::instrument::scene::{Material, Scene};
use crate::instrument::shade::layer_pass::LayerAlbedos;
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::sync::Arc;

/// Levels of perceptual roughness of a layer with a map, which has 8 bits.
const ROUGHNESS_LEVELS: f64 = LAYER_LEVELS as f64;

fn level_of_alpha(alpha: f64) -> f64 {
    (ROUGHNESS_LEVELS * perceptual_roughness_from_alpha(alpha)).round()
}

fn alpha_of_level(level: f64) -> f64 {
    alpha_from_perceptual_roughness(level / ROUGHNESS_LEVELS)
}

fn has_roughness_map(scene: &Scene) -> bool {
    scene
        .materials
        .iter()
        .any(|material| material.roughness_map.is_some())
}

/// How an image is put together from images that shading passes make.
pub(super) enum Composition {
    Points(Box<RenderRequest>),
    /// A term of an image that is counted already, because renderers shade it once.
    Again(Box<Self>),
    Mixed {
        parts: Vec<Self>,
        mixture: Box<dyn Mixture>,
    },
}

/// Puts images of one geometry together.
pub(super) trait Mixture {
    /// Returns the first frame with the radiance, and its standard error, of all. The others'
    /// times and stops are not added yet.
    fn on_host(&self, pipeline: &mut Pipeline, frames: &[Frame]) -> Result<Frame, PipelineError>;

    /// Returns the radiance of all, a vec4 a pixel: the same within the rounding of f32.
    fn on_device(
        &self,
        pipeline: &mut Pipeline,
        images: &[DeviceRadiance],
    ) -> Result<DeviceRadiance, PipelineError>;
}

impl Composition {
    pub(super) fn mixed(mixture: impl Mixture + 'static, parts: impl Into<Vec<Self>>) -> Self {
        Self::Mixed {
            parts: parts.into(),
            mixture: Box::new(mixture),
        }
    }

    /// Whether it is the image of a view, which the next image of that view overwrites.
    fn is_of_view(&self) -> bool {
        match self {
            Self::Points(_) => true,
            Self::Again(image) => image.is_of_view(),
            Self::Mixed { .. } => false,
        }
    }

    /// Adds the requests of the images under the environment, each once.
    fn add_layers(self, layers: &mut Vec<RenderRequest>) {
        match self {
            Self::Points(request) if request.is_under_environment() => layers.push(*request),
            Self::Points(_) | Self::Again(_) => {}
            Self::Mixed { parts, .. } => {
                parts.into_iter().for_each(|part| part.add_layers(layers));
            }
        }
    }
}

impl RenderRequest {
    /// Returns the requests of the base and of each layer over it, without direct lights.
    pub(super) fn layers(&self) -> Vec<Self> {
        let mut layers = Vec::new();
        self.composition().add_layers(&mut layers);
        layers
    }

    pub(super) fn composition(&self) -> Composition {
        if let Some(lit) = self.lit() {
            return lit;
        }
        if let Some(layers) = self.coat_layers() {
            return self.coated(layers);
        }
        let dark = self.dark();
        let image = match dark.sheen_layers() {
            Some(layers) => dark.sheened(layers),
            None => dark.base(),
        };
        self.emitting(image)
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
    /// Renders the images of a composition and puts them together.
    pub(super) fn composed(&mut self, image: &Composition) -> Result<Frame, PipelineError> {
        match image {
            Composition::Points(request) => self.render_points(request),
            Composition::Again(image) => self.composed(image),
            Composition::Mixed { parts, mixture } => {
                let frames = parts.iter().map(|part| self.composed(part));
                let frames = frames.collect::<Result<Vec<_>, _>>()?;
                let mut whole = mixture.on_host(self, &frames)?;
                for (part, frame) in parts.iter().zip(frames).skip(1) {
                    if !matches!(part, Composition::Again(_)) {
                        whole = whole.after(frame);
                    }
                }
                Ok(whole)
            }
        }
    }

    /// [`Pipeline::composed_on_device`], of an image that is held while others are rendered.
    fn part_on_device(&mut self, part: &Composition) -> Result<DeviceRadiance, PipelineError> {
        let mut image = self.composed_on_device(part)?;
        if part.is_of_view() {
            image.radiance = self.gpu.copied(&image.radiance)?;
        }
        Ok(image)
    }

    /// [`Pipeline::composed`] on the device; reads nothing back.
    pub(super) fn composed_on_device(
        &mut self,
        image: &Composition,
    ) -> Result<DeviceRadiance, PipelineError> {
        match image {
            Composition::Points(request) => self.points_on_device(request),
            Composition::Again(image) => self.composed_on_device(image),
            Composition::Mixed { parts, mixture } => {
                let images = parts.iter().map(|part| self.part_on_device(part));
                let images = images.collect::<Result<Vec<_>, _>>()?;
                mixture.on_device(self, &images)
            }
        }
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
        let has_map = has_roughness_map(&over.scene);
        let pixel = |i: usize| {
            let [r, g, b, _] = weights.data[i];
            let mut alpha = f64::from(lobes.data[i][3]);
            if has_map {
                alpha = alpha_of_level(level_of_alpha(alpha));
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

/// Rows of albedos that a layer's pixels may need.
struct AlbedoRows {
    alphas: Vec<f64>,
    first_level: u32,
}

impl AlbedoRows {
    /// A row for each material, or if one has a map, for each level between the extremes of all.
    fn new(scene: &Scene, alpha_min: f64) -> Self {
        let floor = alpha_min.max(f64::from(ALPHA_MIN));
        let whole = |material: &Material| f64::from(material.alpha).max(floor);
        let materials = scene.materials.iter();
        if !has_roughness_map(scene) {
            return Self {
                alphas: materials.map(whole).collect(),
                first_level: ALBEDOS_BY_MATERIAL,
            };
        }
        let least = |material: &Material| match material.roughness_map {
            Some(map) => {
                let texels = scene.textures[map].levels[0].data.iter();
                let least = texels.map(|texel| texel[1]).fold(1.0, f32::min);
                (f64::from(material.alpha) * f64::from(least).powi(2)).max(f64::from(ALPHA_MIN))
            }
            None => whole(material),
        };
        // Filters round: one level more at both ends.
        let low = materials.clone().map(least).map(level_of_alpha);
        let low = (low.fold(ROUGHNESS_LEVELS, f64::min) - 1.0).max(1.0);
        let high = materials.map(whole).map(level_of_alpha);
        let high = (high.fold(1.0, f64::max) + 1.0).min(ROUGHNESS_LEVELS);
        let levels = low as u32..=high as u32;
        let alphas = levels.map(|level| alpha_of_level(level.into()).max(alpha_min));
        Self {
            alphas: alphas.collect(),
            first_level: low as u32,
        }
    }
}

impl Pipeline {
    /// Returns the albedos of a layer's lobe on the device, and whether they were made. Alphas of
    /// the lobe are at least `alpha_min`.
    pub(super) fn layer_albedos_on_device(
        &mut self,
        scene: &Scene,
        alpha_min: f64,
        model: &'static dyn Brdf,
        masking: MaskingShadowing,
    ) -> Result<(LayerAlbedos, bool), PipelineError> {
        let AlbedoRows {
            alphas,
            first_level,
        } = AlbedoRows::new(scene, alpha_min);
        let key = format!("{} {masking:?} {first_level} {alphas:?}", model.name());
        if let Some(known) = self.resources.layer_albedos.get(&key) {
            return Ok((known, false));
        }
        let kernel = Kernel::cosine(model);
        let nodes = alphas.iter().flat_map(|&alpha| {
            let albedos = self.resources.albedos_of(kernel, masking, alpha);
            albedos.exact_nodes().collect::<Vec<_>>()
        });
        let nodes: Vec<[f32; 2]> = nodes.collect();
        let made = LayerAlbedos {
            rows: self.gpu.buffer_from("albedos of a layer", &nodes)?,
            first_level,
        };
        let made = self
            .resources
            .layer_albedos
            .get_or_make(key, || Ok::<_, PipelineError>(made))?;
        Ok((made, true))
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
