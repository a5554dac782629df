//! Scenes that need no file.

use super::shader_ball::shader_ball;
use super::{Material, Mesh, Scene, Sphere, toward};
use glam::DVec3;

#[derive(Clone, Copy, Debug)]
pub struct SceneEntry {
    /// Name in configs and tables.
    pub name: &'static str,
    /// One line for `splitsum list scenes`.
    pub description: &'static str,
    /// As [`Scene::is_design`] of what `build` makes.
    pub is_design: bool,
    pub(crate) build: fn() -> Scene,
}

pub static SCENES: &[SceneEntry] = &[
    SceneEntry {
        name: "sphere",
        description: "the exact unit sphere at the origin, one grey dielectric (f0 0.04, albedo \
                      0.8, alpha 0.25)",
        is_design: false,
        build: sphere,
    },
    SceneEntry {
        name: "spheres",
        description: "a grid of exact spheres: alpha 1, 0.5, 0.25, 0.1, 0.05 from left to right, \
                      metallic 0, 0.5, 1 from bottom to top; \
                      the top right one reflects everything",
        is_design: false,
        build: spheres,
    },
    SceneEntry {
        name: "shader-ball",
        description: "a sphere with an opening that shows a smaller one, in a cup; the material of \
                      `sphere`",
        is_design: false,
        build: shader_ball,
    },
    SceneEntry {
        name: "design",
        description: "for statistics, not a picture: every pixel has its own mirror direction, n·v \
                      and plane of incidence, spread evenly",
        is_design: true,
        build: design,
    },
    SceneEntry {
        name: "plane",
        description: "a horizontal rectangle seen at a grazing angle: n_dot_v falls from front to \
                      back under the perspective camera",
        is_design: false,
        build: plane,
    },
];

/// Widths of the columns of `spheres`, left to right.
pub const SPHERES_ALPHA: [f32; 5] = [1.0, 0.5, 0.25, 0.1, 0.05];
/// Metallic of the rows of `spheres`, bottom to top.
pub const SPHERES_METALLIC: [f32; 3] = [0.0, 0.5, 1.0];
/// Distance between centres of neighbouring spheres, in radii.
const SPHERES_PITCH: f64 = 2.2;

/// Whether the scene of this name is a design: each pixel is an independent experiment.
pub fn is_design(name: &str) -> bool {
    SCENES
        .iter()
        .any(|scene| scene.name == name && scene.is_design)
}

pub(super) fn sphere() -> Scene {
    let sphere = Sphere {
        center: DVec3::ZERO,
        radius: 1.0,
        material: 0,
    };
    Scene::assemble(
        "sphere",
        vec![sphere],
        Vec::new(),
        vec![Material::default()],
    )
}

/// The material of `sphere`; see `gbuffer::design`.
fn design() -> Scene {
    Scene {
        name: "design".to_owned(),
        is_design: true,
        ..sphere()
    }
    .hashed()
}

/// A grid of unit spheres in the plane z = 0, smoother to the right and more metallic upwards
/// (source document 0). The top right one is fully reflective (albedo 1, metallic 1, the smallest
/// alpha).
fn spheres() -> Scene {
    let columns = SPHERES_ALPHA.len();
    let rows = SPHERES_METALLIC.len();
    let centred = |i: usize, count: usize| (i as f64 - 0.5 * (count as f64 - 1.0)) * SPHERES_PITCH;
    let mut spheres = Vec::new();
    let mut materials = Vec::new();
    for (row, &metallic) in SPHERES_METALLIC.iter().enumerate() {
        for (column, &alpha) in SPHERES_ALPHA.iter().enumerate() {
            let center = DVec3::new(centred(column, columns), centred(row, rows), 0.0);
            spheres.push(Sphere {
                center,
                radius: 1.0,
                material: materials.len(),
            });
            let mut material = Material {
                name: format!("alpha {alpha} metallic {metallic}"),
                metallic,
                alpha,
                ..Material::default()
            };
            if (column, row) == (columns - 1, rows - 1) {
                material.name = "fully reflective".to_owned();
                material.albedo = [1.0; 3];
            }
            materials.push(material);
        }
    }
    Scene::assemble("spheres", spheres, Vec::new(), materials)
}

/// The rectangle [-1, 1] x [-2, 2] of the plane y = 0, seen from 20 degrees above the horizon.
fn plane() -> Scene {
    let half_width = 1.0;
    let half_depth = 2.0;
    let corner = |u: f32, v: f32| {
        [
            (2.0 * u - 1.0) * half_width,
            0.0,
            (1.0 - 2.0 * v) * half_depth,
        ]
    };
    let uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mesh = Mesh {
        positions: uvs.iter().map(|&[u, v]| corner(u, v)).collect(),
        normals: vec![[0.0, 1.0, 0.0]; 4],
        uvs,
        tangents: vec![[0.0; 4]; 4],
        indices: vec![0, 1, 2, 0, 2, 3],
        material: 0,
    };
    let mut scene = Scene::assemble("plane", Vec::new(), vec![mesh], vec![Material::default()]);
    scene.toward_viewer = toward(0.0, 20.0);
    scene.hashed()
}
