//! Materials of glTF files.
//!
//! | read | becomes | without it |
//! |---|---|---|
//! | `baseColorFactor` rgb, `baseColorTexture` rgb (sRGB) | albedo, albedo map | white |
//! | `metallicFactor`, `metallicRoughnessTexture` blue | metallic, metallic map | 1 |
//! | `roughnessFactor`, `metallicRoughnessTexture` green | alpha = roughness², roughness map | 1 |
//! | `normalTexture` with `scale` | normal map | none |
//! | `doubleSided` | whether backs are seen | they are not |
//! | `KHR_materials_ior` | f0 = ((ior - 1) / (ior + 1))² | 0.04 |
//! | `KHR_materials_anisotropy` | strength; turn of the tangent; map of directions, texture red, green, blue | 0 |
//! | `KHR_materials_sheen` | sheen: colour factor, texture (sRGB); roughness factor², texture alpha | none |
//! | `KHR_materials_clearcoat` | coat: factor, texture red; roughness factor², texture green; normals | none |
//!
//! Factors are clamped to [0, 1]. The maps of a material share one set of texture coordinates and
//! one `KHR_texture_transform` \[KhrTransform18\]; they repeat, clamp or mirror by their samplers
//! and are filtered trilinearly.

use super::buffers::{Buffers, resource};
use super::name;
use crate::base::glsl::constants::ALPHA_MIN;
use crate::base::pixels::lookup::{Edge, Wrap};
use crate::instrument::brdf;
use crate::instrument::scene::maps::{Maps, Meaning};
use crate::instrument::scene::material::{Anisotropy, Coat, Material, Sheen};
use crate::instrument::scene::source::SceneFiles;
use ::gltf::image::Source;
use ::gltf::json::extensions::texture::TextureTransform;
use ::gltf::material::AlphaMode;
use ::gltf::texture::{Info, MagFilter, Texture, WrappingMode};
use glam::{DAffine2, DVec2, Vec2};
use serde::Deserialize;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

const ANISOTROPY: &str = "KHR_materials_anisotropy";
const CLEARCOAT: &str = "KHR_materials_clearcoat";
const SHEEN: &str = "KHR_materials_sheen";

/// An extension's members; the crate has none of its own.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase", expecting = "an object")]
struct Stretched {
    anisotropy_strength: f32,
    anisotropy_rotation: f32,
    anisotropy_texture: Option<Map>,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase", expecting = "an object")]
struct Clearcoat {
    clearcoat_factor: f32,
    clearcoat_texture: Option<Map>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<Map>,
    clearcoat_normal_texture: Option<Map>,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase", expecting = "an object")]
struct Cloth {
    sheen_color_factor: [f32; 3],
    sheen_color_texture: Option<Map>,
    sheen_roughness_factor: f32,
    sheen_roughness_texture: Option<Map>,
}

struct Extensions {
    anisotropy: Stretched,
    coat: Clearcoat,
    sheen: Cloth,
}

impl Extensions {
    fn maps(&self) -> impl Iterator<Item = &Map> {
        let Clearcoat {
            clearcoat_texture,
            clearcoat_roughness_texture,
            clearcoat_normal_texture,
            ..
        } = &self.coat;
        let direction = &self.anisotropy.anisotropy_texture;
        let Cloth {
            sheen_color_texture,
            sheen_roughness_texture,
            ..
        } = &self.sheen;
        let coat = [
            clearcoat_texture,
            clearcoat_roughness_texture,
            clearcoat_normal_texture,
        ];
        coat.into_iter()
            .chain([direction, sheen_color_texture, sheen_roughness_texture])
            .flatten()
    }
}

/// Reads the members of an extension; without it they have their defaults.
fn extension<T: Default + serde::de::DeserializeOwned>(
    material: &::gltf::Material,
    name: &str,
) -> Result<T, String> {
    let members = material
        .extension_value(name)
        .map(T::deserialize)
        .transpose();
    Ok(members
        .map_err(|error| format!("{name} of its material: {error}"))?
        .unwrap_or_default())
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", expecting = "an object")]
struct Map {
    index: usize,
    #[serde(default)]
    tex_coord: u32,
    /// Of normals.
    scale: Option<f32>,
    #[serde(default)]
    extensions: ::gltf::json::extensions::texture::Info,
}

/// The used materials, in order of first use.
#[derive(Default)]
pub struct Materials<'a> {
    used: Vec<::gltf::Material<'a>>,
    extensions: Vec<Extensions>,
    slots: HashMap<Option<usize>, usize>,
}

impl<'a> Materials<'a> {
    /// Returns a material's index and adds it at its first use.
    pub fn slot(&mut self, material: &::gltf::Material<'a>) -> Result<usize, String> {
        if let Some(slot) = self.slots.get(&material.index()) {
            return Ok(*slot);
        }
        let (anisotropy, coat) = (
            extension(material, ANISOTROPY)?,
            extension(material, CLEARCOAT)?,
        );
        self.extensions.push(Extensions {
            anisotropy,
            coat,
            sheen: extension(material, SHEEN)?,
        });
        self.used.push(material.clone());
        self.slots.insert(material.index(), self.used.len() - 1);
        Ok(self.used.len() - 1)
    }

