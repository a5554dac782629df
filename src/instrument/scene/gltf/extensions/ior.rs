//! `KHR_materials_ior`: f0 = ((ior - 1) / (ior + 1))². Without it f0 is 0.04.

use super::MaterialExtension;
use crate::instrument::brdf;
use crate::instrument::scene::gltf::textures::TextureReader;
use crate::instrument::scene::material::Material;
use serde::Deserialize;

pub const NAME: &str = "KHR_materials_ior";

#[derive(Default, Deserialize)]
#[serde(default, expecting = "an object")]
pub struct Ior {
    ior: Option<f32>,
}

impl MaterialExtension for Ior {
    fn odd_value(&self) -> Option<&'static str> {
        // 0 stands for an F0 of 1.
        let is_odd = self.ior.is_some_and(|ior| ior < 1.0 && ior != 0.0);
        is_odd.then_some("an index of refraction below 1 (read as its inverse, negative ones as 0)")
    }

    fn apply(&self, material: &mut Material, _: &mut TextureReader) -> Result<(), String> {
        if let Some(ior) = self.ior {
            material.f0 = [brdf::f0_from_ior(f64::from(ior.max(0.0))) as f32; 3];
        }
        Ok(())
    }
}
