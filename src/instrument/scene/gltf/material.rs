//! Materials of glTF files.
//!
//! | read | becomes | without it |
//! |---|---|---|
//! | `baseColorFactor` rgb, `baseColorTexture` rgb (sRGB) | albedo, albedo map | white |
//! | `metallicFactor`, `metallicRoughnessTexture` blue | metallic, metallic map | 1 |
//! | `roughnessFactor`, `metallicRoughnessTexture` green | alpha = roughness², roughness map | 1 |
//! | `normalTexture` with `scale` | normal map | none |
//! | `doubleSided` | whether backs are visible | they are not |
//!
//! The modules of [`extensions`](super::extensions) add their parts.
//!
//! Factors are clamped to [0, 1]. The maps of a material share one set of texture coordinates and
//! one `KHR_texture_transform` \[KhrTransform18\]; they repeat, clamp or mirror by their samplers
//! and are filtered trilinearly.

use super::extensions::{self, MaterialExtension};
use super::textures::{Mapping, TextureReader, TextureReference};
use crate::base::glsl::constants::ALPHA_MIN;
use crate::instrument::brdf;
use crate::instrument::scene::maps::Meaning;
use crate::instrument::scene::material::Material;
use ::gltf::material::AlphaMode;
use std::collections::HashMap;

/// The used materials, in order of first use.
#[derive(Default)]
pub struct Materials<'a> {
    used: Vec<UsedMaterial<'a>>,
    slots: HashMap<Option<usize>, usize>,
}

impl<'a> Materials<'a> {
    /// Returns a material's index and adds it at its first use.
    pub fn slot(&mut self, material: &::gltf::Material<'a>) -> Result<usize, String> {
        if let Some(slot) = self.slots.get(&material.index()) {
            return Ok(*slot);
        }
        let slot = self.used.len();
        self.used.push(UsedMaterial {
            material: material.clone(),
            extensions: extensions::of_material(material)?,
        });
        self.slots.insert(material.index(), slot);
        Ok(slot)
    }

    pub fn get(&self, slot: usize) -> &UsedMaterial<'a> {
        &self.used[slot]
    }

    /// Reads the materials and their textures.
    pub fn read(&self, textures: &mut TextureReader) -> Result<Vec<Material>, String> {
        self.used
            .iter()
            .map(|material| material.read(textures))
            .collect()
    }

    /// Names the features of the materials that are skipped or changed.
    pub fn unread(&self) -> impl Iterator<Item = &'static str> {
        self.used.iter().flat_map(UsedMaterial::unread)
    }
}

pub struct UsedMaterial<'a> {
    material: ::gltf::Material<'a>,
    extensions: Vec<Box<dyn MaterialExtension>>,
}

impl UsedMaterial<'_> {
    pub fn needs_tangents(&self) -> bool {
        self.material.normal_texture().is_some()
            || self
                .extensions
                .iter()
                .any(|extension| extension.needs_tangents())
    }

    pub fn has_maps(&self) -> bool {
        let base = self.material.pbr_metallic_roughness();
        base.base_color_texture().is_some()
            || base.metallic_roughness_texture().is_some()
            || self.material.normal_texture().is_some()
            || self.extension_textures().next().is_some()
    }

    fn extension_textures(&self) -> impl Iterator<Item = &TextureReference> {
        self.extensions
            .iter()
            .flat_map(|extension| extension.textures())
    }

    /// Returns the mapping that all maps of the material share.
    pub fn mapping(&self) -> Result<Mapping, String> {
        let mappings = self.mappings()?;
        let Some(first) = mappings.first().copied() else {
            return Ok(Mapping::default());
        };
        match mappings.iter().find(|mapping| **mapping != first) {
            None => Ok(first),
            Some(other) if other.set != first.set => Err(format!(
                "the maps of its material read the texture coordinates {} and {}; expected one set",
                first.set, other.set
            )),
            Some(_) => Err(
                "the maps of its material have several KHR_texture_transform; expected one"
                    .to_owned(),
            ),
        }
    }

    fn mappings(&self) -> Result<Vec<Mapping>, String> {
        let base = self.material.pbr_metallic_roughness();
        let mut mappings = Vec::new();
        if let Some(albedo) = base.base_color_texture() {
            mappings.push(Mapping::of_info(&albedo));
        }
        if let Some(surface) = base.metallic_roughness_texture() {
            mappings.push(Mapping::of_info(&surface));
        }
        if let Some(normals) = self.material.normal_texture() {
            mappings.push(Mapping::of_normal_map(&normals)?);
        }
        mappings.extend(self.extension_textures().map(Mapping::of_reference));
        Ok(mappings)
    }

    fn read(&self, textures: &mut TextureReader) -> Result<Material, String> {
        let base = self.material.pbr_metallic_roughness();
        let albedo_map = base
            .base_color_texture()
            .map(|info| textures.map(&info.texture(), Meaning::Color))
            .transpose()?;
        let surface_map = base
            .metallic_roughness_texture()
            .map(|info| textures.map(&info.texture(), Meaning::Linear))
            .transpose()?;
        let normal_map = self
            .material
            .normal_texture()
            .map(|info| {
                let scale = info.scale();
                textures.map(&info.texture(), Meaning::Normal { scale })
            })
            .transpose()?;
        let [red, green, blue, _] = base.base_color_factor().map(|x| x.clamp(0.0, 1.0));
        let roughness = f64::from(base.roughness_factor().clamp(0.0, 1.0));
        let alpha = brdf::alpha_from_perceptual_roughness(roughness) as f32;
        let mut material = Material {
            name: self.material.name().unwrap_or("unnamed").to_owned(),
            albedo: [red, green, blue],
            albedo_map,
            metallic: base.metallic_factor().clamp(0.0, 1.0),
            metallic_map: surface_map,
            alpha: alpha.max(ALPHA_MIN),
            roughness_map: surface_map,
            normal_map,
            is_one_sided: !self.material.double_sided(),
            ..Material::default()
        };
        for extension in &self.extensions {
            extension.apply(&mut material, textures)?;
        }
        Ok(material)
    }

    /// Lists the factors that must lie in [0, 1].
    fn factors(&self) -> impl Iterator<Item = f32> {
        let base = self.material.pbr_metallic_roughness();
        let of_extensions = self
            .extensions
            .iter()
            .flat_map(|extension| extension.factors());
        [base.metallic_factor(), base.roughness_factor()]
            .into_iter()
            .chain(base.base_color_factor())
            .chain(of_extensions)
    }

    fn unread(&self) -> Vec<&'static str> {
        let mut unread = Vec::new();
        if self.factors().any(|factor| !(0.0..=1.0).contains(&factor)) {
            unread.push("factors outside [0, 1] (clamped)");
        }
        if self.material.emissive_factor() != [0.0; 3] {
            unread.push("emission");
        }
        if self.material.occlusion_texture().is_some() {
            unread.push("occlusion");
        }
        if self.material.alpha_mode() != AlphaMode::Opaque {
            unread.push("transparency");
        }
        unread
    }
}
