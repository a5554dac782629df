//! Wavefront OBJ files: polygons with materials ([`mtl`]), read by the crate `tobj`.
//!
//! Read: `v`, `vt`, `vn`, `f` (any corner form), `usemtl`, `mtllib`. Skipped: points, lines,
//! curves, vertex colours. Indices, also negative ones, refer to elements above the face. Polygons
//! may be concave ([`triangulate`]). Normals or texture coordinates that only some faces of a
//! material have are ignored in its group of faces. Missing normals are smooth ([`normals`]),
//! missing texture coordinates (0, 0).

mod mtl;
mod normals;
mod statements;
mod triangulate;

use super::maps::{Maps, Meaning};
use super::mesh::{Mesh, is_degenerate, position};
use super::source::{SceneFiles, existing};
use super::{Material, Scene, SceneError, toward_viewer_of_files};
use crate::base::pixels::lookup::Wrap;
use glam::{DVec3, Vec3};
use statements::{Statements, check_numbers};
use std::cell::RefCell;
use std::collections::{BTreeSet, HashMap};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest coordinate: the squares of differences must stay far below the largest f32.
const MAX_COORDINATE: f32 = 1e15;
const CORNERS_MAX: usize = 1 << 16;

/// Loads the scene at `path`; `spec` is its name.
pub(super) fn load(spec: &str, path: &Path, files: &dyn SceneFiles) -> Result<Scene, SceneError> {
    let file_error = |what: String| SceneError::of_file(path, what);
    let bytes = files
        .read(path)
        .map_err(|error| file_error(format!("cannot read the scene: {error}")))?;
    let statements = Statements::new(&bytes);
    let mut counts = [0; 3];
    statements.check(path, |keyword, values| {
        let (element, number_count) = match keyword {
            "v" => (0, 3),
            "vt" => (1, 2),
            "vn" => (2, 3),
            "f" => return check_face(values, counts),
            _ => return Ok(()),
        };
        counts[element] += 1;
        check_numbers(values, number_count, MAX_COORDINATE)
    })?;

    let mut warnings = Vec::new();
    if !statements.skipped.is_empty() {
        let kinds: Vec<String> = statements
            .skipped
            .iter()
            .map(|(kind, count)| format!("{count} x {kind}"))
            .collect();
        warnings.push(format!(
            "statements that are not read: {}",
            kinds.join(", ")
        ));
    }
    let libraries = read_libraries(files, &statements, path, &mut warnings)?;
    let slots: HashMap<String, usize> = libraries
        .iter()
        .enumerate()
        .map(|(slot, material)| (material.name().to_owned(), slot))
        .collect();
    let undefined: BTreeSet<&str> = statements
        .values("usemtl")
        .filter(|name| !slots.contains_key(*name))
        .collect();
    let undefined = undefined.iter().filter(|name| !name.is_empty());
    add_first(
        &mut warnings,
        undefined.map(|name| {
            format!("material \"{name}\" is not defined; the default material is used")
        }),
    );

    let slots = RefCell::new(slots);
    let (models, _) = statements.read(path, |text| {
        // All libraries are known from the first line.
        let mut text = "mtllib\n".as_bytes().chain(text);
        let options = tobj::LoadOptions {
            single_index: true,
            ..tobj::LoadOptions::default()
        };
        tobj::load_obj_buf(&mut text, &options, |_| Ok((Vec::new(), slots.take())))
    })?;
    let (meshes, used) = assemble(models, &mut warnings);
    if meshes.is_empty() {
        return Err(file_error(
            "no face has an area; expected at least one".to_owned(),
        ));
    }
    let (mut maps, mut known, mut unreadable) = (Maps::default(), HashMap::new(), Vec::new());
    let mut read_map = |path: &Path| {
        *known.entry(path.to_owned()).or_insert_with(|| {
            let bytes = files.read(path).map_err(|error| error.to_string());
            let index = bytes.and_then(|bytes| maps.add(&bytes, Meaning::Color, Wrap::REPEAT));
            let place = path.display();
            index
                .map_err(|error| {
                    unreadable.push(format!(
                        "{place}: cannot read the albedo map: {error}; skipped"
                    ))
                })
                .ok()
        })
    };
    let material = |slot: &Option<usize>| {
        slot.map_or_else(Material::default, |slot| {
            libraries[slot].material(&mut read_map)
        })
    };
    let materials = used.iter().map(material).collect();
    add_first(&mut warnings, unreadable);
    let mut scene = Scene::assemble(spec, Vec::new(), meshes, materials);
    let (textures, coarser) = maps.finish();
    warnings.extend(coarser);
    scene.textures = textures;
    scene.warnings = warnings;
    scene.toward_viewer = toward_viewer_of_files();
    Ok(scene.hashed())
}

