//! Analytic lights.

use super::{Scene, Sphere};
use crate::spelling::listed;
use glam::DVec3;

/// Discriminants are `glsl::constants::LIGHT_*`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightKind {
    Directional = 0,
    Point = 1,
}

listed!(LightKind, "kind of light", { "directional": Directional, "point": Point });

/// `color` is irradiance on a surface facing a directional light, or radiant intensity of a point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    pub kind: LightKind,
    /// Unit direction towards the light, or its position.
    pub position_or_direction: DVec3,
    /// Linear RGB.
    pub color: [f32; 3],
}

impl Light {
    /// Reports a point light inside a sphere, where it would light nothing. Meshes need not be closed and are not checked.
    pub fn fault_in(&self, scene: &Scene) -> Option<String> {
        let p = self.position_or_direction;
        let around = |sphere: &&Sphere| p.distance(sphere.center) <= sphere.radius;
        let sphere = scene.spheres.iter().find(around).filter(|_| self.kind == LightKind::Point)?;
        let [place, center] = [p, sphere.center].map(|v| format!("({}, {}, {})", v.x, v.y, v.z));
        let (radius, scene) = (sphere.radius, &scene.name);
        Some(format!(
            "the point light at {place} is inside a sphere of scene {scene} (centre {center}, radius {radius}); move it outside"
        ))
    }
}
