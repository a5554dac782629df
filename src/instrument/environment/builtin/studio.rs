//! A dark room with softboxes and a bare lamp.
//!
//! `L(d) = room(d.y) + Σ box_i(d)`, plus the lamp, a uniform cap. A softbox with centre `c`, right
//! `r`, up `t` and half sizes `(a, b)` (radians) is `radiance edge(|d.r / d.c| / tan a) edge(|d.t /
//! d.c| / tan b)` for `d.c > 0`, where `edge` falls from 1 to 0 by a smoothstep over `1 ± EDGE`.

use super::{Builtin, Values, raster};
use crate::base::pixels::RgbImage;
use glam::DVec3;

/// Half width of a softbox's edge, relative to its half size.
const EDGE: f64 = 0.06;

/// The narrowest edge is about as wide as a texel of the default map.
const SAMPLES_PER_SIDE: u32 = 3;

struct Softbox {
    /// Azimuth from +z towards +x and elevation above the horizon, degrees.
    center: [f64; 2],
    /// Half width and half height, degrees.
    half_size: [f64; 2],
    radiance: DVec3,
}

const fn softbox(center: [f64; 2], half_size: [f64; 2], radiance: [f64; 3]) -> Softbox {
    Softbox {
        center,
        half_size,
        radiance: DVec3::from_array(radiance),
    }
}

/// Key, fill, two rims and a top light, as for a subject photographed from +z.
const SOFTBOXES: [Softbox; 5] = [
    softbox([-50.0, 32.0], [26.0, 19.0], [9.0, 8.6, 8.0]),
    softbox([72.0, 8.0], [15.0, 24.0], [1.5, 1.7, 2.0]),
    softbox([148.0, 12.0], [4.0, 32.0], [20.0, 21.0, 23.0]),
    softbox([-142.0, 8.0], [3.0, 28.0], [11.0, 9.0, 7.0]),
    softbox([0.0, 84.0], [22.0, 14.0], [2.4, 2.4, 2.4]),
];

/// The lamp's azimuth, elevation and half angle, degrees.
const LAMP: [f64; 3] = [24.0, 48.0, 1.5];
const LAMP_RADIANCE: DVec3 = DVec3::new(1500.0, 1250.0, 950.0);

pub static STUDIO: Builtin = Builtin {
    name: "studio",
    about: "a dark room with a large key softbox, a fill, two rim strips, a top light and a small \
            hot lamp",
    parameters: &[],
    make,
};

fn make(_: &Values, size: [u32; 2]) -> RgbImage {
    let boxes: Vec<_> = SOFTBOXES
        .iter()
        .map(|softbox| {
            let [azimuth, elevation] = softbox.center.map(f64::to_radians);
            let [half_width, half_height] = softbox.half_size.map(f64::to_radians);
            let center = raster::direction(azimuth, elevation);
            let right = DVec3::Y.cross(center).normalize() / half_width.tan();
            let up = center.cross(right).normalize() / half_height.tan();
            (center, right, up, softbox.radiance)
        })
        .collect();
    let mut image = raster::supersampled(size, SAMPLES_PER_SIDE, |_, d| {
        boxes
            .iter()
            .fold(room(d.y), |sum, (center, right, up, radiance)| {
                let depth = d.dot(*center);
                let inside = if depth > 0.0 {
                    edge((d.dot(*right) / depth).abs()) * edge((d.dot(*up) / depth).abs())
                } else {
                    0.0
                };
                sum + *radiance * inside
            })
    });
    let [azimuth, elevation, half_angle] = LAMP.map(f64::to_radians);
    raster::cover_cap(
        size,
        raster::direction(azimuth, elevation),
        half_angle,
        |texel, coverage| {
            let behind = DVec3::from(image.data[texel].map(f64::from));
            image.data[texel] = behind.lerp(LAMP_RADIANCE, coverage).as_vec3().to_array();
        },
    );
    image
}

/// Returns the radiance of the room: black walls, a grey floor, a dim ceiling.
fn room(y: f64) -> DVec3 {
    let walls = DVec3::splat(0.015);
    let floor = DVec3::new(0.085, 0.080, 0.075) * smoothstep(-0.15, -0.75, y);
    let ceiling = DVec3::new(0.025, 0.025, 0.028) * smoothstep(0.3, 0.9, y);
    walls + floor + ceiling
}

fn edge(x: f64) -> f64 {
    smoothstep(1.0 + EDGE, 1.0 - EDGE, x)
}

/// 0 up to `from`, 1 from `to` on, cubic between; `from` may be the larger.
fn smoothstep(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
