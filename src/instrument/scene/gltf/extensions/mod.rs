//! Extensions of glTF files. An extension of materials is one file here and one entry in
//! [`MATERIAL_EXTENSIONS`].

mod anisotropy;
mod clearcoat;
mod ior;
mod sheen;

use super::textures::{TextureReader, TextureReference};
use crate::instrument::scene::material::Material;
use serde::de::DeserializeOwned;

/// Extensions that are read, besides [`MATERIAL_EXTENSIONS`].
const OTHER_EXTENSIONS: [&str; 2] = ["KHR_mesh_quantization", "KHR_texture_transform"];

/// What an extension states about one material. A material without the extension has its defaults.
pub trait MaterialExtension {
    /// Lists its textures, which share the texture coordinates of the material's other maps.
    fn textures(&self) -> Vec<&TextureReference> {
        Vec::new()
    }

    /// Lists the factors that its specification limits to [0, 1].
    fn factors(&self) -> Vec<f32> {
        Vec::new()
    }

    /// Whether it refers to the tangent space of the surface.
    fn needs_tangents(&self) -> bool {
        false
    }

    /// Sets its part of `material`.
    fn apply(&self, material: &mut Material, textures: &mut TextureReader) -> Result<(), String>;
}

/// Reads the members of an extension of a material; the text names the material in messages.
type ExtensionReader = fn(&::gltf::Material, &str) -> Result<Box<dyn MaterialExtension>, String>;

struct MaterialExtensionEntry {
    name: &'static str,
    read: ExtensionReader,
}

/// In the order in which their textures are read.
static MATERIAL_EXTENSIONS: &[MaterialExtensionEntry] = &[
    MaterialExtensionEntry {
        name: anisotropy::NAME,
        read: members::<anisotropy::Anisotropy>,
    },
    MaterialExtensionEntry {
        name: clearcoat::NAME,
        read: members::<clearcoat::Clearcoat>,
    },
    MaterialExtensionEntry {
        name: sheen::NAME,
        read: members::<sheen::Sheen>,
    },
    MaterialExtensionEntry {
        name: ior::NAME,
        read: |material, _| Ok(Box::new(ior::Ior::new(material))),
    },
];

/// Reads the members of an extension that the crate `gltf` does not know.
fn members<T>(material: &::gltf::Material, name: &str) -> Result<Box<dyn MaterialExtension>, String>
where
    T: MaterialExtension + Default + DeserializeOwned + 'static,
{
    let members = material
        .extension_value(name)
        .map(T::deserialize)
        .transpose()
        .map_err(|error| format!("{name} of its material: {error}"))?;
    Ok(Box::new(members.unwrap_or_default()))
}

/// Reads every extension of a material.
pub fn of_material(material: &::gltf::Material) -> Result<Vec<Box<dyn MaterialExtension>>, String> {
    MATERIAL_EXTENSIONS
        .iter()
        .map(|entry| (entry.read)(material, entry.name))
        .collect()
}

/// Whether the effects of an extension are read.
pub fn is_read(name: &str) -> bool {
    OTHER_EXTENSIONS.contains(&name) || MATERIAL_EXTENSIONS.iter().any(|entry| entry.name == name)
}

/// Whether a file that requires an extension can be read.
pub fn is_accepted(name: &str) -> bool {
    // Lights do not change what the environment does.
    is_read(name) || name == "KHR_lights_punctual"
}
