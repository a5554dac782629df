//! Orthographic and perspective cameras.
//!
//! `right` and `up` span the image plane. Pixel (x, y) of a `w` by `h` image has its centre at the
//! plane coordinates
//!
//! ```text
//! s = (2 (x + 0.5) / w - 1) extent_x        t = (1 - 2 (y + 0.5) / h) extent_y
//! ```
//!
//! and its ray is `eye + s right + t up` along `forward` (orthographic), or from `eye` along
//! `forward + s right + t up` (perspective). `shaders/gbuffer` (`gbuffer::params`) inverts this
//! mapping.

use crate::base::names::listed;
use crate::instrument::scene::{Scene, Sphere};
use glam::{DVec2, DVec3};

/// Vertical field of view of the perspective camera, degrees.
pub const PERSPECTIVE_FOV_DEG: f64 = 32.0;
/// Distance of the perspective camera from a unit sphere's centre.
pub const PERSPECTIVE_SPHERE_DISTANCE: f64 = 4.0;
/// Half height of the orthographic image of a unit sphere; other scenes get the same margin of 5 %.
pub const FRAME_MARGIN: f64 = 1.05;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CameraKind {
    #[default]
    Ortho,
    Perspective,
}

listed!(CameraKind, "camera", { "ortho": Ortho, "perspective": Perspective });

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Half of the image's height in world units.
    Ortho { half_height: f64 },
    /// Vertical field of view, degrees.
    Perspective { fov_deg: f64 },
}

/// A rotation of a camera around the middle of the scene's box, and a change of its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// About +y, counter-clockwise from above, degrees.
    pub yaw_deg: f64,
    /// Raises the camera, degrees, up to [`Orbit::POLE_DEG`] from the poles.
    pub pitch_deg: f64,
    /// Multiplies the distance (perspective) or the image's extent (orthographic).
    pub distance: f64,
}

impl Default for Orbit {
    fn default() -> Self {
        Self {
            yaw_deg: 0.0,
            pitch_deg: 0.0,
            distance: 1.0,
        }
    }
}

impl Orbit {
    /// Smallest and largest distance.
    pub const DISTANCE: [f64; 2] = [0.1, 4.0];
    /// Smallest angle between camera and pole, degrees.
    pub const POLE_DEG: f64 = 2.0;

    /// Checks yaw, pitch and distance.
    pub fn new(numbers: [f32; 3]) -> Result<Self, String> {
        let [yaw_deg, pitch_deg, distance] = numbers.map(f64::from);
        let [nearest, farthest] = Self::DISTANCE;
        for (name, value, low, high) in [
            ("yaw", yaw_deg, -360.0, 360.0),
            ("pitch", pitch_deg, -180.0, 180.0),
            ("distance", distance, nearest, farthest),
        ] {
            if !(low..=high).contains(&value) {
                return Err(format!("{name} {value} is outside [{low}, {high}]"));
            }
        }
        Ok(Self {
            yaw_deg,
            pitch_deg,
            distance,
        })
    }

    /// Returns yaw, pitch and distance.
    pub fn numbers(&self) -> [f32; 3] {
        [self.yaw_deg, self.pitch_deg, self.distance].map(|number| number as f32)
    }

    pub fn is_still(&self) -> bool {
        *self == Self::default()
    }
}

/// A camera frame: `right`, `up` and `forward` are orthonormal and `right = forward x up`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub eye: DVec3,
    pub right: DVec3,
    pub up: DVec3,
    pub forward: DVec3,
    pub projection: Projection,
    /// Distances along `forward` that enclose everything visible.
    pub near: f64,
    pub far: f64,
}

impl Camera {
    /// Frames the whole scene in an image of `size` (width, height) pixels.
    ///
    /// A single sphere of radius r is seen from +z: a square of half side 1.05 r (orthographic), or
    /// from a distance of 4 r under 32 degrees (perspective). Other scenes are seen from
    /// `scene.toward_viewer` with a margin of 5 %; `design` has its own camera. Pixels are square:
    /// a wide image sees more to the sides, a tall one more above and below.
    pub fn for_scene(kind: CameraKind, scene: &Scene, size: [u32; 2]) -> Self {
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        if scene.is_design {
            return Self::of_design();
        }
        match (&scene.spheres[..], &scene.meshes[..]) {
            ([sphere], []) => Self::for_sphere(kind, sphere, aspect),
            _ => Self::fitting(kind, scene, aspect),
        }
    }

    fn for_sphere(kind: CameraKind, sphere: &Sphere, aspect: f64) -> Self {
        // A tall image fits the width.
        let stretch = (1.0 / aspect).max(1.0);
        let projection = match kind {
            CameraKind::Ortho => Projection::Ortho {
                half_height: FRAME_MARGIN * sphere.radius * stretch,
            },
            CameraKind::Perspective => perspective(perspective_extent() * stretch),
        };
        Self {
            eye: sphere.center + DVec3::Z * (PERSPECTIVE_SPHERE_DISTANCE * sphere.radius),
            right: DVec3::X,
            up: DVec3::Y,
            forward: DVec3::NEG_Z,
            projection,
            near: (PERSPECTIVE_SPHERE_DISTANCE - 2.0) * sphere.radius,
            far: (PERSPECTIVE_SPHERE_DISTANCE + 2.0) * sphere.radius,
        }
    }

