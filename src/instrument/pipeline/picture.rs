//! Pictures that never leave the device, for a window on the same device.

use super::{Illumination, Pipeline, PipelineError, RenderRequest};
use crate::base::glsl::layout::LayerParams;
use crate::instrument::brdf::{Brdf, MaskingShadowing};
use crate::instrument::gpu::Buffer;
use crate::instrument::scene::Scene;
use crate::instrument::shade::layer_pass::{LayerAlbedos, LayerPass};
use crate::instrument::tonemap::{self, ToneCurve};
use std::sync::Arc;

/// Index of the albedo in [`crate::instrument::gbuffer::ATTACHMENT_NAMES`].
const ALBEDO: usize = 2;
/// Index of F0.
const F0: usize = 3;

/// An image of linear radiance on the device.
#[derive(Clone)]
pub struct DeviceRadiance {
    /// A vec4 a pixel, row-major.
    pub radiance: Buffer,
    /// Whether a table was made for it.
    pub has_made_table: bool,
}

/// A tone-mapped image on the device.
pub struct DevicePicture {
    /// A word a pixel, R in the lowest byte.
    pub words: Buffer,
    /// Whether a table was made for it.
    pub has_made_table: bool,
}

/// The lobe of a layer, whose albedos a mixture reads.
pub(super) struct LayerLobe {
    pub(super) model: &'static dyn Brdf,
    pub(super) masking: MaskingShadowing,
    /// Smallest width.
    pub(super) alpha_min: f64,
}

/// A scene whose g-buffer has the weights of a layer.
pub(super) struct Weights {
    scene: Arc<Scene>,
    attachment: usize,
}

impl Weights {
    /// Weights in the albedo of a scene.
    pub(super) fn albedo(scene: Scene) -> Self {
        Self {
            scene: Arc::new(scene),
            attachment: ALBEDO,
        }
    }

    /// Weights in the F0 of a scene.
    pub(super) fn f0(scene: Scene) -> Self {
        Self {
            scene: Arc::new(scene),
            attachment: F0,
        }
    }
}

/// What a pass of `shaders/shade/layers` puts together.
pub(super) struct DeviceMixture<'a> {
    pub(super) shader: &'static str,
    pub(super) images: &'a [&'a DeviceRadiance],
    /// The request of the layer's image.
    pub(super) layer: &'a RenderRequest,
    /// `None` if the shader reads no weights.
    pub(super) weights: Option<Weights>,
    /// `None` if the shader reads no albedos.
    pub(super) lobe: Option<LayerLobe>,
    pub(super) params: LayerParams,
}

impl Pipeline {
    /// Renders and tone-maps a picture; `None` if the host finishes it: it resolves edges and
    /// accumulates sequences. Does not check whether radiance is negative or not finite:
    /// [`Pipeline::render`] does.
    pub fn picture_on_device(
        &mut self,
        request: &RenderRequest,
        curve: ToneCurve,
    ) -> Result<Option<DevicePicture>, PipelineError> {
        let Some(image) = self.radiance_on_device(request)? else {
            return Ok(None);
        };
        self.with_memory(|pipeline| {
            let gpu = &pipeline.gpu;
            let words = tonemap::pass::packed(gpu, request.size)?;
            tonemap::pass::run(gpu, curve, &image.radiance, &words, request.size)?;
            Ok(Some(DevicePicture {
                words,
                has_made_table: image.has_made_table,
            }))
        })
    }

    /// Renders the radiance of a picture as [`Pipeline::render`] does, within the rounding of f32;
    /// `None` if the host finishes it. The next image of the same view may overwrite it.
    pub fn radiance_on_device(
        &mut self,
        request: &RenderRequest,
    ) -> Result<Option<DeviceRadiance>, PipelineError> {
        if request.is_sequence() || request.is_antialiased() {
            return Ok(None);
        }
        let image = request.composition();
        self.with_memory(|pipeline| pipeline.composed_on_device(&image))
            .map(Some)
    }

    /// Runs the shading passes of one image. The next image of its view overwrites it.
    pub(super) fn points_on_device(
        &mut self,
        request: &RenderRequest,
    ) -> Result<DeviceRadiance, PipelineError> {
        let prepared = self.prepare(request)?;
        match &request.illumination {
            Illumination::Lights(lights) => drop(self.shade_lights(request, &prepared, lights)?),
            Illumination::Environment => drop(self.shade(request, &prepared, &[])?),
        }
        Ok(DeviceRadiance {
            radiance: prepared.target.radiance.clone(),
            has_made_table: !prepared.precompute.passes.is_empty(),
        })
    }

    /// Puts images of one geometry together.
    pub(super) fn mixed_on_device(
        &mut self,
        mixture: &DeviceMixture,
    ) -> Result<DeviceRadiance, PipelineError> {
        let DeviceMixture {
            shader,
            images,
            layer,
            weights,
            lobe,
            params,
        } = mixture;
        let mut has_made_table = images.iter().any(|image| image.has_made_table);
        let albedos: Option<LayerAlbedos> = match lobe {
            Some(lobe) => {
                let (albedos, are_made) = self.layer_albedos_on_device(
                    &layer.scene,
                    lobe.alpha_min,
                    lobe.model,
                    lobe.masking,
                )?;
                has_made_table |= are_made;
                Some(albedos)
            }
            None => None,
        };
        let (_, surfaces) = self.resources.view(&self.gpu, layer)?;
        let weights = match weights {
            Some(Weights { scene, attachment }) => {
                let request = RenderRequest {
                    scene: scene.clone(),
                    ..(*layer).clone()
                };
                let (_, target) = self.resources.view(&self.gpu, &request)?;
                target.gbuffer.attachments[*attachment].clone()
            }
            None => surfaces.gbuffer.attachments[ALBEDO].clone(),
        };
        let images: Vec<Buffer> = images.iter().map(|image| image.radiance.clone()).collect();
        let pass = LayerPass {
            shader,
            images: &images,
            camera: &layer.camera,
            layer: &surfaces.gbuffer,
            weights: &weights,
            albedos: albedos.as_ref(),
            params: *params,
        };
        Ok(DeviceRadiance {
            radiance: pass.run(&self.gpu)?,
            has_made_table,
        })
    }
}
