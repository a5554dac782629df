//! Wavefront OBJ files: polygons with materials ([`mtl`]), read by the crate `tobj`.
//!
//! Read: `v`, `vt`, `vn`, `f` (any corner form), `s`, `usemtl`, `mtllib`. Skipped: points, lines,
//! curves. Named in a warning: vertex colours, normals of zero length. Indices, also negative ones, refer to elements above the face. Polygons
//! may be concave ([`triangulate`]). Normals or texture coordinates that only some faces of a
//! material have are ignored in its group of faces. Missing texture coordinates are (0, 0).
//!
//! Missing normals are smooth ([`normals`]) within each smoothing group. Faces under `s off` or `s
//! 0`, and faces above the first `s` of a file, have their own normals. A file without any `s` is
//! smooth everywhere.
//!
//! Faces above the first `usemtl` have the only material, if the libraries define one.

mod map_files;
mod map_text;
mod mtl;
mod normals;
mod statements;
mod triangulate;

use super::maps::ReadMaps;
use super::mesh::{Mesh, is_degenerate, position};
use super::source::{SceneFiles, existing};
use super::tangents;
use super::{Material, Scene, SceneError, toward_viewer_of_files};
use glam::{DVec3, Vec3};
use map_files::MapFiles;
use statements::{FLAT, Role, Statements, check_numbers};
use std::cell::RefCell;
use std::collections::{BTreeSet, HashMap};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest coordinate: the squares of differences must stay far below the largest f32.
const MAX_COORDINATE: f32 = 1e15;
const CORNERS_MAX: usize = 1 << 16;
/// Values of a vertex with a colour; a fourth value alone is a weight of rational curves.
const COLORED_VALUES: usize = 6;

/// Loads the scene at `path`; `spec` is its name.
pub(super) fn load(spec: &str, path: &Path, files: &dyn SceneFiles) -> Result<Scene, SceneError> {
    let file_error = |what: String| SceneError::of_file(path, what);
    let bytes = SceneError::reading(path, files)?;
    let statements = Statements::new(&bytes, role);
    check_statements(&statements, path)?;

    let mut warnings: Vec<String> = skipped_statements(&statements).into_iter().collect();
    let value_count = statements.longest.get("v").copied().unwrap_or_default();
    if value_count >= COLORED_VALUES {
        warnings.push("not read: vertex colours".to_owned());
    }
    let libraries = read_libraries(files, &statements, path, &mut warnings)?;
    let slots: HashMap<String, usize> = libraries
        .iter()
        .enumerate()
        .map(|(slot, material)| (material.name().to_owned(), slot))
        .collect();
    add_first(&mut warnings, redefined_materials(&libraries, &slots));
    add_first(&mut warnings, undefined_materials(&statements, &slots));

    let first_material = first_material(&statements, &libraries, &mut warnings);
    let models = read_models(&statements, path, slots, first_material)?;
    let mut assembly = Assembly::default();
    for model in models {
        assembly.add(model.mesh, &model.name);
    }
    let Assembled {
        mut meshes,
        materials,
    } = assembly.finish(&mut warnings);
    for mesh in &mut meshes {
        if materials[mesh.material].is_some_and(|index| libraries[index].needs_tangents()) {
            *mesh = tangents::corners(mesh, false);
            tangents::fill_missing(mesh);
        }
    }
    if meshes.is_empty() {
        return Err(file_error(
            "no face has an area; expected at least one".to_owned(),
        ));
    }
    let mut map_files = MapFiles::new(files);
    let materials = materials
        .iter()
        .map(|library_index| {
            library_index.map_or_else(Material::default, |index| {
                libraries[index].material(|map| map_files.index(map))
            })
        })
        .collect();
    add_first(&mut warnings, map_files.unreadable);
    let mut scene = Scene::assemble(spec, Vec::new(), meshes, materials);
    let ReadMaps { textures, warning } = map_files.maps.finish();
    warnings.extend(warning);
    scene.textures = textures.into();
    scene.warnings = warnings;
    scene.toward_viewer = toward_viewer_of_files();
    Ok(scene.hashed())
}

/// Names materials with several definitions that differ.
fn redefined_materials(libraries: &[mtl::Source], slots: &HashMap<String, usize>) -> Vec<String> {
    let names: BTreeSet<&str> = libraries
        .iter()
        .filter(|material| !material.is_like(&libraries[slots[material.name()]]))
        .map(mtl::Source::name)
        .collect();
    let warning =
        |name| format!("material \"{name}\" has several definitions; the last one is used");
    names.into_iter().map(warning).collect()
}