    pub fn needs_tangents(&self, slot: usize) -> bool {
        let Extensions {
            anisotropy, coat, ..
        } = &self.extensions[slot];
        let is_stretched = anisotropy.anisotropy_strength > 0.0;
        self.used[slot].normal_texture().is_some()
            || coat.clearcoat_normal_texture.is_some()
            || is_stretched
    }

    pub fn has_maps(&self, slot: usize) -> bool {
        let (material, factors) = (&self.used[slot], self.used[slot].pbr_metallic_roughness());
        let maps = [
            factors.base_color_texture(),
            factors.metallic_roughness_texture(),
        ];
        maps.iter().any(Option::is_some)
            || material.normal_texture().is_some()
            || self.extensions[slot].maps().next().is_some()
    }

    /// Returns the texture coordinate set of a material's maps, and its transform.
    pub fn mapping(&self, slot: usize) -> Result<(u32, DAffine2), String> {
        let (material, factors) = (&self.used[slot], self.used[slot].pbr_metallic_roughness());
        let own = |info: Info| {
            let transform = info.texture_transform();
            let set = transform
                .as_ref()
                .and_then(|transform| transform.tex_coord());
            (
                set.unwrap_or(info.tex_coord()),
                transform.map_or(DAffine2::IDENTITY, |t| {
                    affine(t.offset(), t.rotation(), t.scale())
                }),
            )
        };
        let mut mappings: Vec<(u32, DAffine2)> = [
            factors.base_color_texture(),
            factors.metallic_roughness_texture(),
        ]
        .into_iter()
        .flatten()
        .map(own)
        .collect();
        let of_json = |set: u32, transform: Option<&TextureTransform>| {
            let own = transform
                .and_then(|transform| transform.tex_coord)
                .unwrap_or(set);
            (
                own,
                transform.map_or(DAffine2::IDENTITY, |t| {
                    affine(t.offset.0, t.rotation.0, t.scale.0)
                }),
            )
        };
        if let Some(map) = material.normal_texture() {
            // The crate has no accessor for it here.
            let transform = map
                .extension_value("KHR_texture_transform")
                .map(TextureTransform::deserialize);
            let transform = transform
                .transpose()
                .map_err(|error| format!("KHR_texture_transform of its normal map: {error}"))?;
            mappings.push(of_json(map.tex_coord(), transform.as_ref()));
        }
        let of_map = |map: &Map| of_json(map.tex_coord, map.extensions.texture_transform.as_ref());
        mappings.extend(self.extensions[slot].maps().map(of_map));
        let first = mappings.first().copied().unwrap_or((0, DAffine2::IDENTITY));
        match mappings.iter().find(|mapping| **mapping != first) {
            None => Ok(first),
            Some((set, _)) if *set != first.0 => Err(format!(
                "the maps of its material read the texture coordinates {} and {set}; expected one \
                 set",
                first.0
            )),
            Some(_) => Err(
                "the maps of its material have several KHR_texture_transform; expected one"
                    .to_owned(),
            ),
        }
    }

