//! What is looked at: cameras, spheres, meshes, materials, lights.

pub mod camera;
pub mod light;
pub mod material;
pub mod mesh;

pub use camera::{Camera, Projection};
pub use light::{Light, LightKind};
pub use material::{Material, MaterialOverride};
pub use mesh::Mesh;

use crate::pixels::RgbImage;
use glam::DVec3;

/// An exact (never tessellated) sphere.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    pub center: DVec3,
    pub radius: f64,
    /// Index into [`Scene::materials`].
    pub material: usize,
}

/// Geometry and materials; the camera is chosen apart from it.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What the user wrote: `sphere`, `spheres`, `plane` or a path.
    pub name: String,
    pub spheres: Vec<Sphere>,
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Material>,
    /// Albedo textures, linear RGB; [`Material::albedo_map`] indexes them.
    pub textures: Vec<RgbImage>,
    /// blake3 (hex) of everything that determines the geometry, materials and textures.
    pub hash: String,
    /// Odd but usable facts about the input, one sentence each.
    pub warnings: Vec<String>,
}
