//! `L(d) = radiance`.

use super::{Builtin, Parameter};
use crate::pixels::RgbImage;

pub static CONSTANT: Builtin = Builtin {
    name: "constant",
    about: "The same grey radiance from everywhere",
    parameters: &[Parameter { name: "radiance", about: "radiance", default: 1.0, min: 0.0, max: 1e6 }],
    make: |values, [width, height]| RgbImage::filled(width, height, [values.get("radiance") as f32; 3]),
};
