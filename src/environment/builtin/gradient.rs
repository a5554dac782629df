//! `L(d) = mean + slope d.y`, grey. Its irradiance is known in closed form: `E(n)/π = mean + (2/3) slope n.y`.

use super::{Builtin, Parameter, raster};
use glam::DVec3;

pub static GRADIENT: Builtin = Builtin {
    name: "gradient",
    about: "A grey vertical gradient with an exact irradiance: mean + slope y, never below 0",
    parameters: &[
        Parameter { name: "mean", about: "radiance at the horizon", default: 0.52, min: 0.0, max: 1e6 },
        Parameter {
            name: "slope",
            about: "radiance up minus radiance at the horizon",
            default: 0.5,
            min: -1e6,
            max: 1e6,
        },
    ],
    make: |values, size| {
        let (mean, slope) = (values.get("mean"), values.get("slope"));
        raster::at_centers(size, |d| DVec3::splat((mean + slope * d.y).max(0.0)))
    },
};
