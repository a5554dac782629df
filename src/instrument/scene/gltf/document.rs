//! From the bytes of a `.glb` or `.gltf` to a document whose indices and fields are checked.

use super::extensions;
use ::gltf::json::{Root, validation::Checked};
use ::gltf::{Document, Glb, Gltf};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// Largest weight of the text, 16 per object and 1 per quotation mark: below 1 GiB, since an object
/// takes up to 1 KiB.
const MAX_TEXT_WEIGHT: usize = 1 << 24;

/// Decides whether the file can be read at all.
#[derive(Deserialize)]
struct Head {
    asset: Asset,
    #[serde(default, rename = "extensionsRequired")]
    required: Vec<String>,
    #[serde(default, rename = "extensionsUsed")]
    used: Vec<String>,
    #[serde(default)]
    materials: Vec<Value>,
    #[serde(default)]
    nodes: Vec<Extended>,
}

/// An object of which only the names of its extensions are read.
#[derive(Deserialize)]
struct Extended {
    #[serde(default)]
    extensions: BTreeMap<String, IgnoredAny>,
}

#[derive(Deserialize)]
struct Asset {
    version: String,
    /// Lowest version that can read the file.
    #[serde(rename = "minVersion")]
    min_version: Option<String>,
    generator: Option<String>,
}

/// Chunk types of a `.glb`.
const JSON_CHUNK: &[u8] = b"JSON";
const BINARY_CHUNK: &[u8] = b"BIN\0";

/// The version that is read.
const READ: &str = "2.0";

/// The extension whose source replaces a texture's.
const WEBP: &str = "EXT_texture_webp";

/// A file's two parts.
struct Container<'b> {
    json: &'b [u8],
    /// The binary part of a `.glb`.
    blob: Option<&'b [u8]>,
    /// Types of the chunks that are not read.
    unread_chunks: Vec<String>,
}

/// A checked document.
pub struct Parsed<'b> {
    pub document: Document,
    /// The binary part of a `.glb`.
    pub blob: Option<&'b [u8]>,
    /// One sentence each.
    pub warnings: Vec<String>,
    /// The program that wrote the file; may be empty.
    pub generator: String,
    /// Members of each core material that are not read.
    pub unread_members: Vec<Vec<String>>,
    /// Extensions of materials and nodes that `extensionsUsed` does not list and that are not read.
    pub unlisted_extensions: Vec<String>,
}

/// Parses and checks a file.
pub fn parse(bytes: &[u8]) -> Result<Parsed<'_>, String> {
    let Container {
        json: text,
        blob,
        unread_chunks,
    } = if bytes.starts_with(b"glTF") {
        binary_container(bytes)?
    } else {
        Container {
            json: bytes,
            blob: None,
            unread_chunks: Vec::new(),
        }
    };
    check_weight(text)?;
    let head: Head = serde_json::from_slice(text).map_err(|error| format!("not glTF: {error}"))?;
    check_head(&head)?;
    let fault = |error: ::gltf::Error| {
        // Extensions may hold the missing part.
        let unread = unread_extensions(&head.used);
        if unread.is_empty() {
            message(error)
        } else {
            format!(
                "{}; it uses {}, not read",
                message(error),
                unread.join(", ")
            )
        }
    };
    let text = with_webp_sources(text, &head)?;
    let mut json = Gltf::from_slice_without_validation(&text)
        .map_err(fault)?
        .document
        .into_json();
    drop_unknown(&mut json);
    check_accessors(&json)?;
    check_images(&json)?;
    let document = Document::from_json(json).map_err(fault)?;
    let chunk_warning = |kind: String| format!("its chunk of type {kind:?} is not read");
    Ok(Parsed {
        document,
        blob,
        warnings: unread_chunks.into_iter().map(chunk_warning).collect(),
        unread_members: head.materials.iter().map(unread_members).collect(),
        unlisted_extensions: unlisted_extensions(&head),
        generator: head.asset.generator.unwrap_or_default(),
    })
}

fn unlisted_extensions(head: &Head) -> Vec<String> {
    let of_materials = head
        .materials
        .iter()
        .filter_map(|material| material.get("extensions")?.as_object())
        .flat_map(|extensions| extensions.keys());
    let of_nodes = head.nodes.iter().flat_map(|node| node.extensions.keys());
    let is_unlisted = |name: &&String| !head.used.contains(name) && !extensions::is_read(name);
    let names: BTreeSet<&String> = of_materials.chain(of_nodes).filter(is_unlisted).collect();
    names.into_iter().cloned().collect()
}

/// Names the members of a core material that are not read.
fn unread_members(material: &Value) -> Vec<String> {
    let mut unread = Vec::new();
    let _: Result<::gltf::json::Material, _> = serde_ignored::deserialize(material, |path| {
        unread.extend(extensions::unknown_member(&path));
    });
    unread
}

/// Replaces the sources of textures by their WebP sources. A texture may have no other.
fn with_webp_sources<'t>(text: &'t [u8], head: &Head) -> Result<Cow<'t, [u8]>, String> {
    if !head
        .used
        .iter()
        .chain(&head.required)
        .any(|name| name == WEBP)
    {
        return Ok(Cow::Borrowed(text));
    }
    let mut json: Value =
        serde_json::from_slice(text).map_err(|error| format!("not glTF: {error}"))?;
    let textures = json.get_mut("textures").and_then(Value::as_array_mut);
    for texture in textures.into_iter().flatten() {
        let source = texture.pointer("/extensions/EXT_texture_webp/source");
        if let Some(source) = source.cloned() {
            texture["source"] = source;
        }
    }
    Ok(Cow::Owned(json.to_string().into_bytes()))
}

