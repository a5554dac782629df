//! `KHR_materials_emissive_strength`: multiplies the emission. Without it the factor is 1.

use super::MaterialExtension;
use crate::instrument::scene::gltf::textures::TextureReader;
use crate::instrument::scene::material::Material;
use serde::Deserialize;

pub const NAME: &str = "KHR_materials_emissive_strength";

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase", expecting = "an object")]
pub struct EmissiveStrength {
    emissive_strength: Option<f32>,
}

impl MaterialExtension for EmissiveStrength {
    fn apply(&self, material: &mut Material, _: &mut TextureReader) -> Result<(), String> {
        if let Some(strength) = self.emissive_strength {
            let color = &mut material.emission.color;
            *color = color.map(|x| x * strength.clamp(0.0, f32::MAX.sqrt()));
        }
        Ok(())
    }
}