    /// Reads the materials; adds skipped features to `unread`.
    pub fn read(
        &self,
        document: &::gltf::Document,
        buffers: &Buffers,
        path: &Path,
        files: &dyn SceneFiles,
        maps: &mut Maps,
        unread: &mut BTreeSet<String>,
    ) -> Result<Vec<Material>, String> {
        // Materials share images; one image holds roughness and metallic.
        let mut known: Vec<(usize, Meaning, Wrap, usize)> = Vec::new();
        let mut map = |texture: Texture, meaning: Meaning, unread: &mut BTreeSet<String>| {
            let (sampler, image) = (texture.sampler(), texture.source());
            let wrap = Wrap(edge(sampler.wrap_s()), edge(sampler.wrap_t()));
            if sampler.mag_filter() == Some(MagFilter::Nearest) {
                unread.insert("nearest filters".to_owned());
            }
            let key = (image.index(), meaning, wrap);
            if let Some((.., index)) = known
                .iter()
                .find(|(image, meaning, wrap, _)| (*image, *meaning, *wrap) == key)
            {
                return Ok(*index);
            }
            let (bytes, file) = match image.source() {
                Source::View { view, .. } => (buffers.view(&view).map(<[u8]>::to_vec), None),
                Source::Uri { uri, .. } => (
                    resource(uri, path, files),
                    Some(uri).filter(|uri| !uri.starts_with("data:")),
                ),
            };
            let bytes = bytes.map_err(|error| format!("image {}: {error}", image.index()))?;
            let index = maps.add(&bytes, meaning, wrap);
            let index = index.map_err(|error| {
                format!(
                    "{}: {error}",
                    name("image", file.or(image.name()), image.index())
                )
            })?;
            known.push((image.index(), meaning, wrap, index));
            Ok::<usize, String>(index)
        };
        let mut materials = Vec::new();
        for (
            material,
            Extensions {
                anisotropy,
                coat,
                sheen,
            },
        ) in self.used.iter().zip(&self.extensions)
        {
            let factors = material.pbr_metallic_roughness();
            let (albedo, surface) = (
                factors.base_color_texture(),
                factors.metallic_roughness_texture(),
            );
            let albedo_map = albedo
                .map(|info| map(info.texture(), Meaning::Color, unread))
                .transpose()?;
            let surface_map = surface
                .map(|info| map(info.texture(), Meaning::Linear, unread))
                .transpose()?;
            let normal = material.normal_texture();
            let scaled = |info: ::gltf::material::NormalTexture<'a>| {
                map(
                    info.texture(),
                    Meaning::Normal {
                        scale: info.scale(),
                    },
                    unread,
                )
            };
            let normal_map = normal.map(scaled).transpose()?;
            let rgb = factors.base_color_factor();
            let unit = [
                factors.metallic_factor(),
                factors.roughness_factor(),
                anisotropy.anisotropy_strength,
            ];
            let layers = [
                coat.clearcoat_factor,
                coat.clearcoat_roughness_factor,
                sheen.sheen_roughness_factor,
            ];
            let mut all = unit
                .iter()
                .chain(&layers)
                .chain(&rgb)
                .chain(&sheen.sheen_color_factor);
            let is_left_out = [
                (
                    "factors outside [0, 1] (clamped)",
                    all.any(|factor| !(0.0..=1.0).contains(factor)),
                ),
                ("emission", material.emissive_factor() != [0.0; 3]),
                ("occlusion", material.occlusion_texture().is_some()),
                ("transparency", material.alpha_mode() != AlphaMode::Opaque),
            ];
            unread.extend(
                is_left_out
                    .iter()
                    .filter(|(_, is_there)| *is_there)
                    .map(|(name, _)| (*name).to_owned()),
            );
            let mut map_of =
                |extension: &str, texture: &Option<Map>, meaning: fn(f32) -> Meaning| {
                    let Some(Map { index, scale, .. }) = texture else {
                        return Ok(None);
                    };
                    let texture = document.textures().nth(*index);
                    let texture = texture
                        .ok_or_else(|| format!("{extension}: there is no texture {index}"))?;
                    map(texture, meaning(scale.unwrap_or(1.0)), unread).map(Some)
                };
            let anisotropy = Anisotropy {
                strength: anisotropy.anisotropy_strength.clamp(0.0, 1.0),
                turn: anisotropy.anisotropy_rotation,
                map: map_of(ANISOTROPY, &anisotropy.anisotropy_texture, |_| {
                    Meaning::Direction
                })?,
                is_shown: false,
            };
            let coat_alpha = f64::from(coat.clearcoat_roughness_factor.clamp(0.0, 1.0));
            let coat = Coat {
                weight: coat.clearcoat_factor.clamp(0.0, 1.0),
                weight_map: map_of(CLEARCOAT, &coat.clearcoat_texture, |_| Meaning::Linear)?,
                alpha: (brdf::alpha_from_perceptual_roughness(coat_alpha) as f32).max(ALPHA_MIN),
                roughness_map: map_of(CLEARCOAT, &coat.clearcoat_roughness_texture, |_| {
                    Meaning::Linear
                })?,
                normal_map: map_of(CLEARCOAT, &coat.clearcoat_normal_texture, |scale| {
                    Meaning::Normal { scale }
                })?,
            };
            let sheen_roughness = f64::from(sheen.sheen_roughness_factor.clamp(0.0, 1.0));
            let sheen = Sheen {
                color: sheen.sheen_color_factor.map(|x| x.clamp(0.0, 1.0)),
                color_map: map_of(SHEEN, &sheen.sheen_color_texture, |_| Meaning::Color)?,
                alpha: brdf::alpha_from_perceptual_roughness(sheen_roughness)
                    .max(brdf::SHEEN_ALPHA_MIN) as f32,
                roughness_map: map_of(SHEEN, &sheen.sheen_roughness_texture, |_| Meaning::Alpha)?,
            };
            let [red, green, blue, _] = rgb.map(|x| x.clamp(0.0, 1.0));
            let alpha = brdf::alpha_from_perceptual_roughness(f64::from(
                factors.roughness_factor().clamp(0.0, 1.0),
            ));
            let default = Material::default();
            materials.push(Material {
                name: material.name().unwrap_or("unnamed").to_owned(),
                albedo: [red, green, blue],
                albedo_map,
                metallic: factors.metallic_factor().clamp(0.0, 1.0),
                metallic_map: surface_map,
                alpha: (alpha as f32).max(ALPHA_MIN),
                roughness_map: surface_map,
                f0: material.ior().map_or(default.f0, |ior| {
                    [brdf::f0_from_ior(f64::from(ior.max(0.0))) as f32; 3]
                }),
                normal_map,
                anisotropy,
                coat,
                sheen,
                is_one_sided: !material.double_sided(),
            });
        }
        Ok(materials)
    }
}

fn edge(mode: WrappingMode) -> Edge {
    match mode {
        WrappingMode::ClampToEdge => Edge::Clamp,
        WrappingMode::MirroredRepeat => Edge::Mirror,
        WrappingMode::Repeat => Edge::Repeat,
    }
}

/// Scales, rotates counter-clockwise as v grows downward, and moves, as in the extension's example.
fn affine(offset: [f32; 2], rotation: f32, scale: [f32; 2]) -> DAffine2 {
    let [offset, scale] = [offset, scale].map(|pair| Vec2::from_array(pair).as_dvec2());
    DAffine2::from_scale_angle_translation(DVec2::ONE, -f64::from(rotation), offset)
        * DAffine2::from_scale(scale)
}
