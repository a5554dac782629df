//! Scenes for the live view: exact spheres, and triangles in 16-bit numbers, packed like images.
//!
//! Positions are fractions of the scene's box (error at most 1/131070 of its side). Normals are octahedral \[Cigolle14\], in signed fractions of
//! 32767 (error below 0.01 degrees).

use super::images::short_text;
use crate::experiment::axis;
use crate::experiment::plan::Plan;
use crate::glsl::constants::ALPHA_MIN;
use crate::pipeline::RenderRequest;
use crate::pixels::packed;
use crate::scene::{Camera, CameraKind, Material, Mesh, Projection, Scene};
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Most triangles of all scenes. A scene beyond that is shown as a sphere.
pub const TRIANGLES_MAX: usize = 100_000;
const SCENE_COUNT: usize = 4;
/// Vertices of a part have 16-bit indices.
const PART_VERTICES_MAX: usize = 1 << 16;

/// A scene and the camera through which the run looks at it.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct LiveModel {
    pub label: String,
    /// Differences to the run, one sentence; may be empty.
    pub note: String,
    /// Corners of the box around the scene.
    pub low: [f64; 3],
    pub high: [f64; 3],
    pub camera: LiveCamera,
    pub spheres: Vec<LiveSphere>,
    pub parts: Vec<LivePart>,
}

/// A camera that can be turned about the middle of the scene's box.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct LiveCamera {
    /// From the middle to the eye, along the camera's right, up and backward.
    pub offset: [f64; 3],
    /// Rotation of the backward axis (0, 0, 1) about +y, then its elevation; radians.
    pub yaw: f64,
    pub pitch: f64,
    /// Half width and half height of the image plane: world units, or at distance 1 from the eye.
    pub extent: [f64; 2],
    pub is_perspective: bool,
}

/// A material with the means of its textures.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct LiveSurface {
    pub albedo: [f32; 3],
    pub metallic: f32,
    pub alpha: f32,
    pub f0: [f32; 3],
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct LiveSphere {
    pub center: [f64; 3],
    pub radius: f64,
    pub surface: LiveSurface,
}

/// Triangles of one surface; the texts are from [`packed::words`].
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct LivePart {
    pub surface: LiveSurface,
    pub vertex_count: usize,
    /// Fractions of the box, in 65535ths.
    pub positions: String,
    /// Two octahedral coordinates as signed 32767ths, and a zero.
    pub normals: String,
    pub triangle_count: usize,
    /// Three vertices each, counter-clockwise as seen from the side of their normals.
    pub triangles: String,
}

/// The first scenes of a plan, with the materials of their first cells.
pub fn models(plan: &Plan) -> Vec<LiveModel> {
    let mut models: Vec<LiveModel> = Vec::new();
    for cell in &plan.cells {
        let label = short_text(axis::Named::own(axis::SCENE), &cell.point);
        if models.len() < SCENE_COUNT && models.iter().all(|known| known.label != label) {
            let kept: usize = models.iter().flat_map(|known| &known.parts).map(|part| part.triangle_count).sum();
            models.push(model(&label, &plan.request(&cell.point), TRIANGLES_MAX - kept));
        }
    }
    models
}

fn model(label: &str, request: &RenderRequest, triangles_max: usize) -> LiveModel {
    let (scene, aspect) = (&request.scene, f64::from(request.size[0]) / f64::from(request.size[1]));
    if scene.is_design {
        let note = format!("{label} is not a picture, so a sphere is shown.");
        return sphere(label, note, request);
    }
    let count: usize = scene.meshes.iter().map(|mesh| mesh.indices.len() / 3).sum();
    if count > triangles_max {
        let note =
            format!("{label} has {count} triangles, but the page has room for {triangles_max}, so a sphere is shown.");
        return sphere(label, note, request);
    }
    let has_map = scene.materials.iter().any(|material| material.maps().next().is_some());
    let notes = [
        (has_map, format!("The textures of {label} are replaced by their means.")),
        (scene.has_coat(), format!("The clear coat of {label} is left out.")),
        (scene.has_sheen(), format!("The sheen of {label} is left out.")),
        (scene.has_anisotropy(), format!("The anisotropy of {label} is left out.")),
    ];
    let notes: Vec<String> = notes.into_iter().filter(|(applies, _)| *applies).map(|(_, note)| note).collect();
    of_scene(label, notes.join(" "), scene, &request.camera, aspect)
}

