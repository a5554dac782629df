//! Materials of glTF files.
//!
//! | read | becomes | without it |
//! |---|---|---|
//! | `baseColorFactor` rgb, `baseColorTexture` rgb (sRGB) | albedo, albedo map | white |
//! | `metallicFactor`, `metallicRoughnessTexture` blue | metallic, metallic map | 1 |
//! | `roughnessFactor`, `metallicRoughnessTexture` green | alpha = roughness², roughness map | 1 |
//! | `normalTexture` with `scale` | normal map | none |
//! | `emissiveFactor`, `emissiveTexture` rgb (sRGB) | emission | black |
//! | `occlusionTexture` red with `strength` | occlusion map | none |
//! | `doubleSided` | whether backs are visible | they are not |
//!
//! The modules of [`extensions`](super::extensions) add their parts.
//!
//! Factors are clamped to [0, 1]; a map that a factor of 0 multiplies is not read. The maps of a
//! material share one set of texture coordinates and
//! one `KHR_texture_transform` \[KhrTransform18\]; they repeat, clamp or mirror by their samplers
//! and are filtered trilinearly.

use super::extensions::{self, MaterialExtension, MaterialExtensions};
use super::name;
use super::textures::{Mapping, TextureReader, TextureReference};
use crate::base::glsl::constants::ALPHA_MIN;
use crate::instrument::brdf;
use crate::instrument::scene::maps::Meaning;
use crate::instrument::scene::material::{Emission, Material};
use ::gltf::material::{AlphaMode, NormalTexture, OcclusionTexture, PbrMetallicRoughness};
use ::gltf::texture::Info;
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
        let MaterialExtensions {
            read: extensions,
            unread_members,
        } = extensions::of_material(material)
            .map_err(|error| format!("{}: {error}", title(material)))?;
        self.used.push(UsedMaterial {
            material: material.clone(),
            extensions,
            unread_members,
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

    /// Returns a warning for each material with members that are not read; `core` has such members
    /// of the core material, by the material's index.
    pub fn unread_members(&self, core: &[Vec<String>]) -> impl Iterator<Item = String> {
        self.used.iter().filter_map(|used| {
            let index = used.material.index();
            let core = index.and_then(|index| core.get(index));
            let members: Vec<&str> = core
                .into_iter()
                .flatten()
                .chain(&used.unread_members)
                .map(String::as_str)
                .collect();
            (!members.is_empty()).then(|| {
                format!(
                    "{}: unknown members are not read: {}",
                    title(&used.material),
                    members.join(", ")
                )
            })
        })
    }

    /// Names the features of the materials that are skipped or changed.
    pub fn unread(&self) -> impl Iterator<Item = &'static str> {
        self.used.iter().flat_map(UsedMaterial::unread)
    }
}

pub struct UsedMaterial<'a> {
    material: ::gltf::Material<'a>,
    extensions: Vec<Box<dyn MaterialExtension>>,
    /// Members of its extensions.
    unread_members: Vec<String>,
}

/// Names a material: `material 1 ("paint")`.
fn title(material: &::gltf::Material) -> String {
    material.index().map_or_else(
        || "the default material".to_owned(),
        |index| name("material", material.name(), index),
    )
}

impl<'a> UsedMaterial<'a> {
    pub fn needs_tangents(&self) -> bool {
        self.normal_info().is_some()
            || self
                .extensions
                .iter()
                .any(|extension| extension.needs_tangents())
    }

    pub fn has_maps(&self) -> bool {
        self.albedo_info().is_some()
            || self.surface_info().is_some()
            || self.normal_info().is_some()
            || self.occlusion_info().is_some()
            || self.emission_info().is_some()
            || self.extension_textures().next().is_some()
    }

