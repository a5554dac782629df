//! `L(d) = mean + slope d.y`, grey. Its irradiance is known in closed form: `E(n)/π = mean + (2/3)
//! slope n.y`.

use super::{Builtin, parameter, raster};
use glam::DVec3;

pub static GRADIENT: Builtin = Builtin {
    name: "gradient",
    about: "a grey vertical gradient with an exact irradiance: mean + slope y, never below 0",
    parameters: &[
        parameter("mean", "radiance at the horizon", 0.52, [0.0, 1e6]),
        parameter(
            "slope",
            "radiance up minus radiance at the horizon",
            0.5,
            [-1e6, 1e6],
        ),
    ],
    make: |values, size| {
        let mean = values.get("mean");
        let slope = values.get("slope");
        raster::at_centers(size, |d| DVec3::splat((mean + slope * d.y).max(0.0)))
    },
};