/// Checks the corners of a face. `counts` has the numbers of positions, texture coordinates and
/// normals above it.
fn check_face(values: &str, counts: [usize; 3]) -> Result<(), String> {
    let corner_count = values.split_whitespace().count();
    if !(3..=CORNERS_MAX).contains(&corner_count) {
        return Err(format!(
            "{corner_count} corners; expected 3 to {CORNERS_MAX}"
        ));
    }
    let kinds = ["position", "texture coordinate", "normal"];
    for corner in values.split_whitespace() {
        for ((index, kind), count) in corner.split('/').zip(kinds).zip(counts) {
            let is_missing = index.is_empty() && kind != kinds[0];
            let distance = index.parse().map_or(0, isize::unsigned_abs);
            if !is_missing && !(1..=count).contains(&distance) {
                return Err(format!(
                    "\"{corner}\": there is no {kind} {index}; the lines above define {count}"
                ));
            }
        }
    }
    Ok(())
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
    let (mut libraries, mut odd) = (Vec::new(), Vec::new());
    for names in statements.values("mtllib") {
        let whole = existing(files, path, names);
        let paths: Vec<PathBuf> = match files.has(&whole) {
            true => vec![whole],
            false => names
                .split_whitespace()
                .map(|name| existing(files, path, name))
                .collect(),
        };
        for path in paths {
            libraries.extend(mtl::read(files, &path, &mut odd)?);
        }
    }
    add_first(warnings, odd);
    Ok(libraries)
}

/// Builds one mesh per material in order of first use; also returns the index of each material
/// (`None`: the default).
fn assemble(
    models: Vec<tobj::Model>,
    warnings: &mut Vec<String>,
) -> (Vec<Mesh>, Vec<Option<usize>>) {
    let (mut meshes, mut used): (Vec<Mesh>, Vec<Option<usize>>) = (Vec::new(), Vec::new());
    let (mut degenerate_count, mut crossing_count, mut incomplete_count) = (0, 0, 0);
    for part in models.into_iter().map(|model| model.mesh) {
        let slot = used
            .iter()
            .position(|known| *known == part.material_id)
            .unwrap_or_else(|| {
                used.push(part.material_id);
                meshes.push(Mesh::empty(meshes.len()));
                meshes.len() - 1
            });
        let mesh = &mut meshes[slot];
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(part.positions.as_chunks().0);
        let vertex_count = mesh.positions.len() - first as usize;
        let (uvs, normals) = (part.texcoords.as_chunks().0, part.normals.as_chunks().0);
        if uvs.len() == vertex_count {
            mesh.uvs.extend(uvs);
        }
        if normals.len() == vertex_count {
            // Zero marks a normal to compute.
            mesh.normals.extend(normals.iter().map(|n| {
                Vec3::from(*n)
                    .as_dvec3()
                    .normalize_or_zero()
                    .as_vec3()
                    .to_array()
            }));
        }
        incomplete_count += [uvs.len(), normals.len()]
            .iter()
            .filter(|count| !(**count == 0 || **count == vertex_count))
            .count();
        mesh.uvs.resize(mesh.positions.len(), [0.0; 2]);
        mesh.normals.resize(mesh.positions.len(), [0.0; 3]);
        mesh.tangents.resize(mesh.positions.len(), [0.0; 4]);
        let triangles = vec![3; part.indices.len() / 3];
        let arities = if part.face_arities.is_empty() {
            triangles
        } else {
            part.face_arities
        };
        let mut corners = part.indices.iter().map(|index| first + index);
        for arity in arities {
            let face: Vec<u32> = corners.by_ref().take(arity as usize).collect();
            let polygon: Vec<DVec3> = face
                .iter()
                .map(|&index| position(&mesh.positions, index))
                .collect();
            let split = triangulate::triangulate(&polygon);
            crossing_count += usize::from(!split.is_simple);
            for triangle in split.triangles {
                if is_degenerate(triangle.map(|k| polygon[k])) {
                    degenerate_count += 1;
                } else {
                    mesh.indices.extend(triangle.map(|k| face[k]));
                }
            }
        }
    }
    meshes.retain(|mesh| !mesh.indices.is_empty());
    let counted = [
        (degenerate_count, "triangles without area are skipped"),
        (
            crossing_count,
            "faces cross themselves; their triangles overlap",
        ),
        (
            incomplete_count,
            "groups of faces lack some normals or texture coordinates; the others are ignored",
        ),
    ];
    warnings.extend(
        counted
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{count} {what}")),
    );
    normals::fill_missing(&mut meshes);
    meshes.iter_mut().for_each(Mesh::wind_by_normals);
    (meshes, used)
}
