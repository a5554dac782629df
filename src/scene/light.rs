//! Analytic lights.

use super::{Scene, Sphere};
use crate::spelling::listed;
use glam::DVec3;

/// Kind of an analytic light; the discriminants are `glsl::constants::LIGHT_*`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightKind {
    Directional = 0,
    Point = 1,
}

listed!(LightKind, "kind of light", { "directional": Directional, "point": Point });

/// A directional light (`color` = irradiance on a surface facing it) or a point light (`color` = radiant intensity, divided by distance²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    pub kind: LightKind,
    /// Unit direction towards the light, or its position.
    pub position_or_direction: DVec3,
    /// Linear RGB.
    pub color: [f32; 3],
}

impl Light {
    /// Why the light cannot stand in a scene: a point light in a sphere is below the horizon of all of its surface, and on it the distance
    /// is 0. What is inside a mesh, which need not be closed, is not asked.
    pub fn fault_in(&self, scene: &Scene) -> Option<String> {
        let p = self.position_or_direction;
        let around = |sphere: &&Sphere| p.distance(sphere.center) <= sphere.radius;
        let sphere = scene.spheres.iter().find(around).filter(|_| self.kind == LightKind::Point)?;
        let [place, center] = [p, sphere.center].map(|v| format!("({}, {}, {})", v.x, v.y, v.z));
        let (radius, scene) = (sphere.radius, &scene.name);
        Some(format!(
            "the point light at {place} is in the sphere of scene {scene} with centre {center} and radius {radius}, which it cannot light; \
             expected a place outside"
        ))
    }
}
