//! The device passes that put images of layers together: twins of what the host does with finished
//! images (`crate::instrument::pipeline`, `layers.rs`).

use super::pass::eye;
use crate::base::glsl::constants::ALBEDOS_BY_MATERIAL;
use crate::base::glsl::layout::{LayerParams, SharedStruct};
use crate::base::glsl::specialization::Specialization;
use crate::instrument::gbuffer::pass::GbufferImages;
use crate::instrument::gpu::{Bind, Buffer, Gpu, GpuError, Image, Sampler, image_groups};
use crate::instrument::scene::Camera;

/// Bytes of a vec4 of f32 for each pixel.
pub fn vec4_bytes([width, height]: [u32; 2]) -> u64 {
    16 * u64::from(width) * u64::from(height)
}

/// Directional albedos of a layer's lobe.
#[derive(Clone)]
pub struct LayerAlbedos {
    /// (A, B) at the nodes of each row.
    pub rows: Buffer,
    /// Level of perceptual roughness of the first row; [`ALBEDOS_BY_MATERIAL`] if rows are by
    /// material.
    pub first_level: u32,
}

/// What a pass reads.
pub struct LayerPass<'a> {
    /// Entry point in `shaders/shade/layers`.
    pub shader: &'static str,
    /// One to three images, a vec4 a pixel.
    pub images: &'a [Buffer],
    pub camera: &'a Camera,
    /// The g-buffer of the layer.
    pub layer: &'a GbufferImages,
    /// The attachment with the weights of the layer.
    pub weights: &'a Image,
    /// `None` if the shader reads none.
    pub albedos: Option<&'a LayerAlbedos>,
    /// What the shader reads beyond view and albedos.
    pub params: LayerParams,
}

impl LayerPass<'_> {
    /// Returns the image of all layers, a vec4 a pixel.
    pub fn run(&self, gpu: &Gpu) -> Result<Buffer, GpuError> {
        let [width, height] = self.layer.size;
        let whole = gpu.buffer("layers", vec4_bytes(self.layer.size))?;
        let params = LayerParams {
            eye: eye(self.camera),
            width,
            height,
            first_level: self
                .albedos
                .map_or(ALBEDOS_BY_MATERIAL, |albedos| albedos.first_level),
            ..self.params
        };
        let [position, normal, _, f0] = &self.layer.attachments;
        // A missing image has no share.
        let [first, ..] = self.images else {
            panic!("a pass over layers has an image");
        };
        let image = |index: usize| Bind::Read(self.images.get(index).unwrap_or(first));
        let texels = |image| Bind::Sample(image, Sampler::TEXELS);
        let binds = [
            image(0),
            image(1),
            image(2),
            Bind::Write(&whole),
            texels(position),
            texels(normal),
            texels(f0),
            texels(self.weights),
            Bind::Read(self.albedos.map_or(first, |albedos| &albedos.rows)),
        ];
        let constants = Specialization::default().words();
        let groups = image_groups(width, height);
        gpu.submit_pass("layers", |recorder| {
            recorder.dispatch(self.shader, &constants, &binds, &params.to_bytes(), groups)
        })?;
        Ok(whole)
    }
}