    /// Rotates the camera around the middle of the scene's box, except on `design`.
    pub fn orbited(self, orbit: Orbit, scene: &Scene) -> Self {
        if orbit.is_still() || scene.is_design {
            return self;
        }
        let (low, high) = scene.bounds();
        let middle = 0.5 * (low + high);
        let radius = 0.5 * (high - low).length();
        let backward = -self.forward;
        let pole = 90.0 - Orbit::POLE_DEG;
        let yaw = backward.x.atan2(backward.z) + orbit.yaw_deg.to_radians();
        let pitch = (backward.y.asin().to_degrees() + orbit.pitch_deg)
            .clamp(-pole, pole)
            .to_radians();
        let offset = self.eye - middle;
        let [x, y, z] = [self.right, self.up, backward].map(|axis| axis.dot(offset));
        let backward = DVec3::new(
            yaw.sin() * pitch.cos(),
            pitch.sin(),
            yaw.cos() * pitch.cos(),
        );
        let right = DVec3::Y.cross(backward).normalize();
        let up = backward.cross(right);
        let (projection, scale) = match self.projection {
            Projection::Ortho { half_height } => (
                Projection::Ortho {
                    half_height: half_height * orbit.distance,
                },
                [orbit.distance, 1.0],
            ),
            projection => (projection, [orbit.distance; 2]),
        };
        // An orthographic eye stays in front of the whole scene.
        let z = match projection {
            Projection::Ortho { .. } => z.max(1.5 * radius),
            Projection::Perspective { .. } => z * scale[1],
        };
        Self {
            eye: middle + right * (x * scale[0]) + up * (y * scale[0]) + backward * z,
            right,
            up,
            forward: -backward,
            projection,
            near: (z - 1.01 * radius).max(1e-3 * radius),
            far: z + 1.01 * radius,
        }
    }

    /// The eye is the origin: positions of `design` are opposite to their views.
    fn of_design() -> Self {
        let projection = perspective(perspective_extent());
        let right = DVec3::X;
        let up = DVec3::Y;
        let forward = DVec3::NEG_Z;
        Self {
            eye: DVec3::ZERO,
            right,
            up,
            forward,
            projection,
            near: 0.5,
            far: 2.0,
        }
    }

    /// Finds the nearest camera along `scene.toward_viewer` whose side planes enclose the scene.
    fn fitting(kind: CameraKind, scene: &Scene, aspect: f64) -> Self {
        let extents = Extents::new(scene);
        let Extents {
            right,
            up,
            backward,
            back,
            size,
            ..
        } = extents;
        let Fit {
            eye: [x, y, distance],
            projection,
            near,
        } = match kind {
            CameraKind::Ortho => extents.fit_ortho(aspect),
            CameraKind::Perspective => extents.fit_perspective(aspect),
        };
        Self {
            eye: right * x + up * y + backward * distance,
            right,
            up,
            forward: -backward,
            projection,
            near,
            far: distance - back + 0.5 * size,
        }
    }

    /// Returns half width and half height of the image plane: world units, or at distance 1
    /// (perspective).
    pub fn extent(&self, aspect: f64) -> [f64; 2] {
        let extent_y = match self.projection {
            Projection::Ortho { half_height } => half_height,
            Projection::Perspective { fov_deg } => (0.5 * fov_deg).to_radians().tan(),
        };
        [extent_y * aspect, extent_y]
    }

    /// Returns origin and unit direction of the ray through the centre of pixel (`x`, `y`); row 0
    /// is the top row.
    pub fn ray(&self, x: u32, y: u32, size: [u32; 2]) -> (DVec3, DVec3) {
        let [width, height] = size.map(f64::from);
        let [extent_x, extent_y] = self.extent(width / height);
        let s = (2.0 * (f64::from(x) + 0.5) / width - 1.0) * extent_x;
        let t = (1.0 - 2.0 * (f64::from(y) + 0.5) / height) * extent_y;
        let offset = self.right * s + self.up * t;
        match self.projection {
            Projection::Ortho { .. } => (self.eye + offset, self.forward),
            Projection::Perspective { .. } => (self.eye, (self.forward + offset).normalize()),
        }
    }

    /// Returns column and row of a position, the inverse of [`Camera::ray`]: whole numbers at the
    /// centres of pixels.
    pub fn pixel_of(&self, position: DVec3, size: [u32; 2]) -> DVec2 {
        let [width, height] = size.map(f64::from);
        let [extent_x, extent_y] = self.extent(width / height);
        let offset = position - self.eye;
        let distance = match self.projection {
            Projection::Ortho { .. } => 1.0,
            Projection::Perspective { .. } => offset.dot(self.forward),
        };
        let s = offset.dot(self.right) / (extent_x * distance);
        let t = offset.dot(self.up) / (extent_y * distance);
        DVec2::new(0.5 * (s + 1.0) * width, 0.5 * (1.0 - t) * height) - 0.5
    }