fn role(keyword: &str) -> Role {
    match keyword {
        // Names have no effect.
        "o" | "g" => Role::Ignored,
        "s" => Role::Smoothing,
        "mtllib" | "usemtl" => Role::Text,
        // Weights and colours follow.
        "v" => Role::Numbers(3),
        "vt" | "vn" | "f" => Role::Numbers(usize::MAX),
        _ => Role::Unread,
    }
}

/// Checks the numbers and corners of every statement.
fn check_statements(statements: &Statements, path: &Path) -> Result<(), SceneError> {
    let mut counts = Counts::default();
    statements.check(path, |keyword, values| {
        let (count, number_count) = match keyword {
            "v" => (&mut counts.positions, 3),
            "vt" => (&mut counts.uvs, 2),
            "vn" => (&mut counts.normals, 3),
            "f" => return check_face(values, &counts),
            _ => return Ok(()),
        };
        *count += 1;
        check_numbers(values, number_count, MAX_COORDINATE)
    })
}

/// Numbers of elements above a line.
#[derive(Default)]
struct Counts {
    positions: usize,
    uvs: usize,
    normals: usize,
}

/// Checks the corners of a face.
fn check_face(values: &str, counts: &Counts) -> Result<(), String> {
    let corner_count = values.split_whitespace().count();
    if !(3..=CORNERS_MAX).contains(&corner_count) {
        return Err(format!(
            "{corner_count} corners; expected 3 to {CORNERS_MAX}"
        ));
    }
    for corner in values.split_whitespace() {
        let mut indices = corner.split('/');
        check_index(corner, indices.next(), "position", counts.positions)?;
        // Only positions are required.
        let uv = indices.next().filter(|index| !index.is_empty());
        check_index(corner, uv, "texture coordinate", counts.uvs)?;
        let normal = indices.next().filter(|index| !index.is_empty());
        check_index(corner, normal, "normal", counts.normals)?;
    }
    Ok(())
}

/// Checks an index of a corner; `count` elements of its kind are above.
fn check_index(corner: &str, index: Option<&str>, kind: &str, count: usize) -> Result<(), String> {
    let Some(index) = index else {
        return Ok(());
    };
    let distance = index.parse().map_or(0, isize::unsigned_abs);
    if (1..=count).contains(&distance) {
        return Ok(());
    }
    Err(format!(
        "\"{corner}\": there is no {kind} {index}; the lines above define {count}"
    ))
}

/// Returns the warning about skipped statements.
fn skipped_statements(statements: &Statements) -> Option<String> {
    if statements.skipped.is_empty() {
        return None;
    }
    let kinds: Vec<String> = statements
        .skipped
        .iter()
        .map(|(kind, count)| format!("{count} x {kind}"))
        .collect();
    Some(format!(
        "statements that are not read: {}",
        kinds.join(", ")
    ))
}

/// Returns a warning for each used material that no library defines.
fn undefined_materials(statements: &Statements, defined: &HashMap<String, usize>) -> Vec<String> {
    let undefined: BTreeSet<&str> = statements
        .values("usemtl")
        .filter(|name| !name.is_empty() && !defined.contains_key(*name))
        .collect();
    undefined
        .iter()
        .map(|name| format!("material \"{name}\" is not defined; the default material is used"))
        .collect()
}

/// Returns the material of faces above the first `usemtl`: the only one, if the libraries define
/// one. Warns if such faces have the default.
fn first_material(
    statements: &Statements,
    libraries: &[mtl::Source],
    warnings: &mut Vec<String>,
) -> Option<String> {
    let is_face = |(keyword, _): &(&str, &str)| *keyword == "f";
    let above = statements
        .all()
        .take_while(|(keyword, _)| *keyword != "usemtl");
    let face_count = above.filter(is_face).count();
    if face_count == 0 {
        return None;
    }
    match libraries {
        [] => None,
        [only] => Some(only.name().to_owned()),
        several => {
            warnings.push(format!(
                "{face_count} faces are above the first usemtl and have the default material; the \
                 libraries define {}",
                several.len()
            ));
            None
        }
    }
}

