//! glTF 2.0 files, `.glb` and `.gltf` [GlTF20]: the triangles of the default scene; see
//! [`material`] for materials.
//!
//! Read: lists, strips and fans of triangles; positions, normals, tangents and one set of texture
//! coordinates, also quantized (`KHR_mesh_quantization`), sparse and interleaved; buffers and
//! images in the file, beside it or as `data:`. Missing normals are the triangles' own, missing
//! tangents under a normal map or an anisotropy are MikkTSpace's (section 3.7.2.1). Winding
//! determines the front; a mirroring transform flips it.
//!
//! Refused: morph targets, skins, required extensions other than [`EXTENSIONS`] and lights. Other
//! features (emission, occlusion, transparency, vertex colours, animations, lights) only cause a
//! warning.

mod buffers;
mod material;
mod tangents;

use super::maps::Maps;
use super::mesh::{Mesh, is_degenerate};
use super::source::SceneFiles;
use super::{Scene, SceneError, toward_viewer_of_files};
use crate::base::names::printable;
use ::gltf::json::validation::Checked;
use ::gltf::{Document, Glb, Gltf, Node, Primitive, Semantic, mesh::Mode, scene::Transform};
use buffers::Buffers;
use glam::{DMat3, DMat4, DQuat, DVec3, Vec2, Vec3};
use material::Materials;
use serde::Deserialize;
use std::collections::BTreeSet;
use std::path::Path;

const EXTENSIONS: [&str; 6] = [
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_sheen",
    "KHR_materials_ior",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];
/// Most vertices after placement, and most corners / 3: below 1.5 GiB.
const MAX_VERTICES: usize = 1 << 23;
/// Largest coordinate: its square is finite in f32.
const MAX_COORDINATE: f64 = 1e15;
/// Largest weight of the text, 16 per object and 1 per quotation mark: below 1 GiB, since an object
/// takes up to 1 KiB.
const MAX_TEXT_WEIGHT: usize = 1 << 24;

/// Loads the scene at `path`; `spec` is its name.
pub(super) fn load(spec: &str, path: &Path, files: &dyn SceneFiles) -> Result<Scene, SceneError> {
    let fault = |what: String| SceneError::of_file(path, printable(&what));
    let bytes = files
        .read(path)
        .map_err(|error| fault(format!("cannot read the scene: {error}")))?;
    let (document, blob) = parse(&bytes).map_err(fault)?;
    let mut reader = Reader {
        buffers: Buffers::read(&document, blob, path, files).map_err(fault)?,
        materials: Materials::default(),
        meshes: Vec::new(),
        vertices_left: MAX_VERTICES,
        degenerate_count: 0,
        unread: BTreeSet::new(),
    };
    reader.nodes(&document).map_err(fault)?;
    let mut maps = Maps::default();
    let materials = reader
        .materials
        .read(
            &document,
            &reader.buffers,
            path,
            files,
            &mut maps,
            &mut reader.unread,
        )
        .map_err(fault)?;
    reader.meshes.retain(|mesh| !mesh.indices.is_empty());
    if reader.meshes.is_empty() {
        return Err(fault(
            "its scene has no triangle with an area; expected at least one".to_owned(),
        ));
    }
    for name in document
        .extensions_used()
        .filter(|name| !EXTENSIONS.contains(name))
    {
        reader.unread.insert(printable(name));
    }
    if document.animations().len() > 0 {
        reader.unread.insert("animations".to_owned());
    }
    let mut scene = Scene::assemble(spec, Vec::new(), reader.meshes, materials);
    let (textures, coarser) = maps.finish();
    scene.textures = textures;
    scene.warnings.extend(coarser);
    scene.toward_viewer = toward_viewer_of_files();
    if !reader.unread.is_empty() {
        let unread: Vec<String> = reader.unread.into_iter().collect();
        scene
            .warnings
            .push(format!("not read: {}", unread.join(", ")));
    }
    if reader.degenerate_count > 0 {
        scene.warnings.push(format!(
            "skipped {} triangles without area",
            reader.degenerate_count
        ));
    }
    Ok(scene.hashed())
}

/// Decides whether the file can be read at all.
#[derive(Deserialize)]
struct Head {
    asset: Asset,
    #[serde(default, rename = "extensionsRequired")]
    required: Vec<String>,
    #[serde(default, rename = "extensionsUsed")]
    used: Vec<String>,
}

