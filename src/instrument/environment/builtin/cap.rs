//! A uniform disc on an even ground: `L = radiance` within `half_angle_deg` of the centre, else
//! `ambient`.

use super::{Builtin, parameter, raster};
use crate::base::pixels::RgbImage;
use glam::DVec3;

pub static CAP: Builtin = Builtin {
    name: "cap",
    about: "a uniform spherical cap over an even ambient radiance",
    parameters: &[
        parameter(
            "half_angle_deg",
            "angle from the cap's centre to its edge",
            10.0,
            [0.01, 180.0],
        ),
        parameter("radiance", "radiance within the cap", 100.0, [0.0, 1e9]),
        parameter("ambient", "radiance elsewhere", 0.1, [0.0, 1e6]),
        parameter(
            "azimuth_deg",
            "azimuth of the centre, from +z towards +x",
            0.0,
            [-360.0, 360.0],
        ),
        parameter(
            "elevation_deg",
            "elevation of the centre above the horizon",
            30.0,
            [-90.0, 90.0],
        ),
    ],
    make: |values, size| {
        let radiance = values.get("radiance");
        let ambient = values.get("ambient");
        let center = raster::direction(
            values.get("azimuth_deg").to_radians(),
            values.get("elevation_deg").to_radians(),
        );
        let mut image = RgbImage::filled(size[0], size[1], [ambient as f32; 3]);
        raster::cover_cap(
            size,
            center,
            values.get("half_angle_deg").to_radians(),
            |texel, coverage| {
                image.data[texel] = DVec3::splat(ambient + (radiance - ambient) * coverage)
                    .as_vec3()
                    .to_array();
            },
        );
        image
    },
};