/// Reads the faces, by material and smoothing group, which is the model's name; `slots` has the
/// index of each material's name.
fn read_models(
    statements: &Statements,
    path: &Path,
    slots: HashMap<String, usize>,
    first_material: Option<String>,
) -> Result<Vec<tobj::Model>, SceneError> {
    let slots = RefCell::new(slots);
    let (models, _) = statements.read(path, |text| {
        // All libraries are known from the first line.
        let mut head = "mtllib\n".to_owned();
        if let Some(name) = first_material {
            head.extend(["usemtl ", &name, "\n"]);
        }
        if statements.values("g").next().is_some() {
            head.extend(["g ", FLAT, "\n"]);
        }
        let mut text = head.as_bytes().chain(text);
        let options = tobj::LoadOptions {
            single_index: true,
            ..tobj::LoadOptions::default()
        };
        tobj::load_obj_buf(&mut text, &options, |_| Ok((Vec::new(), slots.take())))
    })?;
    Ok(models)
}

/// Printed warnings of one cause; a broken exporter can cause one per line.
const SHOWN_COUNT: usize = 5;

/// Adds the first warnings of one cause, and the number of others.
fn add_first(warnings: &mut Vec<String>, of_one_cause: impl IntoIterator<Item = String>) {
    let mut of_one_cause = of_one_cause.into_iter();
    warnings.extend(of_one_cause.by_ref().take(SHOWN_COUNT));
    let left_out = of_one_cause.count();
    if left_out > 0 {
        warnings.push(format!("and {left_out} more of the last kind"));
    }
}

/// Reads the files of `mtllib` statements: one whose name may contain spaces, or several.
fn read_libraries(
    files: &dyn SceneFiles,
    statements: &Statements,
    path: &Path,
    warnings: &mut Vec<String>,
) -> Result<Vec<mtl::Source>, SceneError> {
    let mut libraries = Vec::new();
    let mut library_warnings = Vec::new();
    for names in statements.values("mtllib") {
        let single = existing(files, path, names);
        let paths: Vec<PathBuf> = if files.has(&single) {
            vec![single]
        } else {
            names
                .split_whitespace()
                .map(|name| existing(files, path, name))
                .collect()
        };
        for path in paths {
            libraries.extend(mtl::read(files, &path, &mut library_warnings)?);
        }
    }
    add_first(warnings, library_warnings);
    Ok(libraries)
}

/// Gathers the faces of each material.
#[derive(Default)]
struct Assembly {
    /// One for each material, in order of first use.
    meshes: Vec<Mesh>,
    /// Index of each mesh's material among the libraries'; `None`: the default.
    materials: Vec<Option<usize>>,
    /// Smoothing group of each vertex, by mesh: an index of `group_names`.
    groups: Vec<Vec<u32>>,
    group_names: Vec<String>,
    zero_normal_count: usize,
    degenerate_count: usize,
    crossing_count: usize,
    incomplete_count: usize,
}

/// The result of an [`Assembly`].
struct Assembled {
    /// Those with triangles.
    meshes: Vec<Mesh>,
    /// See [`Assembly::materials`]; also of materials without triangles.
    materials: Vec<Option<usize>>,
}

impl Assembly {
    /// Adds a group of faces with one material and smoothing group.
    fn add(&mut self, mut part: tobj::Mesh, group: &str) {
        let position_count = part.positions.len() / 3;
        for (values, width) in [(&mut part.texcoords, 2), (&mut part.normals, 3)] {
            if !values.is_empty() && values.len() != width * position_count {
                self.incomplete_count += 1;
                values.clear();
            }
        }
        let is_flat = group == FLAT;
        if is_flat && part.normals.is_empty() {
            part = unshared(part);
        }
        let slot = self.slot(part.material_id);
        let first = self.meshes[slot].positions.len() as u32;
        self.add_vertices(slot, &part);
        let group = self.group(group);
        let vertex_count = self.meshes[slot].positions.len();
        self.groups[slot].resize(vertex_count, group);
        self.add_faces(slot, first, &part, is_flat);
    }

    fn group(&mut self, name: &str) -> u32 {
        let known = self.group_names.iter().position(|known| known == name);
        known.unwrap_or_else(|| {
            self.group_names.push(name.to_owned());
            self.group_names.len() - 1
        }) as u32
    }

    fn slot(&mut self, material: Option<usize>) -> usize {
        if let Some(slot) = self.materials.iter().position(|known| *known == material) {
            return slot;
        }
        let slot = self.meshes.len();
        self.materials.push(material);
        self.meshes.push(Mesh::empty(slot));
        self.groups.push(Vec::new());
        slot
    }