#[derive(Deserialize)]
struct Asset {
    version: String,
}

/// Returns the checked document and the binary part of a `.glb`.
fn parse(bytes: &[u8]) -> Result<(Document, Option<&[u8]>), String> {
    let wrong = |error: ::gltf::Error| match error {
        ::gltf::Error::Validation(errors) => {
            let more = if errors.len() > 1 {
                format!(", and {} more faults", errors.len() - 1)
            } else {
                String::new()
            };
            errors.first().map_or_else(String::new, |(place, error)| {
                format!("{place}: {error}{more}")
            })
        }
        other => other.to_string(),
    };
    let (text, blob) = match bytes.strip_prefix(b"glTF") {
        Some(_) => container(bytes)?,
        None => (bytes, None),
    };
    let weight = |byte: &u8| usize::from(*byte == b'"') + 16 * usize::from(*byte == b'{');
    if text.iter().map(weight).sum::<usize>() > MAX_TEXT_WEIGHT {
        return Err(format!(
            "its JSON has more than {} objects; expected fewer",
            MAX_TEXT_WEIGHT / 32
        ));
    }
    let head: Head = serde_json::from_slice(text).map_err(|error| format!("not glTF: {error}"))?;
    if !head.asset.version.starts_with("2.") {
        return Err(format!(
            "glTF version {:?}; expected 2.0",
            head.asset.version
        ));
    }
    // Lights do not change what the environment does.
    let is_read = |name: &str| EXTENSIONS.contains(&name) || name == "KHR_lights_punctual";
    let unread = |names: &[String]| {
        names
            .iter()
            .filter(|name| !is_read(name))
            .cloned()
            .collect::<Vec<_>>()
    };
    match unread(&head.required).as_slice() {
        [] => {}
        [name] => {
            return Err(format!(
                "it requires the extension {name}, which is not read; export it without"
            ));
        }
        names => {
            let names = names.join(", ");
            return Err(format!(
                "it requires the extensions {names}, which are not read; export it without"
            ));
        }
    }
    // Extensions may hold the missing part.
    let used = unread(&head.used).join(", ");
    let wrong = |error| {
        if used.is_empty() {
            wrong(error)
        } else {
            format!("{}; it uses {used}, not read", wrong(error))
        }
    };
    let mut json = Gltf::from_slice_without_validation(text)
        .map_err(wrong)?
        .document
        .into_json();
    // The crate refuses extensions unknown to it; ours are checked above.
    json.extensions_required.clear();
    // The crate rejects application-specific attributes such as `_FEATURE_ID_0` (section 3.7.2.1).
    for primitive in json.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives) {
        primitive
            .attributes
            .retain(|semantic, _| matches!(semantic, Checked::Valid(_)));
    }
    // The crate follows these indices unchecked.
    let accessors = json
        .meshes
        .iter()
        .flat_map(|mesh| &mesh.primitives)
        .flat_map(|part| part.attributes.values());
    if let Some(missing) = accessors
        .map(|index| index.value())
        .find(|index| *index >= json.accessors.len())
    {
        return Err(format!(
            "there is no accessor {missing}; the file has {}",
            json.accessors.len()
        ));
    }
    // The crate unwraps these fields unchecked.
    let has_source = |image: &::gltf::json::Image| match image.buffer_view {
        Some(_) => image.mime_type.is_some(),
        None => image.uri.is_some(),
    };
    if let Some(index) = json.images.iter().position(|image| !has_source(image)) {
        return Err(format!(
            "image {index}: has neither a URI nor a view with its mimeType"
        ));
    }
    Ok((Document::from_json(json).map_err(wrong)?, blob))
}

fn container(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    use std::borrow::Cow::Borrowed;
    let word = |at: usize| {
        bytes
            .get(at..at + 4)
            .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize)
    };
    // The crate subtracts from this length.
    if word(8).is_none_or(|length| length < 20 || length > bytes.len()) {
        let claim = word(8).map_or("no length".to_owned(), |length| format!("{length} bytes"));
        return Err(format!(
            "the header claims {claim}, but the file has {}; it is probably truncated",
            bytes.len()
        ));
    }
    match Glb::from_slice(bytes) {
        Ok(Glb {
            json: Borrowed(json),
            bin: Some(Borrowed(bin)),
            ..
        }) => Ok((json, Some(bin))),
        Ok(Glb {
            json: Borrowed(json),
            ..
        }) => Ok((json, None)),
        Ok(_) => Err("the binary file has no JSON part".to_owned()),
        Err(error) => Err(format!("not binary glTF 2.0: {error}")),
    }
}

