//! A uniform disc on an even ground: `L = radiance` within `half_angle_deg` of the centre, else `ambient`.
//!
//! The disc holds the solid angle `2π (1 - cos(half_angle))`.

use super::{Builtin, Parameter, raster};
use crate::pixels::RgbImage;
use glam::DVec3;

pub static CAP: Builtin = Builtin {
    name: "cap",
    about: "A uniform spherical cap over an even ambient radiance",
    parameters: &[
        Parameter {
            name: "half_angle_deg",
            about: "angle from the cap's centre to its edge",
            default: 10.0,
            min: 0.01,
            max: 180.0,
        },
        Parameter { name: "radiance", about: "radiance within the cap", default: 100.0, min: 0.0, max: 1e9 },
        Parameter { name: "ambient", about: "radiance elsewhere", default: 0.1, min: 0.0, max: 1e6 },
        Parameter {
            name: "azimuth_deg",
            about: "azimuth of the centre, from +z towards +x",
            default: 0.0,
            min: -360.0,
            max: 360.0,
        },
        Parameter {
            name: "elevation_deg",
            about: "elevation of the centre above the horizon",
            default: 30.0,
            min: -90.0,
            max: 90.0,
        },
    ],
    make: |values, size| {
        let (radiance, ambient) = (values.get("radiance"), values.get("ambient"));
        let center =
            raster::direction(values.get("azimuth_deg").to_radians(), values.get("elevation_deg").to_radians());
        let mut image = RgbImage::filled(size[0], size[1], [ambient as f32; 3]);
        raster::cover_cap(size, center, values.get("half_angle_deg").to_radians(), |texel, coverage| {
            image.data[texel] = DVec3::splat(ambient + (radiance - ambient) * coverage).as_vec3().to_array();
        });
        image
    },
};
