//! Textures of materials, and the texture coordinates that they read.

use super::buffers::{Buffers, resource};
use super::name;
use crate::base::pixels::lookup::{Edge, Wrap};
use crate::instrument::scene::maps::{Maps, Meaning};
use crate::instrument::scene::source::SceneFiles;
use ::gltf::Document;
use ::gltf::image::{Image, Source};
use ::gltf::json::extensions::texture::TextureTransform;
use ::gltf::material::{NormalTexture, OcclusionTexture};
use ::gltf::texture::{Info, MagFilter, Texture, WrappingMode};
use glam::{DAffine2, DVec2, Vec2};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

const TEXTURE_TRANSFORM: &str = "KHR_texture_transform";

/// A texture in the members of an extension.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase", expecting = "an object")]
pub struct TextureReference {
    index: usize,
    #[serde(default)]
    tex_coord: u32,
    scale: Option<f32>,
    #[serde(default)]
    extensions: ::gltf::json::extensions::texture::Info,
}

impl TextureReference {
    /// Returns the factor of x and y of a map of normals.
    pub fn scale(&self) -> f32 {
        self.scale.unwrap_or(1.0)
    }
}

/// Which texture coordinates a map reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapping {
    /// Number of the set of texture coordinates.
    pub set: u32,
    pub transform: DAffine2,
}

impl Default for Mapping {
    fn default() -> Self {
        Self {
            set: 0,
            transform: DAffine2::IDENTITY,
        }
    }
}

impl Mapping {
    pub fn of_info(info: &Info) -> Self {
        let Some(transform) = info.texture_transform() else {
            return Self::new(info.tex_coord(), None);
        };
        Self {
            set: transform.tex_coord().unwrap_or(info.tex_coord()),
            transform: affine(transform.offset(), transform.rotation(), transform.scale()),
        }
    }

    /// Reads the mapping of a normal map, whose transform the crate `gltf` leaves unread.
    pub fn of_normal_map(map: &NormalTexture) -> Result<Self, String> {
        let transform = map.extension_value(TEXTURE_TRANSFORM);
        Self::with_transform("normal", map.tex_coord(), transform)
    }

    /// As [`Mapping::of_normal_map`], for a map of occlusion.
    pub fn of_occlusion_map(map: &OcclusionTexture) -> Result<Self, String> {
        let transform = map.extension_value(TEXTURE_TRANSFORM);
        Self::with_transform("occlusion", map.tex_coord(), transform)
    }

    fn with_transform(kind: &str, set: u32, transform: Option<&Value>) -> Result<Self, String> {
        let transform = transform
            .map(TextureTransform::deserialize)
            .transpose()
            .map_err(|error| format!("{TEXTURE_TRANSFORM} of its {kind} map: {error}"))?;
        Ok(Self::new(set, transform.as_ref()))
    }

    pub fn of_reference(reference: &TextureReference) -> Self {
        let transform = reference.extensions.texture_transform.as_ref();
        Self::new(reference.tex_coord, transform)
    }

    fn new(set: u32, transform: Option<&TextureTransform>) -> Self {
        let Some(transform) = transform else {
            return Self {
                set,
                ..Self::default()
            };
        };
        Self {
            set: transform.tex_coord.unwrap_or(set),
            transform: affine(transform.offset.0, transform.rotation.0, transform.scale.0),
        }
    }
}

/// Scales, rotates counter-clockwise as v grows downward, and moves, as in the extension's example.
fn affine(offset: [f32; 2], rotation: f32, scale: [f32; 2]) -> DAffine2 {
    let offset = Vec2::from_array(offset).as_dvec2();
    let scale = Vec2::from_array(scale).as_dvec2();
    DAffine2::from_scale_angle_translation(DVec2::ONE, -f64::from(rotation), offset)
        * DAffine2::from_scale(scale)
}

/// A texture that was read before.
struct KnownTexture {
    image: usize,
    meaning: Meaning,
    wrap: Wrap,
    /// Index into `Scene::textures`.
    index: usize,
}

/// Reads the textures of materials, each once: materials share images, and one image holds
/// roughness and metallic.
pub struct TextureReader<'r> {
    document: &'r Document,
    buffers: &'r Buffers<'r>,
    path: &'r Path,
    files: &'r dyn SceneFiles,
    maps: Maps,
    known: Vec<KnownTexture>,
    /// Receives the skipped features.
    unread: &'r mut BTreeSet<String>,
}

impl<'r> TextureReader<'r> {
    pub fn new(
        document: &'r Document,
        buffers: &'r Buffers<'r>,
        path: &'r Path,
        files: &'r dyn SceneFiles,
        unread: &'r mut BTreeSet<String>,
    ) -> Self {
        Self {
            document,
            buffers,
            path,
            files,
            maps: Maps::default(),
            known: Vec::new(),
            unread,
        }
    }

    pub fn into_maps(self) -> Maps {
        self.maps
    }

    /// Returns the index of a texture in `Scene::textures`.
    pub fn map(&mut self, texture: &Texture, meaning: Meaning) -> Result<usize, String> {
        let sampler = texture.sampler();
        if sampler.mag_filter() == Some(MagFilter::Nearest) {
            self.unread.insert("nearest filters".to_owned());
        }
        let wrap = Wrap(edge(sampler.wrap_s()), edge(sampler.wrap_t()));
        let image = texture.source();
        let known = self.known.iter().find(|known| {
            known.image == image.index() && known.meaning == meaning && known.wrap == wrap
        });
        if let Some(known) = known {
            return Ok(known.index);
        }
        let bytes = self.image_bytes(&image)?;
        let index = self.maps.add(&bytes, meaning, wrap).map_err(|error| {
            let file = image_file(&image).or(image.name());
            format!("{}: {error}", name("image", file, image.index()))
        })?;
        self.known.push(KnownTexture {
            image: image.index(),
            meaning,
            wrap,
            index,
        });
        Ok(index)
    }

    /// Returns the index of a texture that an extension names.
    pub fn extension_map(
        &mut self,
        extension: &str,
        reference: &Option<TextureReference>,
        meaning: Meaning,
    ) -> Result<Option<usize>, String> {
        let Some(TextureReference { index, .. }) = reference else {
            return Ok(None);
        };
        let texture = self
            .document
            .textures()
            .nth(*index)
            .ok_or_else(|| format!("{extension}: there is no texture {index}"))?;
        self.map(&texture, meaning).map(Some)
    }

    fn image_bytes(&self, image: &Image) -> Result<Vec<u8>, String> {
        let bytes = match image.source() {
            Source::View { view, .. } => self.buffers.view(&view).map(<[u8]>::to_vec),
            Source::Uri { uri, .. } => resource(uri, self.path, self.files),
        };
        bytes.map_err(|error| format!("image {}: {error}", image.index()))
    }
}

/// Returns the name of an image's file; `None` for an image inside the scene's files.
fn image_file<'a>(image: &Image<'a>) -> Option<&'a str> {
    match image.source() {
        Source::View { .. } => None,
        Source::Uri { uri, .. } => Some(uri).filter(|uri| !uri.starts_with("data:")),
    }
}

fn edge(mode: WrappingMode) -> Edge {
    match mode {
        WrappingMode::ClampToEdge => Edge::Clamp,
        WrappingMode::MirroredRepeat => Edge::Mirror,
        WrappingMode::Repeat => Edge::Repeat,
    }
}
