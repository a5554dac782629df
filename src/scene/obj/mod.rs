//! Wavefront OBJ files: polygons of any number of corners with materials; see [`mtl`] for the materials.
//!
//! Read: `v`, `vt`, `vn`, `f` (any corner form, negative indices), `usemtl`, `mtllib`. Points, lines, curves and vertex colours are
//! left out. Missing normals are computed smooth (see [`normals`]), missing texture coordinates are (0, 0).

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
use lines::ObjText;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Loads the file at `path` of `files`; `spec` is what the user wrote.
pub(super) fn load(spec: &str, path: &Path, files: &dyn SceneFiles) -> Result<Scene, SceneError> {
    let file_error = |what: String| SceneError::of_file(path, what);
    let bytes = files.read(path).map_err(|error| file_error(format!("cannot read the scene: {error}")))?;
    // Comments and names are the only places for other text; in Latin-1 they must not stop the geometry.
    let obj = lines::read(&String::from_utf8_lossy(&bytes))
        .map_err(|error| SceneError::of_line(path, error.line, error.message))?;
    if obj.face_count == 0 {
        let what = if bytes.is_empty() {
            "the file is empty".to_owned()
        } else {
            format!("{} positions and no face", obj.position_count)
        };
        return Err(file_error(format!("{what}, expected at least one face")));
    }

    let mut warnings = Vec::new();
    if !obj.ignored.is_empty() {
        let kinds: Vec<String> = obj.ignored.iter().map(|(kind, count)| format!("{count} x {kind}")).collect();
        warnings.push(format!("statements that are not read: {}", kinds.join(", ")));
    }
    let libraries = read_libraries(files, &obj, path, &mut warnings)?;
    let options = tobj::LoadOptions { single_index: true, ..tobj::LoadOptions::default() };
    let load_libraries = |_: &Path| tobj::load_mtl_buf(&mut libraries.text.as_bytes());
    let (models, file_materials) = tobj::load_obj_buf(&mut obj.text.as_bytes(), &options, load_libraries)
        .map_err(|error| file_error(format!("cannot read the faces: {error}")))?;
    let file_materials = file_materials.map_err(|error| file_error(format!("cannot read the materials: {error}")))?;
    let defined: HashSet<&str> = file_materials.iter().map(|material| material.name.as_str()).collect();
    let undefined = obj.materials.iter().filter(|name| !defined.contains(name.as_str()));
    add_first(
        &mut warnings,
        undefined.map(|name| format!("material \"{name}\" is not defined; the default material is used")),
    );

    let (meshes, used) = assemble(&models, path, &mut warnings)?;
    let (textures, maps) = read_maps(files, &libraries, &mut warnings);
    let material = |index: &Option<usize>| {
        index.map_or_else(Material::default, |index| mtl::material(&file_materials[index], &maps))
    };
    let mut scene = Scene::assemble(spec, Vec::new(), meshes, used.iter().map(material).collect());
    scene.textures = textures;
    scene.warnings = warnings;
    scene.toward_viewer = toward_viewer_of_files();
    Ok(scene.hashed())
}

/// Warnings of one cause that are told one by one; a broken exporter can make one a line.
const TOLD_COUNT: usize = 5;

/// Adds the first warnings of one cause, and the number of those that are left out.
fn add_first(warnings: &mut Vec<String>, of_one_cause: impl IntoIterator<Item = String>) {
    let mut of_one_cause = of_one_cause.into_iter();
    warnings.extend(of_one_cause.by_ref().take(TOLD_COUNT));
    let left_out = of_one_cause.count();
    if left_out > 0 {
        warnings.push(format!("and {left_out} more of the last kind"));
    }
}

/// Reads what the `mtllib` statements name: one file whose name may hold spaces, or else several.
fn read_libraries(
    files: &dyn SceneFiles,
    obj: &ObjText,
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

/// The textures, and the texture of each albedo map. A map that cannot be read adds a warning only.
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
            unreadable.push(format!("{}: cannot read the albedo map: {error}; it is left out", path.display()));
        })
    };
    let indices = libraries.maps.iter().map(|path| read(path).ok()).collect();
    add_first(warnings, unreadable);
    let (textures, coarser) = maps.finish();
    warnings.extend(coarser);
    (textures, indices)
}

/// One mesh a material in order of first use, and for each the material of the file (`None`: the default).
fn assemble(
    models: &[tobj::Model],
    path: &Path,
    warnings: &mut Vec<String>,
) -> Result<(Vec<Mesh>, Vec<Option<usize>>), SceneError> {
    let file_error = |what: String| SceneError::of_file(path, what);
    let mut slots: HashMap<Option<usize>, usize> = HashMap::new();
    let mut meshes: Vec<Mesh> = Vec::new();
    let mut used = Vec::new();
    let (mut degenerate_count, mut crossing_count) = (0, 0);
    for source in models.iter().map(|model| &model.mesh).filter(|mesh| !mesh.indices.is_empty()) {
        let slot = *slots.entry(source.material_id).or_insert_with(|| {
            used.push(source.material_id);
            meshes.push(Mesh::empty(meshes.len()));
            meshes.len() - 1
        });
        let mesh = &mut meshes[slot];
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(source.positions.as_chunks::<3>().0);
        mesh.uvs.extend(source.texcoords.as_chunks::<2>().0);
        mesh.tangents.resize(mesh.positions.len(), [0.0; 4]);
        mesh.normals.extend(source.normals.as_chunks::<3>().0.iter().map(|&n| unit_or_zero(n)));

        let mut corners = source.indices.as_slice();
        let arities = source.face_arities.iter().map(|&arity| arity as usize).chain(std::iter::repeat(3));
        for arity in arities {
            let Some((face, rest)) = corners.split_at_checked(arity).filter(|(face, _)| !face.is_empty()) else {
                break;
            };
            corners = rest;
            let polygon: Vec<DVec3> = face.iter().map(|&index| position(&mesh.positions, base + index)).collect();
            let split = triangulate::triangulate(&polygon).ok_or_else(|| {
                let most = triangulate::MAX_CONCAVE_CORNERS;
                file_error(format!("a face of {arity} corners that its first does not see all of (it is not convex), expected at most {most} corners"))
            })?;
            crossing_count += usize::from(!split.is_simple);
            for triangle in split.triangles {
                if is_degenerate(triangle.map(|k| polygon[k])) {
                    degenerate_count += 1;
                } else {
                    mesh.indices.extend(triangle.map(|k| base + face[k]));
                }
            }
        }
    }
    meshes.retain(|mesh| !mesh.indices.is_empty());
    if meshes.is_empty() {
        return Err(file_error("every face is degenerate (no area), expected at least one triangle".to_owned()));
    }
    if degenerate_count > 0 {
        warnings.push(format!("triangles without area that are left out: {degenerate_count}"));
    }
    if crossing_count > 0 {
        warnings.push(format!("faces that cross themselves, whose triangles overlap: {crossing_count}"));
    }
    normals::fill_missing(&mut meshes);
    meshes.iter_mut().for_each(normals::wind_by_normals);
    Ok((meshes, used))
}

/// The unit vector along `n`; (0, 0, 0), which stands for "compute it", if `n` has no direction.
fn unit_or_zero(n: [f32; 3]) -> [f32; 3] {
    Vec3::from_array(n).as_dvec3().normalize_or_zero().as_vec3().to_array()
}