struct Reader<'a> {
    buffers: Buffers<'a>,
    materials: Materials<'a>,
    /// One for each material, in order of first use.
    meshes: Vec<Mesh>,
    vertices_left: usize,
    degenerate_count: usize,
    unread: BTreeSet<String>,
}

impl<'a> Reader<'a> {
    fn nodes(&mut self, document: &'a Document) -> Result<(), String> {
        let scene = document
            .default_scene()
            .or_else(|| document.scenes().next());
        let scene = scene.ok_or("it has no scene; expected at least one")?;
        let mut is_visited = vec![false; document.nodes().len()];
        let mut open: Vec<(Node<'a>, DMat4)> =
            scene.nodes().map(|node| (node, DMat4::IDENTITY)).collect();
        open.reverse();
        while let Some((node, parent)) = open.pop() {
            if std::mem::replace(&mut is_visited[node.index()], true) {
                return Err(format!(
                    "node {} is reached twice; expected a tree",
                    node.index()
                ));
            }
            let to_world = parent * matrix(node.transform());
            if node.skin().is_some() {
                return Err(format!(
                    "{} has a skin, which is not read; export it posed",
                    name("node", node.name(), node.index())
                ));
            }
            if let Some(mesh) = node.mesh() {
                let name = name("mesh", mesh.name(), mesh.index());
                for primitive in mesh.primitives() {
                    self.primitive(&primitive, to_world)
                        .map_err(|error| format!("{name}: {error}"))?;
                }
            }
            let first = open.len();
            open.extend(node.children().map(|child| (child, to_world)));
            open[first..].reverse();
        }
        Ok(())
    }

    fn primitive(&mut self, primitive: &Primitive<'a>, to_world: DMat4) -> Result<(), String> {
        if primitive.morph_targets().len() > 0 {
            return Err("it has morph targets, which are not read; export it without".to_owned());
        }
        if matches!(
            primitive.mode(),
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip
        ) {
            self.unread.insert("points and lines".to_owned());
            return Ok(());
        }
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            self.unread.insert("triangles without positions".to_owned());
            return Ok(());
        };
        let positions = self.buffers.vectors::<3>(&positions, self.vertices_left)?;
        let count = positions.len();
        let attribute = |semantic: Semantic| {
            primitive
                .get(&semantic)
                .filter(|accessor| accessor.count() == count)
        };
        if primitive.get(&Semantic::Colors(0)).is_some() {
            self.unread.insert("vertex colours".to_owned());
        }
        let slot = self.materials.slot(&primitive.material())?;
        if slot == self.meshes.len() {
            self.meshes.push(Mesh::empty(slot));
        }
        let (wanted, transform) = self.materials.mapping(slot)?;
        let uvs = attribute(Semantic::TexCoords(wanted))
            .map(|uvs| self.buffers.vectors::<2>(&uvs, count))
            .transpose()?;
        if uvs.is_none() && self.materials.has_maps(slot) {
            return Err(format!(
                "the maps of its material read the texture coordinates {wanted}, which it does not \
                 have"
            ));
        }
        let normals = attribute(Semantic::Normals)
            .map(|normals| self.buffers.vectors::<3>(&normals, count))
            .transpose()?;
        let given = attribute(Semantic::Tangents).filter(|_| normals.is_some());
        let given = given
            .map(|tangents| self.buffers.vectors::<4>(&tangents, count))
            .transpose()?;
        let indices = match primitive.indices() {
            Some(indices) => self.buffers.indices(&indices, 3 * self.vertices_left)?,
            None => (0..count as u32).collect(),
        };
        if let Some(index) = indices.iter().find(|index| **index as usize >= count) {
            return Err(format!(
                "index {index}; expected below its {count} positions"
            ));
        }

        // Cofactors are the inverse transpose times the determinant; they exist even for singular
        // transforms.
        let linear = DMat3::from_mat4(to_world);
        let (x, y, z) = (linear.x_axis, linear.y_axis, linear.z_axis);
        let mirror = if linear.determinant() < 0.0 {
            -1.0
        } else {
            1.0
        };
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * mirror;
        let unit = |v: DVec3| v.normalize_or_zero().as_vec3().to_array();
        let mut placed = Mesh::empty(slot);
        for position in &positions {
            let position = to_world.transform_point3(Vec3::from_array(*position).as_dvec3());
            // Also refuses NaN.
            if !(position.abs().max_element() <= MAX_COORDINATE && position.is_finite()) {
                return Err(format!(
                    "a position outside -{MAX_COORDINATE:e} to {MAX_COORDINATE:e}"
                ));
            }
            placed.positions.push(position.as_vec3().to_array());
        }
        // glTF counts v from the top.
        let turned = |uv: &[f32; 2]| {
            let [u, v] = transform
                .transform_point2(Vec2::from_array(*uv).as_dvec2())
                .to_array();
            [u as f32, (1.0 - v) as f32]
        };
        placed.uvs = uvs.map_or(vec![[0.0; 2]; count], |uvs| {
            uvs.iter().map(turned).collect()
        });
        if placed.uvs.iter().flatten().any(|x| !x.is_finite()) {
            return Err("a texture coordinate that is not a finite number".to_owned());
        }
        let normals = normals.unwrap_or_default();
        placed.normals = normals
            .iter()
            .map(|&n| unit(cofactors * Vec3::from_array(n).as_dvec3()))
            .collect();
        let tangent = |[x, y, z, w]: [f32; 4]| {
            let [x, y, z] = unit(linear * DVec3::new(x.into(), y.into(), z.into()));
            [x, y, z, w.signum() * mirror as f32]
        };
        let has_tangents = given.is_some();
        placed.tangents = given.map_or(vec![[0.0; 4]; count], |given| {
            given.into_iter().map(tangent).collect()
        });
        for mut triangle in triangles(primitive.mode(), &indices) {
            if is_degenerate(
                triangle.map(|index| Vec3::from_array(placed.positions[index as usize]).as_dvec3()),
            ) {
                self.degenerate_count += 1;
                continue;
            }
            if mirror < 0.0 {
                triangle.swap(1, 2);
            }
            placed.indices.extend(triangle);
        }
        let has_normal = |index: &u32| {
            placed
                .normals
                .get(*index as usize)
                .is_some_and(|normal| *normal != [0.0; 3])
        };
        let is_flat = !placed.indices.iter().all(has_normal);
        let needs_tangents = self.materials.needs_tangents(slot) && (is_flat || !has_tangents);
        if is_flat || needs_tangents {
            placed = tangents::corners(&placed, is_flat);
        }
        if needs_tangents {
            tangents::fill(&mut placed);
        }
        let size = placed.positions.len().max(placed.indices.len().div_ceil(3));
        self.vertices_left = self
            .vertices_left
            .checked_sub(size)
            .ok_or("with it the scene has too many vertices")?;
        append(&mut self.meshes[slot], placed);
        Ok(())
    }
}

