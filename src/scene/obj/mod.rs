//! Wavefront OBJ files: polygons with materials ([`mtl`]).
//!
//! Read: `v`, `vt`, `vn`, `f` (any corner form, negative indices), `usemtl`, `mtllib`. Skipped: points, lines, curves,
//! vertex colours. Missing normals are smooth ([`normals`]), missing texture coordinates (0, 0).

mod lines;
mod mtl;
mod normals;
mod triangulate;

use super::maps::{Maps, Meaning, Texture};
use super::mesh::{Mesh, is_degenerate, position};
use super::source::{SceneFiles, existing};
use super::{Material, Scene, SceneError, toward_viewer_of_files};
use crate::pixels::lookup::Wrap;
use glam::{DVec3, Vec3};
use lines::Obj;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

/// Loads the scene at `path`; `spec` is its name.
pub(super) fn load(spec: &str, path: &Path, files: &dyn SceneFiles) -> Result<Scene, SceneError> {
    let file_error = |what: String| SceneError::of_file(path, what);
    let bytes = files.read(path).map_err(|error| file_error(format!("cannot read the scene: {error}")))?;
    // Only comments and names contain other text; Latin-1 there must not stop the geometry.
    let obj = lines::read(&String::from_utf8_lossy(&bytes))
        .map_err(|error| SceneError::of_line(path, error.line, error.message))?;
    if obj.runs.iter().all(|run| run.arities.is_empty()) {
        let what = if bytes.is_empty() {
            "the file is empty".to_owned()
        } else {
            format!("{} positions and no face", obj.positions.len())
        };
        return Err(file_error(format!("{what}; expected at least one face")));
    }

    let mut warnings = Vec::new();
    if !obj.ignored.is_empty() {
        let kinds: Vec<String> = obj.ignored.iter().map(|(kind, count)| format!("{count} x {kind}")).collect();
        warnings.push(format!("statements that are not read: {}", kinds.join(", ")));
    }
    let libraries = read_libraries(files, &obj, path, &mut warnings)?;
    let named: BTreeSet<&str> = obj.runs.iter().filter_map(|run| run.material.as_deref()).collect();
    let undefined = named.into_iter().filter(|name| libraries.materials.iter().all(|known| known.name != *name));
    add_first(
        &mut warnings,
        undefined.map(|name| format!("material \"{name}\" is not defined; the default material is used")),
    );

    let (meshes, used) = assemble(&obj, &libraries, path, &mut warnings)?;
    let (textures, maps) = read_maps(files, &libraries, &mut warnings);
    let material = |index: &Option<usize>| {
        index.map_or_else(Material::default, |index| libraries.materials[index].material(&maps))
    };
    let mut scene = Scene::assemble(spec, Vec::new(), meshes, used.iter().map(material).collect());
    scene.textures = textures;
    scene.warnings = warnings;
    scene.toward_viewer = toward_viewer_of_files();
    Ok(scene.hashed())
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
    obj: &Obj,
    path: &Path,
    warnings: &mut Vec<String>,
) -> Result<mtl::Libraries, SceneError> {
    let (mut libraries, mut odd) = (mtl::Libraries::default(), Vec::new());
    for names in &obj.libraries {
        let whole = existing(files, path, names);
        if files.has(&whole) || !names.contains(char::is_whitespace) {
            libraries.add(files, &whole, &mut odd)?;
            continue;
        }
        for name in names.split_whitespace() {
            libraries.add(files, &existing(files, path, name), &mut odd)?;
        }
    }
    add_first(warnings, std::mem::take(&mut libraries.unreadable));
    warnings.append(&mut odd);
    Ok(libraries)
}

/// Reads the textures and returns the index of each albedo map, `None` with a warning if unreadable.
fn read_maps(
    files: &dyn SceneFiles,
    libraries: &mtl::Libraries,
    warnings: &mut Vec<String>,
) -> (Vec<Texture>, Vec<Option<usize>>) {
    let (mut maps, mut unreadable) = (Maps::default(), Vec::new());
    let mut read = |path: &PathBuf| {
        let bytes = files.read(path).map_err(|error| error.to_string());
        let index = bytes.and_then(|bytes| maps.add(&bytes, Meaning::Color, Wrap::REPEAT));
        index.map_err(|error| {
            unreadable.push(format!("{}: cannot read the albedo map: {error}; skipped", path.display()));
        })
    };
    let indices = libraries.maps.iter().map(|path| read(path).ok()).collect();
    add_first(warnings, unreadable);
    let (textures, coarser) = maps.finish();
    warnings.extend(coarser);
    (textures, indices)
}

/// Builds one mesh per material in order of first use; also returns the index of each material (`None`: the default).
fn assemble(
    obj: &Obj,
    libraries: &mtl::Libraries,
    path: &Path,
    warnings: &mut Vec<String>,
) -> Result<(Vec<Mesh>, Vec<Option<usize>>), SceneError> {
    let file_error = |what: String| SceneError::of_file(path, what);
    let index_of = |name: &String| libraries.materials.iter().rposition(|material| material.name == *name);
    let (mut meshes, mut used): (Vec<Mesh>, Vec<Option<usize>>) = (Vec::new(), Vec::new());
    let mut vertices: HashMap<[usize; 3], u32> = HashMap::new();
    let mut last = None;
    let (mut degenerate_count, mut crossing_count) = (0, 0);
    for run in obj.runs.iter().filter(|run| !run.arities.is_empty()) {
        let material = run.material.as_ref().and_then(index_of);
        // Vertices are shared until the material changes.
        if last.replace(material) != Some(material) {
            vertices.clear();
        }
        let slot = used.iter().position(|known| *known == material).unwrap_or_else(|| {
            used.push(material);
            meshes.push(Mesh::empty(meshes.len()));
            meshes.len() - 1
        });
        let mesh = &mut meshes[slot];
        let mut corners = run.corners.as_slice();
        for arity in &run.arities {
            let (face, rest) = corners.split_at(*arity);
            corners = rest;
            let face: Vec<u32> = face
                .iter()
                .map(|&[v, vt, vn]| {
                    *vertices.entry([v, vt, vn]).or_insert_with(|| {
                        mesh.positions.push(obj.positions[v - 1]);
                        mesh.uvs.push(if vt == 0 { [0.0; 2] } else { obj.uvs[vt - 1] });
                        mesh.normals.push(if vn == 0 { [0.0; 3] } else { unit_or_zero(obj.normals[vn - 1]) });
                        mesh.tangents.push([0.0; 4]);
                        mesh.positions.len() as u32 - 1
                    })
                })
                .collect();
            let polygon: Vec<DVec3> = face.iter().map(|&index| position(&mesh.positions, index)).collect();
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
    if meshes.is_empty() {
        return Err(file_error("no face has an area; expected at least one".to_owned()));
    }
    if degenerate_count > 0 {
        warnings.push(format!("skipped {degenerate_count} triangles without area"));
    }
    if crossing_count > 0 {
        warnings.push(format!("{crossing_count} faces cross themselves; their triangles overlap"));
    }
    normals::fill_missing(&mut meshes);
    meshes.iter_mut().for_each(normals::wind_by_normals);
    Ok((meshes, used))
}

/// Normalizes `n`; zero marks a normal to compute.
fn unit_or_zero(n: [f32; 3]) -> [f32; 3] {
    Vec3::from_array(n).as_dvec3().normalize_or_zero().as_vec3().to_array()
}