    fn add_vertices(&mut self, slot: usize, part: &tobj::Mesh) {
        let mesh = &mut self.meshes[slot];
        let positions = part.positions.as_chunks().0;
        let uvs = part.texcoords.as_chunks().0;
        let normals = part.normals.as_chunks().0;
        mesh.positions.extend(positions);
        if uvs.len() == positions.len() {
            mesh.uvs.extend(uvs);
        }
        if normals.len() == positions.len() {
            // Zero marks a normal to compute.
            let unit = |normal: &[f32; 3]| Vec3::from(*normal).as_dvec3().normalize_or_zero();
            let units: Vec<DVec3> = normals.iter().map(unit).collect();
            let zero_count = units.iter().filter(|unit| **unit == DVec3::ZERO).count();
            self.zero_normal_count += zero_count;
            mesh.normals
                .extend(units.iter().map(|unit| unit.as_vec3().to_array()));
        }
        let vertex_count = mesh.positions.len();
        mesh.uvs.resize(vertex_count, [0.0; 2]);
        mesh.normals.resize(vertex_count, [0.0; 3]);
        mesh.tangents.resize(vertex_count, [0.0; 4]);
    }

    /// Splits the faces of a part, whose vertices begin at `first`. Flat faces share no vertices and
    /// get their own normals, where the file has none.
    fn add_faces(&mut self, slot: usize, first: u32, part: &tobj::Mesh, is_flat: bool) {
        let mesh = &mut self.meshes[slot];
        let triangles = vec![3; part.indices.len() / 3];
        let corner_counts = if part.face_arities.is_empty() {
            &triangles
        } else {
            &part.face_arities
        };
        let mut corners = part.indices.iter().map(|index| first + index);
        for corner_count in corner_counts {
            let face: Vec<u32> = corners.by_ref().take(*corner_count as usize).collect();
            let polygon: Vec<DVec3> = face
                .iter()
                .map(|&index| position(&mesh.positions, index))
                .collect();
            let split = triangulate::triangulate(&polygon);
            self.crossing_count += usize::from(!split.is_simple);
            if is_flat && part.normals.is_empty() {
                let normal = face_normal(&polygon, &split.triangles);
                face.iter()
                    .for_each(|index| mesh.normals[*index as usize] = normal);
            }
            for triangle in split.triangles {
                if is_degenerate(triangle.map(|k| polygon[k])) {
                    self.degenerate_count += 1;
                } else {
                    mesh.indices.extend(triangle.map(|k| face[k]));
                }
            }
        }
    }

    /// Fills in missing normals and winds the triangles by them.
    fn finish(mut self, warnings: &mut Vec<String>) -> Assembled {
        let mut is_kept = self.meshes.iter().map(|mesh| !mesh.indices.is_empty());
        self.groups
            .retain(|_| is_kept.next().is_some_and(|is_kept| is_kept));
        self.meshes.retain(|mesh| !mesh.indices.is_empty());
        let mut warn = |count: usize, what: &str| {
            if count > 0 {
                warnings.push(format!("{count} {what}"));
            }
        };
        warn(self.degenerate_count, "triangles without area are skipped");
        warn(
            self.zero_normal_count,
            "normals of zero length are computed from the faces",
        );
        warn(
            self.crossing_count,
            "faces cross themselves; their triangles overlap",
        );
        warn(
            self.incomplete_count,
            "groups of faces lack some normals or texture coordinates; the others are ignored",
        );
        normals::fill_missing(&mut self.meshes, &self.groups);
        self.meshes.iter_mut().for_each(Mesh::wind_by_normals);
        Assembled {
            meshes: self.meshes,
            materials: self.materials,
        }
    }
}

/// Gives every corner its own vertex.
fn unshared(part: tobj::Mesh) -> tobj::Mesh {
    let by_corner = |values: &[f32], width: usize| -> Vec<f32> {
        if values.is_empty() {
            return Vec::new();
        }
        part.indices
            .iter()
            .flat_map(|index| &values[*index as usize * width..][..width])
            .copied()
            .collect()
    };
    tobj::Mesh {
        positions: by_corner(&part.positions, 3),
        texcoords: by_corner(&part.texcoords, 2),
        normals: by_corner(&part.normals, 3),
        indices: (0..part.indices.len() as u32).collect(),
        face_arities: part.face_arities,
        material_id: part.material_id,
        ..tobj::Mesh::default()
    }
}

/// Returns the unit normal of a polygon, the mean over its triangles by area; zeros without area.
fn face_normal(polygon: &[DVec3], triangles: &[[usize; 3]]) -> [f32; 3] {
    let area =
        |[a, b, c]: &[usize; 3]| (polygon[*b] - polygon[*a]).cross(polygon[*c] - polygon[*a]);
    let sum: DVec3 = triangles.iter().map(area).sum();
    sum.normalize_or_zero().as_vec3().to_array()
}
