//! Extensions of glTF files. An extension of materials is one file here and one entry in
//! [`MATERIAL_EXTENSIONS`].

mod anisotropy;
mod clearcoat;
mod emissive_strength;
mod ior;
mod sheen;
mod specular;

use super::textures::{TextureReader, TextureReference};
use crate::instrument::scene::material::Material;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

/// The extension of direct lights.
pub const LIGHTS: &str = "KHR_lights_punctual";

/// Extensions that are read, besides [`MATERIAL_EXTENSIONS`].
const OTHER_EXTENSIONS: [&str; 4] = [
    "EXT_texture_webp",
    LIGHTS,
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

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

    /// Names a value that its specification excludes, and how it is read.
    fn odd_value(&self) -> Option<&'static str> {
        None
    }

    /// Whether it refers to the tangent space of the surface.
    fn needs_tangents(&self) -> bool {
        false
    }

    /// Drops maps that a factor of 0 multiplies: their files and texture coordinates do not matter.
    fn drop_maps_without_effect(&mut self) {}

    /// Sets its part of `material`, after the core material and the extensions above it in the
    /// list.
    fn apply(&self, material: &mut Material, textures: &mut TextureReader) -> Result<(), String>;
}

/// An extension of a material, and its members that are not read.
struct Found {
    extension: Box<dyn MaterialExtension>,
    unread: Vec<String>,
}

/// Reads the members of an extension of a material, by its name.
type ExtensionReader = fn(&::gltf::Material, &str) -> Result<Found, String>;

struct MaterialExtensionEntry {
    name: &'static str,
    read: ExtensionReader,
}

/// In the order in which their textures are read and their parts are set.
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
        read: members::<ior::Ior>,
    },
    MaterialExtensionEntry {
        name: specular::NAME,
        read: members::<specular::Specular>,
    },
    MaterialExtensionEntry {
        name: emissive_strength::NAME,
        read: members::<emissive_strength::EmissiveStrength>,
    },
];

fn members<T>(material: &::gltf::Material, name: &str) -> Result<Found, String>
where
    T: MaterialExtension + Default + DeserializeOwned + 'static,
{
    let Some(value) = material.extension_value(name) else {
        return Ok(Found {
            extension: Box::new(T::default()),
            unread: Vec::new(),
        });
    };
    let mut unread = Vec::new();
    let members: Result<T, _> = serde_ignored::deserialize(value, |path| {
        unread.extend(unknown_member(&path).map(|path| format!("{name}.{path}")));
    });
    let mut members = members.map_err(|error| {
        let member = wrong_member::<T>(value).map_or(String::new(), |member| format!(".{member}"));
        format!("{name}{member}: {error}")
    })?;
    members.drop_maps_without_effect();
    Ok(Found {
        extension: Box::new(members),
        unread,
    })
}

/// Returns a member that nothing reads; `None` for data of applications and extensions, which the
/// file may have anywhere.
pub fn unknown_member(path: &serde_ignored::Path) -> Option<String> {
    let path = path.to_string();
    let is_extra = path
        .split('.')
        .any(|part| matches!(part, "extras" | "extensions"));
    (!is_extra).then_some(path)
}

/// Finds the member that does not deserialize, not even alone: all members have defaults.
fn wrong_member<T: DeserializeOwned>(value: &Value) -> Option<&str> {
    let members = value.as_object()?;
    let is_wrong = |name: &&String| {
        let alone = json!({ name.as_str(): members[name.as_str()] });
        T::deserialize(alone).is_err()
    };
    members.keys().find(is_wrong).map(String::as_str)
}

/// The extensions of a material, and their members that are not read.
#[derive(Default)]
pub struct MaterialExtensions {
    pub read: Vec<Box<dyn MaterialExtension>>,
    /// As `KHR_materials_sheen.sheenColor`.
    pub unread_members: Vec<String>,
}

/// Reads every extension of a material.
pub fn of_material(material: &::gltf::Material) -> Result<MaterialExtensions, String> {
    let mut extensions = MaterialExtensions::default();
    for entry in MATERIAL_EXTENSIONS {
        let Found { extension, unread } = (entry.read)(material, entry.name)?;
        extensions.read.push(extension);
        extensions.unread_members.extend(unread);
    }
    Ok(extensions)
}

/// Whether the effects of an extension are read.
pub fn is_read(name: &str) -> bool {
    OTHER_EXTENSIONS.contains(&name) || MATERIAL_EXTENSIONS.iter().any(|entry| entry.name == name)
}
