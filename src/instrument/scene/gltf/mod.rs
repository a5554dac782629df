//! glTF 2.0 files, `.glb` and `.gltf` [GlTF20]: the triangles and [`lights`] of the default scene;
//! see [`material`] for materials.
//!
//! Read: lists, strips and fans of triangles; positions, normals, tangents and one set of texture
//! coordinates, also quantized (`KHR_mesh_quantization`), sparse and interleaved; buffers and
//! images in the file, beside it or as `data:`. Missing normals are the triangles' own, missing
//! tangents under a normal map or an anisotropy are MikkTSpace's (section 3.7.2.1). Winding
//! determines the front; a mirroring transform flips it.
//!
//! Refused: morph targets, skins, and required extensions that [`extensions`] does not accept.
//! Other features (transparency, vertex colours, animations) only cause a warning.

mod buffers;
mod document;
mod extensions;
mod geometry;
mod lights;
mod material;
mod textures;

use super::light::Light;
use super::maps::ReadMaps;
use super::mesh::Mesh;
use super::source::SceneFiles;
use super::{Scene, SceneError, toward_viewer_of_files};
use crate::base::names::printable;
use ::gltf::{Document, Node, Primitive, Semantic, mesh::Mode, scene::Transform};
use buffers::Buffers;
use document::Parsed;
use geometry::{Attributes, Placed};
use glam::{DMat4, DQuat, Vec3};
use material::Materials;
use std::collections::BTreeSet;
use std::path::Path;
use textures::TextureReader;

/// In the name of Blender's exporter.
const BLENDER: &str = "Blender";
const BLENDER_ANISOTROPY: &str = "Blender wrote the strength of its anisotropy unconverted: \
     --anisotropy-widths disney has the widths of its own renders";

/// Most vertices after placement, and most corners / 3: below 1.5 GiB.
const MAX_VERTICES: usize = 1 << 23;

/// Loads the scene at `path`; `spec` is its name.
pub(super) fn load(spec: &str, path: &Path, files: &dyn SceneFiles) -> Result<Scene, SceneError> {
    let fault = |what: String| SceneError::of_file(path, printable(&what));
    let bytes = SceneError::reading(path, files)?;
    let Parsed {
        document,
        blob,
        warnings,
        generator,
        unread_members,
        unlisted_extensions,
    } = document::parse(&bytes).map_err(fault)?;
    let mut reader = Reader {
        buffers: Buffers::read(&document, blob, path, files).map_err(fault)?,
        materials: Materials::default(),
        meshes: Vec::new(),
        lights: Vec::new(),
        vertices_left: MAX_VERTICES,
        degenerate_count: 0,
        replaced_normal_count: 0,
        replaced_tangent_count: 0,
        unread: BTreeSet::new(),
    };
    reader.nodes(&document).map_err(fault)?;
    let mut textures =
        TextureReader::new(&document, &reader.buffers, path, files, &mut reader.unread);
    let materials = reader.materials.read(&mut textures).map_err(fault)?;
    let maps = textures.into_maps();
    reader.meshes.retain(|mesh| !mesh.indices.is_empty());
    if reader.meshes.is_empty() {
        return Err(fault(
            "its scene has no triangle with an area; expected at least one".to_owned(),
        ));
    }
    reader.add_unread(&document);
    let unlisted = unlisted_extensions.iter();
    reader.unread.extend(unlisted.map(|name| printable(name)));
    let left = Left {
        unread: reader.unread,
        degenerate_count: reader.degenerate_count,
        replaced_normal_count: reader.replaced_normal_count,
        replaced_tangent_count: reader.replaced_tangent_count,
    };
    let mut scene = Scene::assemble(spec, Vec::new(), reader.meshes, materials);
    let ReadMaps { textures, warning } = maps.finish();
    scene.textures = textures.into();
    scene.lights = reader.lights;
    scene.toward_viewer = toward_viewer_of_files();
    scene.warnings.extend(warnings);
    scene.warnings.extend(warning);
    scene
        .warnings
        .extend(reader.materials.unread_members(&unread_members));
    if generator.contains(BLENDER) && scene.has_anisotropy() {
        scene.warnings.push(BLENDER_ANISOTROPY.to_owned());
    }
    scene.warnings.extend(left.into_warnings());
    Ok(scene.hashed())
}

/// What a file has and the scene has not.
struct Left {
    /// Names of the skipped features.
    unread: BTreeSet<String>,
    degenerate_count: usize,
    replaced_normal_count: usize,
    replaced_tangent_count: usize,
}

