//! Six square faces in the order of Vulkan: +x, -x, +y, -y, +z, -z.

use super::MapLayout;
use crate::base::glsl::constants::EDGE_SOFTNESS;
use glam::{DVec2, DVec3};

pub const LAYOUT: MapLayout = MapLayout {
    name: "cube",
    about: "six faces, filtered across their edges by the hardware",
    mapping: "six faces below each other, +x, -x, +y, -y, +z, -z, each as Vulkan selects and lays \
              out the faces of a cube map",
    face_count: 6,
    is_square: true,
    side_min: 4,
    prefilter_size: [128; 2],
    irradiance_size: [18; 2],
    finest_size: |[_, height]| [(height / 2).max(1).next_power_of_two(); 2],
    face_uv,
    direction,
    texel_solid_angle: |d, [width, height], omega_s| {
        4.0 / f64::from(width * height) * mean_major(d.abs(), omega_s).powi(3)
    },
    texel,
};

/// Returns the largest component of a direction. Its mean over a sample of `omega_s` is larger on
/// edges and corners, where another component becomes the largest; ignoring that, 40 samples lose a
/// tenth of the light of a lamp on a corner.
fn mean_major(a: DVec3, omega_s: f64) -> f64 {
    let softened = |a: f64, b: f64| {
        0.5 * (a + b + ((a - b).powi(2) + f64::from(EDGE_SOFTNESS) * omega_s).sqrt())
    };
    softened(softened(a.x, a.y), a.z).min(1.0)
}

fn face_uv(d: DVec3) -> (u32, DVec2) {
    let a = d.abs();
    // The major axis chooses the face; the others are its coordinates.
    let face;
    let st;
    if a.x >= a.y && a.x >= a.z {
        face = u32::from(d.x < 0.0);
        st = DVec2::new(-d.x.signum() * d.z, -d.y) / a.x;
    } else if a.y >= a.z {
        face = 2 + u32::from(d.y < 0.0);
        st = DVec2::new(d.x, d.y.signum() * d.z) / a.y;
    } else {
        face = 4 + u32::from(d.z < 0.0);
        st = DVec2::new(d.z.signum() * d.x, -d.y) / a.z;
    }
    (face, 0.5 * (st + 1.0))
}

fn direction(face: u32, uv: DVec2) -> DVec3 {
    on_face(face, uv).normalize()
}

/// Returns the point on the cube whose faces have distance 1.
fn on_face(face: u32, uv: DVec2) -> DVec3 {
    let st = 2.0 * uv - 1.0;
    let sign = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
    match face / 2 {
        0 => DVec3::new(sign, -st.y, -sign * st.x),
        1 => DVec3::new(st.x, sign, sign * st.y),
        _ => DVec3::new(sign * st.x, -st.y, sign),
    }
}

/// A texel one step outside a face, seen from the centre, lies in the outermost row of the next
/// face.
fn texel(face: u32, [x, y]: [i64; 2], [side, _]: [u32; 2]) -> Option<[u32; 3]> {
    let is_inside = |i: i64| (0..i64::from(side)).contains(&i);
    match (is_inside(x), is_inside(y)) {
        (true, true) => Some([face, x as u32, y as u32]),
        (false, false) => None,
        _ => {
            let centre = (DVec2::new(x as f64, y as f64) + 0.5) / f64::from(side);
            let (next, uv) = face_uv(on_face(face, centre));
            let last = f64::from(side - 1);
            let [x, y] =
                [uv.x, uv.y].map(|u| (u * f64::from(side)).floor().clamp(0.0, last) as u32);
            Some([next, x, y])
        }
    }
}
