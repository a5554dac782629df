//! `KHR_materials_anisotropy`: strength, turn of the tangent, and a map of directions whose red and
//! green are the direction and whose blue is the strength. Without it the strength is 0.

use super::MaterialExtension;
use crate::instrument::scene::gltf::textures::{TextureReader, TextureReference};
use crate::instrument::scene::maps::Meaning;
use crate::instrument::scene::material::{self, Material};
use serde::Deserialize;

pub const NAME: &str = "KHR_materials_anisotropy";

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase", expecting = "an object")]
pub struct Anisotropy {
    anisotropy_strength: f32,
    anisotropy_rotation: f32,
    anisotropy_texture: Option<TextureReference>,
}

impl MaterialExtension for Anisotropy {
    fn textures(&self) -> Vec<&TextureReference> {
        self.anisotropy_texture.iter().collect()
    }

    fn factors(&self) -> Vec<f32> {
        vec![self.anisotropy_strength]
    }

    fn needs_tangents(&self) -> bool {
        self.anisotropy_strength > 0.0
    }

    fn drop_maps_without_effect(&mut self) {
        if self.anisotropy_strength <= 0.0 {
            self.anisotropy_texture = None;
        }
    }

    fn apply(&self, material: &mut Material, textures: &mut TextureReader) -> Result<(), String> {
        material.anisotropy = material::Anisotropy {
            strength: self.anisotropy_strength.clamp(0.0, 1.0),
            turn: self.anisotropy_rotation,
            map: textures.extension_map(NAME, &self.anisotropy_texture, Meaning::Direction)?,
            is_shown: false,
        };
        Ok(())
    }
}
