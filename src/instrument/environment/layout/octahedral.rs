//! The unfolded octahedron, +y in the centre, -y in the corners: texels of equal solid angle
//! \[ClarbergSquare08\].

use super::MapLayout;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI};

pub const LAYOUT: MapLayout = MapLayout {
    name: "octahedral",
    about: "one square of texels of equal solid angle, filtered by the shader across its edges",
    mapping: "equal-area octahedron: +y in the centre, -y in the corners, +x to the right, +z down",
    face_count: 1,
    is_square: true,
    side_min: 8,
    prefilter_size: [320; 2],
    irradiance_size: [45; 2],
    finest_size: |[_, height]| [height.next_power_of_two(); 2],
    face_uv,
    direction,
    texel_solid_angle: |_, [width, height], _| 4.0 * PI / f64::from(width * height),
    texel,
};

fn face_uv(d: DVec3) -> (u32, DVec2) {
    let x = d.x.abs();
    let z = d.z.abs();
    let r = ((x * x + z * z) / (1.0 + d.y.abs())).sqrt();
    let v = r * z.atan2(x) * FRAC_2_PI;
    let upper = DVec2::new(r - v, v);
    let uv = if d.y < 0.0 {
        DVec2::new(1.0 - upper.y, 1.0 - upper.x)
    } else {
        upper
    };
    (
        0,
        0.5 + 0.5 * DVec2::new(uv.x.copysign(d.x), uv.y.copysign(d.z)),
    )
}

fn direction(_: u32, uv: DVec2) -> DVec3 {
    let signed = 2.0 * uv - 1.0;
    let a = signed.abs();
    let from_fold = 1.0 - (a.x + a.y);
    let r = 1.0 - from_fold.abs();
    let share = match (r > 0.0, from_fold < 0.0) {
        (false, _) => 0.0,
        (true, true) => (1.0 - a.x) / r,
        (true, false) => a.y / r,
    };
    let (sin, cos) = (FRAC_PI_2 * share).sin_cos();
    let horizontal = r * (2.0 - r * r).sqrt();
    let y = (1.0 - r * r).copysign(from_fold);
    DVec3::new(
        (horizontal * cos).copysign(signed.x),
        y,
        (horizontal * sin).copysign(signed.y),
    )
}

/// Each edge of the square is folded in its middle.
fn texel(_: u32, [mut x, mut y]: [i64; 2], [side, _]: [u32; 2]) -> Option<[u32; 3]> {
    let last = i64::from(side) - 1;
    if !(0..=last).contains(&x) {
        (x, y) = (x.clamp(0, last), last - y);
    }
    if !(0..=last).contains(&y) {
        (x, y) = (last - x, y.clamp(0, last));
    }
    Some([0, x as u32, y as u32])
}