    fn base(&self) -> PbrMetallicRoughness<'a> {
        self.material.pbr_metallic_roughness()
    }

    fn albedo_info(&self) -> Option<Info<'a>> {
        let [red, green, blue, _] = self.base().base_color_factor();
        let has_effect = [red, green, blue].iter().any(|factor| *factor > 0.0);
        self.base().base_color_texture().filter(|_| has_effect)
    }

    fn surface_info(&self) -> Option<Info<'a>> {
        let base = self.base();
        let has_effect = base.metallic_factor() > 0.0 || base.roughness_factor() > 0.0;
        base.metallic_roughness_texture().filter(|_| has_effect)
    }

    fn emission_info(&self) -> Option<Info<'a>> {
        let factor = self.material.emissive_factor();
        let has_effect = factor.iter().any(|factor| *factor > 0.0);
        self.material.emissive_texture().filter(|_| has_effect)
    }

    fn normal_info(&self) -> Option<NormalTexture<'a>> {
        self.material
            .normal_texture()
            .filter(|map| map.scale() != 0.0)
    }

    fn occlusion_info(&self) -> Option<OcclusionTexture<'a>> {
        self.material
            .occlusion_texture()
            .filter(|map| map.strength() > 0.0)
    }

    /// Returns the map of occlusion, if it reads the texture coordinates of the other maps.
    fn read_occlusion(&self) -> Result<Option<OcclusionTexture<'a>>, String> {
        let Some(map) = self.occlusion_info() else {
            return Ok(None);
        };
        let own = Mapping::of_occlusion_map(&map)?;
        let is_shared = self.other_mappings()?.iter().all(|other| *other == own);
        Ok(is_shared.then_some(map))
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
        let mut mappings = self.other_mappings()?;
        if let Some(map) = self.read_occlusion()? {
            mappings.push(Mapping::of_occlusion_map(&map)?);
        }
        Ok(mappings)
    }

    /// Returns the mappings of all maps but occlusion, which may have its own.
    fn other_mappings(&self) -> Result<Vec<Mapping>, String> {
        let infos = [
            self.albedo_info(),
            self.surface_info(),
            self.emission_info(),
        ];
        let mut mappings: Vec<Mapping> = infos.iter().flatten().map(Mapping::of_info).collect();
        if let Some(normals) = self.normal_info() {
            mappings.push(Mapping::of_normal_map(&normals)?);
        }
        mappings.extend(self.extension_textures().map(Mapping::of_reference));
        Ok(mappings)
    }

    fn read(&self, textures: &mut TextureReader) -> Result<Material, String> {
        let base = self.base();
        let mut map = |info: Option<Info>, meaning| {
            info.map(|info| textures.map(&info.texture(), meaning))
                .transpose()
        };
        let albedo_map = map(self.albedo_info(), Meaning::Color)?;
        let surface_map = map(self.surface_info(), Meaning::Linear)?;
        let emission_map = map(self.emission_info(), Meaning::Color)?;
        let normal_map = self
            .normal_info()
            .map(|info| {
                let scale = info.scale();
                textures.map(&info.texture(), Meaning::Normal { scale })
            })
            .transpose()?;
        let occlusion_map = self
            .read_occlusion()?
            .map(|map| {
                let strength = map.strength().min(1.0);
                textures.map(&map.texture(), Meaning::Occlusion { strength })
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
            emission: Emission {
                color: self.material.emissive_factor().map(|x| x.clamp(0.0, 1.0)),
                map: emission_map,
            },
            occlusion_map,
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
            .chain(self.material.emissive_factor())
            .chain(self.material.occlusion_texture().map(|map| map.strength()))
            .chain(of_extensions)
    }

    fn unread(&self) -> Vec<&'static str> {
        let mut unread = Vec::new();
        if self.factors().any(|factor| !(0.0..=1.0).contains(&factor)) {
            unread.push("the parts of factors beyond [0, 1]");
        }
        unread.extend(
            self.extensions
                .iter()
                .filter_map(|extension| extension.odd_value()),
        );
        // A broken transform is reported where the maps are read.
        let occlusion = self.read_occlusion();
        if self.occlusion_info().is_some() && occlusion.is_ok_and(|map| map.is_none()) {
            unread.push("occlusion by other texture coordinates than the other maps'");
        }
        if self.material.alpha_mode() != AlphaMode::Opaque {
            unread.push("transparency");
        }
        unread
    }
}
