//! Scenes for the live view: exact spheres, and triangles in 16-bit numbers, packed like images.
//!
//! Positions are fractions of the scene's box (error at most 1/131070 of its side). Normals are
//! octahedral \[Cigolle14\], in signed fractions of 32767 (error below 0.01 degrees).

use crate::base::pixels::packed;
use crate::experiment::axis;
use crate::experiment::plan::Plan;
use crate::instrument::pipeline::RenderRequest;
use crate::instrument::scene::{Camera, CameraKind, Material, Mesh, Projection, Scene};
use crate::run::images::short_text;
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

/// A material with the means of its textures. Every roughness is perceptual.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct LiveSurface {
    pub albedo: [f32; 3],
    pub metallic: f32,
    pub roughness: f32,
    pub f0: [f32; 3],
    pub anisotropy: f32,
    /// Turn of the tangent, degrees.
    pub anisotropy_turn: f32,
    pub coat: f32,
    pub coat_roughness: f32,
    pub sheen: [f32; 3],
    pub sheen_roughness: f32,
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
    /// The same for tangents, with the handedness (1 or -1) for the zero; empty if the mesh has
    /// none.
    pub tangents: String,
    pub triangle_count: usize,
    /// Three vertices each, counter-clockwise as seen from the side of their normals.
    pub triangles: String,
}

/// The first scenes of a plan, with the materials of their first cells.
pub fn models(plan: &Plan) -> Vec<LiveModel> {
    let mut models: Vec<LiveModel> = Vec::new();
    for cell in &plan.cells {
        if models.len() == SCENE_COUNT {
            break;
        }
        let label = short_text(axis::Named::primary(axis::SCENE), &cell.point);
        if models.iter().any(|known| known.label == label) {
            continue;
        }
        let triangle_count: usize = models
            .iter()
            .flat_map(|known| &known.parts)
            .map(|part| part.triangle_count)
            .sum();
        let triangles_left = TRIANGLES_MAX - triangle_count;
        models.push(model(&label, &plan.request(&cell.point), triangles_left));
    }
    models
}

fn model(label: &str, request: &RenderRequest, triangles_max: usize) -> LiveModel {
    let scene = &request.scene;
    let aspect = f64::from(request.size[0]) / f64::from(request.size[1]);
    if scene.is_design {
        let note = format!("{label} is not a picture, so a sphere is shown.");
        return sphere(label, note, request);
    }
    let count: usize = scene.meshes.iter().map(|mesh| mesh.indices.len() / 3).sum();
    if count > triangles_max {
        let note = format!(
            "{label} has {count} triangles, but the page has room for {triangles_max}, so a sphere \
             is shown."
        );
        return sphere(label, note, request);
    }
    let note = if scene.textures.is_empty() {
        String::new()
    } else {
        format!("The textures of {label} are replaced by their means.")
    };
    whole_scene(label, note, scene, &request.camera, aspect)
}

/// The unit sphere in place of a scene that is not kept.
fn sphere(label: &str, note: String, request: &RenderRequest) -> LiveModel {
    let kind = match request.camera.projection {
        Projection::Ortho { .. } => CameraKind::Ortho,
        Projection::Perspective { .. } => CameraKind::Perspective,
    };
    let mut scene = Scene::sphere();
    scene.materials = vec![request.scene.materials.first().cloned().unwrap_or_default()];
    scene.textures.clone_from(&request.scene.textures);
    let camera = Camera::for_scene(kind, &scene, [1, 1]);
    whole_scene(label, note, &scene, &camera, 1.0)
}

fn whole_scene(
    label: &str,
    note: String,
    scene: &Scene,
    camera: &Camera,
    aspect: f64,
) -> LiveModel {
    let (low, high) = scene.bounds();
    let surface = |index: usize| averaged(scene, &scene.materials[index]);
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
            .map(|s| LiveSphere {
                center: s.center.to_array(),
                radius: s.radius,
                surface: surface(s.material),
            })
            .collect(),
        parts: scene
            .meshes
            .iter()
            .flat_map(|mesh| parts(mesh, &surface(mesh.material), low, high))
            .collect(),
    }
}

