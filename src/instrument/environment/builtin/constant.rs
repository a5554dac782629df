//! `L(d) = radiance`.

use super::{Builtin, parameter};
use crate::base::pixels::RgbImage;

pub static CONSTANT: Builtin = Builtin {
    name: "constant",
    about: "the same grey radiance from everywhere",
    parameters: &[parameter("radiance", "radiance", 1.0, [0.0, 1e6])],
    make: |values, [width, height]| {
        RgbImage::filled(width, height, [values.get("radiance") as f32; 3])
    },
};
