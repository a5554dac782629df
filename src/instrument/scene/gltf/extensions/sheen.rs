//! `KHR_materials_sheen`: colour (factor, sRGB texture) and alpha (roughness factor², texture
//! alpha). Without it the colour is black, which has no sheen.

use super::MaterialExtension;
use crate::instrument::brdf;
use crate::instrument::scene::gltf::textures::{TextureReader, TextureReference};
use crate::instrument::scene::maps::Meaning;
use crate::instrument::scene::material::{self, Material};
use serde::Deserialize;

pub const NAME: &str = "KHR_materials_sheen";

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase", expecting = "an object")]
pub struct Sheen {
    sheen_color_factor: [f32; 3],
    sheen_color_texture: Option<TextureReference>,
    sheen_roughness_factor: f32,
    sheen_roughness_texture: Option<TextureReference>,
}

impl MaterialExtension for Sheen {
    fn textures(&self) -> Vec<&TextureReference> {
        self.sheen_color_texture
            .iter()
            .chain(&self.sheen_roughness_texture)
            .collect()
    }

    fn factors(&self) -> Vec<f32> {
        let [red, green, blue] = self.sheen_color_factor;
        vec![red, green, blue, self.sheen_roughness_factor]
    }

    fn drop_maps_without_effect(&mut self) {
        let is_black = self.sheen_color_factor == [0.0; 3];
        if is_black {
            self.sheen_color_texture = None;
        }
        if is_black || self.sheen_roughness_factor <= 0.0 {
            self.sheen_roughness_texture = None;
        }
    }

    fn apply(&self, material: &mut Material, textures: &mut TextureReader) -> Result<(), String> {
        let roughness = f64::from(self.sheen_roughness_factor.clamp(0.0, 1.0));
        material.sheen = material::Sheen {
            color: self.sheen_color_factor.map(|x| x.clamp(0.0, 1.0)),
            color_map: textures.extension_map(NAME, &self.sheen_color_texture, Meaning::Color)?,
            alpha: brdf::alpha_from_perceptual_roughness(roughness).max(brdf::SHEEN_ALPHA_MIN)
                as f32,
            roughness_map: textures.extension_map(
                NAME,
                &self.sheen_roughness_texture,
                Meaning::Alpha,
            )?,
        };
        Ok(())
    }
}
