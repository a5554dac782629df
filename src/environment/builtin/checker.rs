//! Cells of equal size in (u, v): `L = high` where `floor(columns u) + floor(rows v)` is even, else `low`.

use super::{Builtin, Parameter, raster};
use glam::DVec3;

/// An edge that crosses a texel is placed to 1/8 of it.
const SAMPLES_PER_SIDE: u32 = 8;

pub static CHECKER: Builtin = Builtin {
    name: "checker",
    about: "Longitude-latitude checkerboard: hard edges in every direction",
    parameters: &[
        Parameter {
            name: "columns",
            about: "cells around; a whole, even count closes the pattern",
            default: 8.0,
            min: 2.0,
            max: 512.0,
        },
        Parameter { name: "rows", about: "cells from pole to pole", default: 4.0, min: 1.0, max: 256.0 },
        Parameter {
            name: "high",
            about: "radiance of the cell at the left of the top row",
            default: 1.0,
            min: 0.0,
            max: 1e6,
        },
        Parameter { name: "low", about: "radiance of the others", default: 0.0, min: 0.0, max: 1e6 },
    ],
    make: |values, size| {
        let (columns, rows) = (values.get("columns"), values.get("rows"));
        let (high, low) = (values.get("high"), values.get("low"));
        raster::supersampled(size, SAMPLES_PER_SIDE, |uv| {
            let cell = (uv.x * columns).floor() + (uv.y * rows).floor();
            DVec3::splat(if cell.rem_euclid(2.0) < 1.0 { high } else { low })
        })
    },
};