impl Left {
    fn into_warnings(self) -> Vec<String> {
        let mut warnings = Vec::new();
        if !self.unread.is_empty() {
            let unread: Vec<String> = self.unread.into_iter().collect();
            warnings.push(format!("not read: {}", unread.join(", ")));
        }
        if self.degenerate_count > 0 {
            let count = self.degenerate_count;
            warnings.push(format!("skipped {count} triangles without area"));
        }
        if self.replaced_normal_count > 0 {
            warnings.push(format!(
                "computed {} normals that are zero or not finite in the file",
                self.replaced_normal_count
            ));
        }
        if self.replaced_tangent_count > 0 {
            warnings.push(format!(
                "computed {} tangents that are zero, not finite or along their normal in the file",
                self.replaced_tangent_count
            ));
        }
        warnings
    }
}

struct Reader<'a> {
    buffers: Buffers<'a>,
    materials: Materials<'a>,
    /// One for each material, in order of first use.
    meshes: Vec<Mesh>,
    lights: Vec<Light>,
    vertices_left: usize,
    degenerate_count: usize,
    replaced_normal_count: usize,
    replaced_tangent_count: usize,
    /// Names of the skipped features.
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
            let light = lights::of_node(document, &node, to_world, &mut self.unread)?;
            self.lights.extend(light);
            let first = open.len();
            open.extend(node.children().map(|child| (child, to_world)));
            open[first..].reverse();
        }
        Ok(())
    }

    /// Adds the triangles of a primitive to the mesh of its material.
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
        if primitive.get(&Semantic::Colors(0)).is_some() {
            self.unread.insert("vertex colours".to_owned());
        }
        let slot = self.materials.slot(&primitive.material())?;
        if slot == self.meshes.len() {
            self.meshes.push(Mesh::empty(slot));
        }
        let material = self.materials.get(slot);
        let mapping = material.mapping()?;
        let needs_tangents = material.needs_tangents();
        let attributes = self.attributes(primitive, positions, mapping.set, material.has_maps())?;
        let Placed {
            mesh,
            degenerate_count,
            replaced_normal_count,
            replaced_tangent_count,
        } = attributes.placed(
            primitive.mode(),
            to_world,
            mapping.transform,
            slot,
            needs_tangents,
        )?;
        self.degenerate_count += degenerate_count;
        self.replaced_normal_count += replaced_normal_count;
        self.replaced_tangent_count += replaced_tangent_count;
        let size = mesh.positions.len().max(mesh.indices.len().div_ceil(3));
        self.vertices_left = self
            .vertices_left
            .checked_sub(size)
            .ok_or("with it the scene has too many vertices")?;
        append(&mut self.meshes[slot], mesh);
        Ok(())
    }

    /// Reads the attributes of a primitive; `uv_set` is the number of its texture coordinates.
    fn attributes(
        &self,
        primitive: &Primitive,
        positions: Vec<[f32; 3]>,
        uv_set: u32,
        needs_uvs: bool,
    ) -> Result<Attributes, String> {
        let count = positions.len();
        let uvs = self.attribute::<2>(primitive, Semantic::TexCoords(uv_set), count)?;
        if uvs.is_none() && needs_uvs {
            return Err(format!(
                "the maps of its material read the texture coordinates {uv_set}, which it does not \
                 have"
            ));
        }
        let normals = self.attribute::<3>(primitive, Semantic::Normals, count)?;
        let tangents = if normals.is_some() {
            self.attribute::<4>(primitive, Semantic::Tangents, count)?
        } else {
            None
        };
        let indices = match primitive.indices() {
            Some(indices) => self.buffers.indices(&indices, 3 * self.vertices_left)?,
            None => (0..count as u32).collect(),
        };
        if let Some(index) = indices.iter().find(|index| **index as usize >= count) {
            return Err(format!(
                "index {index}; expected below its {count} positions"
            ));
        }
        Ok(Attributes {
            positions,
            uvs,
            normals,
            tangents,
            indices,
        })
    }

    /// Reads an attribute; `None` without a value for each of `count` positions.
    fn attribute<const N: usize>(
        &self,
        primitive: &Primitive,
        semantic: Semantic,
        count: usize,
    ) -> Result<Option<Vec<[f32; N]>>, String> {
        primitive
            .get(&semantic)
            .filter(|accessor| accessor.count() == count)
            .map(|accessor| self.buffers.vectors::<N>(&accessor, count))
            .transpose()
    }

    /// Adds the skipped features of the whole file and of its materials.
    fn add_unread(&mut self, document: &Document) {
        self.unread
            .extend(self.materials.unread().map(str::to_owned));
        let extensions = document
            .extensions_used()
            .filter(|name| !extensions::is_read(name));
        self.unread.extend(extensions.map(printable));
        if document.animations().len() > 0 {
            self.unread.insert("animations".to_owned());
        }
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

fn append(mesh: &mut Mesh, mut placed: Mesh) {
    let base = mesh.positions.len() as u32;
    mesh.indices
        .extend(placed.indices.iter().map(|index| base + index));
    mesh.positions.append(&mut placed.positions);
    mesh.normals.append(&mut placed.normals);
    mesh.uvs.append(&mut placed.uvs);
    mesh.tangents.append(&mut placed.tangents);
}
