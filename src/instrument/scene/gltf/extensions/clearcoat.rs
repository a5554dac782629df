//! `KHR_materials_clearcoat`: the coat's weight (factor, texture red), alpha (roughness factor²,
//! texture green) and normals. Without it the weight is 0.

use super::MaterialExtension;
use crate::base::glsl::constants::ALPHA_MIN;
use crate::instrument::brdf;
use crate::instrument::scene::gltf::textures::{TextureReader, TextureReference};
use crate::instrument::scene::maps::Meaning;
use crate::instrument::scene::material::{Coat, Material};
use serde::Deserialize;

pub const NAME: &str = "KHR_materials_clearcoat";

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase", expecting = "an object")]
pub struct Clearcoat {
    clearcoat_factor: f32,
    clearcoat_texture: Option<TextureReference>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<TextureReference>,
    clearcoat_normal_texture: Option<TextureReference>,
}

impl MaterialExtension for Clearcoat {
    fn textures(&self) -> Vec<&TextureReference> {
        self.clearcoat_texture
            .iter()
            .chain(&self.clearcoat_roughness_texture)
            .chain(&self.clearcoat_normal_texture)
            .collect()
    }

    fn factors(&self) -> Vec<f32> {
        vec![self.clearcoat_factor, self.clearcoat_roughness_factor]
    }

    fn needs_tangents(&self) -> bool {
        self.clearcoat_normal_texture.is_some()
    }

    fn drop_maps_without_effect(&mut self) {
        if self.clearcoat_factor <= 0.0 {
            self.clearcoat_texture = None;
            self.clearcoat_normal_texture = None;
        }
        if self.clearcoat_factor <= 0.0 || self.clearcoat_roughness_factor <= 0.0 {
            self.clearcoat_roughness_texture = None;
        }
    }

    fn apply(&self, material: &mut Material, textures: &mut TextureReader) -> Result<(), String> {
        let roughness = f64::from(self.clearcoat_roughness_factor.clamp(0.0, 1.0));
        let normal_scale = self
            .clearcoat_normal_texture
            .as_ref()
            .map_or(1.0, TextureReference::scale);
        let normals = Meaning::Normal {
            scale: normal_scale,
        };
        material.coat = Coat {
            weight: self.clearcoat_factor.clamp(0.0, 1.0),
            weight_map: textures.extension_map(NAME, &self.clearcoat_texture, Meaning::Linear)?,
            alpha: (brdf::alpha_from_perceptual_roughness(roughness) as f32).max(ALPHA_MIN),
            roughness_map: textures.extension_map(
                NAME,
                &self.clearcoat_roughness_texture,
                Meaning::Linear,
            )?,
            normal_map: textures.extension_map(NAME, &self.clearcoat_normal_texture, normals)?,
        };
        Ok(())
    }
}
