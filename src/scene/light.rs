//! Analytic lights.

use glam::DVec3;

/// Kind of an analytic light; the discriminants are `glsl::constants::LIGHT_*`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightKind {
    Directional = 0,
    Point = 1,
}

/// A directional light (`color` = irradiance on a surface facing it) or a point light (`color` = radiant intensity, divided by distance²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    pub kind: LightKind,
    /// Unit direction towards the light, or its position.
    pub position_or_direction: DVec3,
    /// Linear RGB.
    pub color: [f32; 3],
}
