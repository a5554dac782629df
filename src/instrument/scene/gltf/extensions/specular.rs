//! `KHR_materials_specular`: the share of the dielectric interface that reflects (factor, texture
//! alpha), and a colour of f0 (factor, sRGB texture), `min(f0 colour, 1)`. Without it both are 1.

use super::MaterialExtension;
use crate::instrument::scene::gltf::textures::{TextureReader, TextureReference};
use crate::instrument::scene::maps::Meaning;
use crate::instrument::scene::material::{Material, SpecularWeight};
use serde::Deserialize;

pub const NAME: &str = "KHR_materials_specular";

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase", expecting = "an object")]
pub struct Specular {
    specular_factor: f32,
    specular_texture: Option<TextureReference>,
    specular_color_factor: [f32; 3],
    specular_color_texture: Option<TextureReference>,
}

impl Default for Specular {
    fn default() -> Self {
        Self {
            specular_factor: 1.0,
            specular_texture: None,
            specular_color_factor: [1.0; 3],
            specular_color_texture: None,
        }
    }
}

impl MaterialExtension for Specular {
    fn textures(&self) -> Vec<&TextureReference> {
        self.specular_texture
            .iter()
            .chain(&self.specular_color_texture)
            .collect()
    }

    fn factors(&self) -> Vec<f32> {
        vec![self.specular_factor]
    }

    fn drop_maps_without_effect(&mut self) {
        if self.specular_factor <= 0.0 {
            self.specular_texture = None;
        }
        if self.specular_factor <= 0.0 || self.specular_color_factor == [0.0; 3] {
            self.specular_color_texture = None;
        }
    }

    fn apply(&self, material: &mut Material, textures: &mut TextureReader) -> Result<(), String> {
        material.specular = SpecularWeight {
            factor: self.specular_factor.clamp(0.0, 1.0),
            map: textures.extension_map(NAME, &self.specular_texture, Meaning::Alpha)?,
        };
        material.f0_map =
            textures.extension_map(NAME, &self.specular_color_texture, Meaning::Color)?;
        // Under a map the product is clamped, where the g-buffer is drawn.
        let most = if material.f0_map.is_some() {
            f32::MAX
        } else {
            1.0
        };
        for (f0, color) in material.f0.iter_mut().zip(self.specular_color_factor) {
            *f0 = (*f0 * color.max(0.0)).min(most);
        }
        Ok(())
    }
}