/// Names an object: `node 3 ("wheel")`.
fn name(kind: &str, name: Option<&str>, index: usize) -> String {
    name.map_or_else(
        || format!("{kind} {index}"),
        |name| format!("{kind} {index} ({name:?})"),
    )
}

fn matrix(transform: Transform) -> DMat4 {
    match transform {
        Transform::Matrix { matrix } => {
            DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from)))
        }
        Transform::Decomposed {
            translation,
            rotation,
            scale,
        } => DMat4::from_scale_rotation_translation(
            Vec3::from_array(scale).as_dvec3(),
            DQuat::from_array(rotation.map(f64::from)).normalize(),
            Vec3::from_array(translation).as_dvec3(),
        ),
    }
}

/// Returns triangles counter-clockwise from their front (section 3.7.2.1).
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    let i = |k: usize| indices[k];
    let last = indices.len().saturating_sub(2);
    match mode {
        Mode::TriangleStrip => (0..last)
            .map(|k| [i(k), i(k + 1 + k % 2), i(k + 2 - k % 2)])
            .collect(),
        Mode::TriangleFan => (1..=last).map(|k| [i(k), i(k + 1), i(0)]).collect(),
        _ => indices.as_chunks::<3>().0.to_vec(),
    }
}

fn append(mesh: &mut Mesh, mut placed: Mesh) {
    let base = mesh.positions.len() as u32;
    mesh.indices
        .extend(placed.indices.iter().map(|index| base + index));
    mesh.positions.append(&mut placed.positions);
    mesh.normals.append(&mut placed.normals);
    mesh.uvs.append(&mut placed.uvs);
    mesh.tangents.append(&mut placed.tangents);
}
