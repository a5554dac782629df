//! Cells of equal size in (u, v): `L = high` where `floor(columns u) + floor(rows v)` is even, else
//! `low`.

use super::{Builtin, parameter, raster};
use glam::DVec3;

/// Samples per texel side: edges that cross a texel are placed to 1/8 of it.
const SAMPLES_PER_SIDE: u32 = 8;

pub static CHECKER: Builtin = Builtin {
    name: "checker",
    about: "longitude-latitude checkerboard: hard edges in every direction",
    parameters: &[
        parameter(
            "columns",
            "cells around; a whole, even count closes the pattern",
            8.0,
            [2.0, 512.0],
        ),
        parameter("rows", "cells from pole to pole", 4.0, [1.0, 256.0]),
        parameter(
            "high",
            "radiance of the cell at the left of the top row",
            1.0,
            [0.0, 1e6],
        ),
        parameter("low", "radiance of the others", 0.0, [0.0, 1e6]),
    ],
    make: |values, size| {
        let columns = values.get("columns");
        let rows = values.get("rows");
        let high = values.get("high");
        let low = values.get("low");
        raster::supersampled(size, SAMPLES_PER_SIDE, |uv, _| {
            let cell = (uv.x * columns).floor() + (uv.y * rows).floor();
            DVec3::splat(if cell.rem_euclid(2.0) < 1.0 {
                high
            } else {
                low
            })
        })
    },
};