/// The unit sphere in place of a scene that is not kept.
fn sphere(label: &str, note: String, request: &RenderRequest) -> LiveModel {
    let material = request.scene.materials.first().map(|material| averaged(&request.scene, material));
    let kind = match request.camera.projection {
        Projection::Ortho { .. } => CameraKind::Ortho,
        Projection::Perspective { .. } => CameraKind::Perspective,
    };
    let mut scene = Scene::sphere();
    scene.materials = vec![material.unwrap_or_default()];
    let camera = Camera::for_scene(kind, &scene, [1, 1]);
    of_scene(label, note, &scene, &camera, 1.0)
}

fn of_scene(label: &str, note: String, scene: &Scene, camera: &Camera, aspect: f64) -> LiveModel {
    let (low, high) = scene.bounds();
    let surface = |index: usize| {
        let Material { albedo, metallic, alpha, f0, .. } = averaged(scene, &scene.materials[index]);
        LiveSurface { albedo, metallic, alpha, f0 }
    };
    let offset = camera.eye - 0.5 * (low + high);
    LiveModel {
        label: label.to_owned(),
        note,
        low: low.to_array(),
        high: high.to_array(),
        camera: LiveCamera {
            offset: [camera.right, camera.up, -camera.forward].map(|axis| axis.dot(offset)),
            yaw: (-camera.forward.x).atan2(-camera.forward.z),
            pitch: (-camera.forward.y).asin(),
            extent: camera.extent(aspect),
            is_perspective: matches!(camera.projection, Projection::Perspective { .. }),
        },
        spheres: scene
            .spheres
            .iter()
            .map(|s| LiveSphere { center: s.center.to_array(), radius: s.radius, surface: surface(s.material) })
            .collect(),
        parts: scene.meshes.iter().flat_map(|mesh| parts(mesh, &surface(mesh.material), low, high)).collect(),
    }
}

/// The material with the means of its textures.
fn averaged(scene: &Scene, material: &Material) -> Material {
    let mean = |map: Option<usize>| map.map_or([1.0; 3], |map| scene.textures[map].mean());
    let albedo = mean(material.albedo_map);
    let roughness = mean(material.roughness_map)[1];
    Material {
        name: material.name.clone(),
        albedo: std::array::from_fn(|c| material.albedo[c] * albedo[c]),
        metallic: material.metallic * mean(material.metallic_map)[2],
        alpha: (material.alpha * roughness.powi(2)).max(ALPHA_MIN),
        f0: material.f0,
        ..Material::default()
    }
}

/// Splits a mesh into parts of at most [`PART_VERTICES_MAX`] vertices.
fn parts(mesh: &Mesh, surface: &LiveSurface, low: DVec3, high: DVec3) -> Vec<LivePart> {
    let mut parts = Vec::new();
    let (mut places, mut vertices, mut triangles) = (HashMap::new(), Vec::new(), Vec::new());
    for triangle in mesh.triangles() {
        if vertices.len() + 3 > PART_VERTICES_MAX {
            parts.push(part(mesh, surface, &vertices, &triangles, [low, high]));
            places.clear();
            vertices.clear();
            triangles.clear();
        }
        triangles.push(triangle.map(|index| {
            *places.entry(index).or_insert_with(|| {
                vertices.push(index as usize);
                (vertices.len() - 1) as u16
            })
        }));
    }
    parts.push(part(mesh, surface, &vertices, &triangles, [low, high]));
    parts
}

fn part(
    mesh: &Mesh,
    surface: &LiveSurface,
    vertices: &[usize],
    triangles: &[[u16; 3]],
    [low, high]: [DVec3; 2],
) -> LivePart {
    // A side of length 0 has one place.
    let side = (high - low).max(DVec3::splat(f64::MIN_POSITIVE));
    let position = |&i: &usize| {
        let fraction = (Vec3::from_array(mesh.positions[i]).as_dvec3() - low) / side;
        (fraction * 65535.0).round().to_array().map(|x| x as u16)
    };
    let positions: Vec<[u16; 3]> = vertices.iter().map(position).collect();
    let normals: Vec<[u16; 3]> = vertices.iter().map(|&i| octahedral(mesh.normals[i])).collect();
    LivePart {
        surface: surface.clone(),
        vertex_count: vertices.len(),
        positions: packed::words(&positions),
        normals: packed::words(&normals),
        triangle_count: triangles.len(),
        triangles: packed::words(triangles),
    }
}

/// Octahedral coordinates of a unit vector; `shaders/page/mesh.vert` has the inverse.
fn octahedral(n: [f32; 3]) -> [u16; 3] {
    let [x, y, z] = n.map(f64::from);
    let sum = x.abs() + y.abs() + z.abs();
    let [x, y] = [x / sum, y / sum];
    let folded = |a: f64, b: f64| if z < 0.0 { (1.0 - b.abs()).copysign(a) } else { a };
    let word = |a: f64| (a * 32767.0).round() as i16 as u16;
    [word(folded(x, y)), word(folded(y, x)), 0]
}
