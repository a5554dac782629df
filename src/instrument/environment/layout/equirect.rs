//! One image; u wraps, v clamps: see [`crate::base::math::equirect`].

use super::MapLayout;
use crate::base::math::equirect::{direction_from_uv, texel_solid_angle_at, uv_from_direction};

pub const LAYOUT: MapLayout = MapLayout {
    name: "equirect",
    about: "one lat-long image, as many renderers filter it; light at a pole loses about a fifth \
            of its energy",
    mapping: "equirectangular, y up: u = 0.5 - atan2(x, z) / 2pi, v = acos(y) / pi; row 0 is +y",
    face_count: 1,
    is_square: false,
    side_min: 8,
    prefilter_size: [448, 224],
    irradiance_size: [64, 32],
    finest_size: |size| size,
    face_uv: |d| (0, uv_from_direction(d)),
    direction: |_, uv| direction_from_uv(uv),
    texel_solid_angle: |d, [width, height], _| texel_solid_angle_at(d.x.hypot(d.z), width, height),
    texel: |_, [x, y], [width, height]| {
        Some([
            0,
            x.rem_euclid(width.into()) as u32,
            y.clamp(0, i64::from(height) - 1) as u32,
        ])
    },
};
