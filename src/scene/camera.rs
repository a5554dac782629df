//! Cameras: orthographic and perspective; rays through pixel centres.

use glam::DVec3;

/// How a camera maps the view volume to the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// `half_height` in world units covers half of the image's height; every view vector is parallel.
    Ortho { half_height: f64 },
    /// Vertical field of view in degrees.
    Perspective { fov_deg: f64 },
}

/// A camera frame: `right`, `up` and `forward` are orthonormal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub eye: DVec3,
    pub right: DVec3,
    pub up: DVec3,
    pub forward: DVec3,
    pub projection: Projection,
    /// Distances along `forward` that bound everything visible.
    pub near: f64,
    pub far: f64,
}