/// The material with the means of its textures.
fn averaged(scene: &Scene, material: &Material) -> LiveSurface {
    let mean = |map: Option<usize>| map.map_or([1.0; 3], |map| scene.textures[map].mean());
    let scaled = |color: [f32; 3], map| std::array::from_fn(|c| color[c] * mean(map)[c]);
    // Roughness is in the green channel of its map, metallic in the blue one.
    let roughness = |alpha: f32, map| alpha.sqrt() * mean(map)[1];
    let Material {
        anisotropy,
        coat,
        sheen,
        ..
    } = material;
    // Without a map the direction is +x.
    let direction = anisotropy
        .map
        .map_or(Vec3::X, |map| scene.textures[map].mean().into());
    LiveSurface {
        albedo: scaled(material.albedo, material.albedo_map),
        metallic: material.metallic * mean(material.metallic_map)[2],
        roughness: roughness(material.alpha, material.roughness_map),
        f0: scaled(material.f0, material.f0_map),
        anisotropy: anisotropy.strength * direction.truncate().length(),
        anisotropy_turn: (anisotropy.turn + direction.y.atan2(direction.x)).to_degrees(),
        coat: coat.weight * mean(coat.weight_map)[0],
        coat_roughness: roughness(coat.alpha, coat.roughness_map),
        sheen: scaled(sheen.color, sheen.color_map),
        sheen_roughness: roughness(sheen.alpha, sheen.roughness_map),
    }
}

/// Splits a mesh into parts of at most [`PART_VERTICES_MAX`] vertices.
fn parts(mesh: &Mesh, surface: &LiveSurface, low: DVec3, high: DVec3) -> Vec<LivePart> {
    let mut parts = Vec::new();
    // Of the current part: indices of its vertices by their index in the mesh, and the reverse.
    let mut part_indices: HashMap<u32, u16> = HashMap::new();
    let mut vertices: Vec<usize> = Vec::new();
    let mut triangles: Vec<[u16; 3]> = Vec::new();
    for triangle in mesh.triangles() {
        if vertices.len() + 3 > PART_VERTICES_MAX {
            parts.push(part(mesh, surface, &vertices, &triangles, [low, high]));
            part_indices.clear();
            vertices.clear();
            triangles.clear();
        }
        triangles.push(triangle.map(|index| {
            *part_indices.entry(index).or_insert_with(|| {
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
    // On a side of length 0 every fraction is 0.
    let side = (high - low).max(DVec3::splat(f64::MIN_POSITIVE));
    let positions: Vec<[u16; 3]> = vertices
        .iter()
        .map(|&vertex| {
            let fraction = (Vec3::from_array(mesh.positions[vertex]).as_dvec3() - low) / side;
            (fraction * 65535.0).round().to_array().map(|x| x as u16)
        })
        .collect();
    let normals: Vec<[u16; 3]> = vertices
        .iter()
        .map(|&vertex| octahedral(mesh.normals[vertex], 0.0))
        .collect();
    let tangents: Vec<[u16; 3]> = vertices
        .iter()
        .map(|&vertex| packed_tangent(mesh.tangents[vertex]))
        .collect();
    let has_tangents = tangents.iter().any(|tangent| tangent[2] != 0);
    LivePart {
        surface: surface.clone(),
        vertex_count: vertices.len(),
        positions: packed::words(&positions),
        normals: packed::words(&normals),
        tangents: if has_tangents {
            packed::words(&tangents)
        } else {
            String::new()
        },
        triangle_count: triangles.len(),
        triangles: packed::words(triangles),
    }
}

/// A tangent and its handedness; zeros if the vertex has none, which is a tangent of length 0.
fn packed_tangent([x, y, z, handedness]: [f32; 4]) -> [u16; 3] {
    if [x, y, z] == [0.0; 3] {
        [0; 3]
    } else {
        octahedral([x, y, z], handedness)
    }
}

/// Octahedral coordinates of a vector, and `side`; `shaders/page/mesh.vert` has the inverse.
fn octahedral(n: [f32; 3], side: f32) -> [u16; 3] {
    let [x, y, z] = n.map(f64::from);
    let sum = x.abs() + y.abs() + z.abs();
    let [x, y] = [x / sum, y / sum];
    let folded = |a: f64, b: f64| {
        if z < 0.0 {
            (1.0 - b.abs()).copysign(a)
        } else {
            a
        }
    };
    let word = |a: f64| (a * 32767.0).round() as i16 as u16;
    [word(folded(x, y)), word(folded(y, x)), side as i16 as u16]
}