    /// Returns the unit vector from `position` to the viewer.
    pub fn v_at(&self, position: DVec3) -> DVec3 {
        match self.projection {
            Projection::Ortho { .. } => -self.forward,
            Projection::Perspective { .. } => (self.eye - position).normalize(),
        }
    }

    /// Returns scale and offset of `clip.z = scale z + offset` at distance `z` along `forward`,
    /// before division by `clip.w` (1, or `z` for perspective). Depth is 0 at `near` and 1 at
    /// `far`.
    pub fn depth_scale_offset(&self) -> [f64; 2] {
        let range = self.far - self.near;
        match self.projection {
            Projection::Ortho { .. } => [1.0 / range, -self.near / range],
            Projection::Perspective { .. } => [self.far / range, -self.far * self.near / range],
        }
    }
}

/// Returns half the image's height at distance 1 under [`PERSPECTIVE_FOV_DEG`].
fn perspective_extent() -> f64 {
    (0.5 * PERSPECTIVE_FOV_DEG).to_radians().tan()
}

/// Returns the perspective projection with half height `extent_y` at distance 1.
fn perspective(extent_y: f64) -> Projection {
    if extent_y == perspective_extent() {
        return Projection::Perspective {
            fov_deg: PERSPECTIVE_FOV_DEG,
        };
    }
    Projection::Perspective {
        fov_deg: 2.0 * extent_y.atan().to_degrees(),
    }
}

/// Returns the largest `dot(p, direction)` over all points p; `direction` may have any length.
fn support(scene: &Scene, direction: DVec3) -> f64 {
    let sphere = |s: &Sphere| s.center.dot(direction) + s.radius * direction.length();
    let spheres = scene.spheres.iter().map(sphere);
    spheres.fold(scene.meshes.support(direction), f64::max)
}

/// The extents of a scene along the axes of a camera.
struct Extents<'a> {
    scene: &'a Scene,
    right: DVec3,
    up: DVec3,
    backward: DVec3,
    /// Lowest and highest coordinate along `right`, `up` and `backward`.
    left_most: f64,
    right_most: f64,
    bottom: f64,
    top: f64,
    back: f64,
    front: f64,
    /// The largest of the three extents.
    size: f64,
}

/// A camera that encloses a scene.
struct Fit {
    /// Along `right`, `up` and `backward`.
    eye: [f64; 3],
    projection: Projection,
    near: f64,
}

impl<'a> Extents<'a> {
    fn new(scene: &'a Scene) -> Self {
        let backward = scene.toward_viewer;
        let right = DVec3::Y.cross(backward).normalize();
        let up = backward.cross(right);
        let reach = |direction: DVec3| support(scene, direction);
        let [left_most, right_most] = [-reach(-right), reach(right)];
        let [bottom, top] = [-reach(-up), reach(up)];
        let [back, front] = [-reach(-backward), reach(backward)];
        Self {
            scene,
            right,
            up,
            backward,
            left_most,
            right_most,
            bottom,
            top,
            back,
            front,
            // Loading refuses empty scenes; the floor keeps the frame finite.
            size: (right_most - left_most)
                .max(top - bottom)
                .max(front - back)
                .max(f64::MIN_POSITIVE),
        }
    }

    fn fit_ortho(&self, aspect: f64) -> Fit {
        let half_width = 0.5 * FRAME_MARGIN * (self.right_most - self.left_most);
        let half_height = 0.5 * FRAME_MARGIN * (self.top - self.bottom);
        Fit {
            eye: [
                0.5 * (self.left_most + self.right_most),
                0.5 * (self.bottom + self.top),
                self.front + self.size,
            ],
            projection: Projection::Ortho {
                half_height: half_height.max(half_width / aspect),
            },
            near: 0.5 * self.size,
        }
    }

    fn fit_perspective(&self, aspect: f64) -> Fit {
        let Self {
            right,
            up,
            backward,
            ..
        } = *self;
        let reach = |direction: DVec3| support(self.scene, direction);
        let extent_y = perspective_extent() * (1.0 / aspect).max(1.0);
        // The plane through the eye with slope e is `x - eye_x <= e (eye_z - z)`. It touches the
        // scene at the support of (1, 0, e), so the sum of both sides gives eye_z and their
        // difference eye_x.
        let slope_x = extent_y * aspect / FRAME_MARGIN;
        let slope_y = extent_y / FRAME_MARGIN;
        let [to_right, to_left] = [
            reach(right + backward * slope_x),
            reach(backward * slope_x - right),
        ];
        let [to_top, to_bottom] = [
            reach(up + backward * slope_y),
            reach(backward * slope_y - up),
        ];
        let distance =
            ((to_right + to_left) / (2.0 * slope_x)).max((to_top + to_bottom) / (2.0 * slope_y));
        Fit {
            eye: [
                0.5 * (to_right - to_left),
                0.5 * (to_top - to_bottom),
                distance,
            ],
            projection: perspective(extent_y),
            // A long scene may reach up to the eye: half of the gap stays free.
            near: (0.5 * (distance - self.front)).max(1e-4 * self.size),
        }
    }
}