fn binary_container(bytes: &[u8]) -> Result<Container<'_>, String> {
    let stated_length = bytes
        .get(8..12)
        .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    // The crate subtracts from this length.
    if stated_length.is_none_or(|length| length < 20 || length > bytes.len()) {
        let claim =
            stated_length.map_or("no length".to_owned(), |length| format!("{length} bytes"));
        return Err(format!(
            "the header claims {claim}, but the file has {}; it is probably truncated",
            bytes.len()
        ));
    }
    let glb = match Glb::from_slice(bytes) {
        Ok(glb) => glb,
        Err(error) => {
            return container_of_chunks(&bytes[..stated_length.unwrap_or(0)])
                .ok_or_else(|| format!("not binary glTF 2.0: {error}"));
        }
    };
    let Cow::Borrowed(json) = glb.json else {
        return Err("the binary file has no JSON part".to_owned());
    };
    let blob = match glb.bin {
        Some(Cow::Borrowed(blob)) => Some(blob),
        _ => None,
    };
    Ok(Container {
        json,
        blob,
        unread_chunks: Vec::new(),
    })
}

/// Reads a container with chunks of other types, which readers must ignore (section 4.4.3), wherever
/// the binary chunk is; the crate expects it as the second. `None` without JSON or if a chunk is cut.
fn container_of_chunks(bytes: &[u8]) -> Option<Container<'_>> {
    let mut rest = bytes.get(12..)?;
    let mut container = Container {
        json: &[],
        blob: None,
        unread_chunks: Vec::new(),
    };
    while !rest.is_empty() {
        let (head, after) = rest.split_at_checked(8)?;
        let length = u32::from_le_bytes(head[..4].try_into().ok()?) as usize;
        let (data, after) = after.split_at_checked(length)?;
        match &head[4..] {
            JSON_CHUNK if container.json.is_empty() => container.json = data,
            BINARY_CHUNK if container.blob.is_none() => container.blob = Some(data),
            kind => container
                .unread_chunks
                .push(String::from_utf8_lossy(kind).into_owned()),
        }
        rest = after;
    }
    (!container.json.is_empty() && !container.unread_chunks.is_empty()).then_some(container)
}

/// Bounds the memory that the document will take.
fn check_weight(text: &[u8]) -> Result<(), String> {
    let weight = |byte: &u8| usize::from(*byte == b'"') + 16 * usize::from(*byte == b'{');
    if text.iter().map(weight).sum::<usize>() > MAX_TEXT_WEIGHT {
        return Err(format!(
            "its JSON has more than {} objects; expected fewer",
            MAX_TEXT_WEIGHT / 32
        ));
    }
    Ok(())
}

fn check_head(head: &Head) -> Result<(), String> {
    if !head.asset.version.starts_with("2.") {
        return Err(format!(
            "glTF version {:?}; expected 2.0",
            head.asset.version
        ));
    }
    if let Some(version) = head
        .asset
        .min_version
        .as_ref()
        .filter(|version| *version != READ)
    {
        return Err(format!(
            "its minVersion is {version:?}; expected {READ}: export it as glTF {READ}"
        ));
    }
    match unread_extensions(&head.required).as_slice() {
        [] => Ok(()),
        [name] => Err(format!(
            "it requires the extension {name}, which is not read; export it without"
        )),
        names => Err(format!(
            "it requires the extensions {}, which are not read; export it without",
            names.join(", ")
        )),
    }
}

fn unread_extensions(names: &[String]) -> Vec<&str> {
    names
        .iter()
        .map(String::as_str)
        .filter(|name| !extensions::is_read(name))
        .collect()
}

/// Describes the first fault, and counts the others.
fn message(error: ::gltf::Error) -> String {
    let ::gltf::Error::Validation(errors) = error else {
        return error.to_string();
    };
    let more = if errors.len() > 1 {
        format!(", and {} more faults", errors.len() - 1)
    } else {
        String::new()
    };
    errors.first().map_or_else(String::new, |(path, error)| {
        format!("{path}: {error}{more}")
    })
}

/// Drops what the crate refuses though the file is valid.
fn drop_unknown(json: &mut Root) {
    // The crate refuses extensions unknown to it; ours are checked above.
    json.extensions_required.clear();
    // The crate rejects application-specific attributes such as `_FEATURE_ID_0` (section 3.7.2.1).
    for primitive in json.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives) {
        primitive
            .attributes
            .retain(|semantic, _| matches!(semantic, Checked::Valid(_)));
    }
}

/// Checks the indices of attributes, which the crate follows unchecked.
fn check_accessors(json: &Root) -> Result<(), String> {
    let missing = json
        .meshes
        .iter()
        .flat_map(|mesh| &mesh.primitives)
        .flat_map(|primitive| primitive.attributes.values())
        .map(|index| index.value())
        .find(|index| *index >= json.accessors.len());
    match missing {
        None => Ok(()),
        Some(missing) => Err(format!(
            "there is no accessor {missing}; the file has {}",
            json.accessors.len()
        )),
    }
}

/// Checks the fields of images that the crate unwraps.
fn check_images(json: &Root) -> Result<(), String> {
    let has_source = |image: &::gltf::json::Image| match image.buffer_view {
        Some(_) => image.mime_type.is_some(),
        None => image.uri.is_some(),
    };
    match json.images.iter().position(|image| !has_source(image)) {
        None => Ok(()),
        Some(index) => Err(format!(
            "image {index}: has neither a URI nor a view with its mimeType"
        )),
    }
}
