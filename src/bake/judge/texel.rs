//! Slips that change each texel by itself.

use crate::base::color::{luminance, srgb_curve, srgb_decode};
use glam::{DMat3, DVec3, Vec3Swizzles};

/// A function of the right colour.
pub type Change = fn(DVec3) -> DVec3;
pub static ORDERS: &[(&str, Change)] = &[
    ("R, B, G", |x| x.xzy()),
    ("G, R, B", |x| x.yxz()),
    ("B, G, R", |x| x.zyx()),
    ("G, B, R", |x| x.yzx()),
    ("B, R, G", |x| x.zxy()),
];
pub static COPIES: &[(&str, Change)] = &[
    ("channels in the order A, R, G", |x| {
        DVec3::new(1.0, x.x, x.y)
    }),
    ("red in every channel", |x| x.xxx()),
    ("green in every channel", |x| x.yyy()),
    ("blue in every channel", |x| x.zzz()),
    ("luminance in every channel", |x| {
        DVec3::splat(luminance(x.as_vec3().to_array()))
    }),
    ("the mean in every channel", |x| {
        DVec3::splat(x.element_sum() / 3.0)
    }),
];
/// Rows of the matrices from linear Rec. 709 to other primaries.
pub static COLORS: &[(&str, [[f64; 3]; 3])] = &[
    (
        "ACEScg (AP1)",
        [
            [0.6131, 0.3395, 0.0474],
            [0.0702, 0.9164, 0.0134],
            [0.0206, 0.1096, 0.8698],
        ],
    ),
    (
        "Rec. 2020",
        [
            [0.6274, 0.3293, 0.0433],
            [0.0691, 0.9195, 0.0114],
            [0.0164, 0.0880, 0.8956],
        ],
    ),
    (
        "Display P3",
        [
            [0.8225, 0.1775, 0.0],
            [0.0332, 0.9668, 0.0],
            [0.0171, 0.0724, 0.9105],
        ],
    ),
    (
        "CIE XYZ",
        [
            [0.4124, 0.3576, 0.1805],
            [0.2126, 0.7152, 0.0722],
            [0.0193, 0.1192, 0.9505],
        ],
    ),
];
pub static CURVES: &[(&str, Change)] = &[
    ("encoded with gamma 2.2: decode it", |x| x.powf(1.0 / 2.2)),
    ("decoded with gamma 2.2 though linear", |x| x.powf(2.2)),
    ("encoded as sRGB: decode it", |x| x.map(srgb_curve)),
    ("decoded as sRGB though linear", |x| {
        x.map(|x| srgb_decode(x as f32).into())
    }),
];
/// Curves of an exposed value.
pub static TONES: &[(&str, Change)] = &[
    ("tone-mapped by Reinhard's x/(1 + x)", |x| x / (1.0 + x)),
    ("tone-mapped by ACES (Narkowicz)", |x| {
        (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).min(DVec3::ONE)
    }),
    ("tone-mapped by Hable's curve, white at 11.2", |x| {
        hable(x) / hable(DVec3::splat(11.2))
    }),
    ("tone-mapped by 1 - exp(-x)", |x| 1.0 - (-x).exp()),
    ("encoded as ln(1 + x)", |x| x.map(f64::ln_1p)),
    ("encoded as PQ with 1 at 100 nits", |x| {
        x.map(|x| pq(x / 100.0))
    }),
];
/// Ranges of RGBM, and the exponents of their colours.
pub static RGBM: &[(f64, f64)] = &[
    (5.0, 1.0),
    (6.0, 1.0),
    (7.0, 1.0),
    (8.0, 1.0),
    (16.0, 1.0),
    (64.0, 1.0),
    (8.0, 2.0),
    (5.0, 2.2),
    (8.0, 2.2),
];
pub static PACKINGS: &[(&str, Change)] = &[
    ("RGBD read as linear: divide by alpha", rgbd),
    ("RGBD with gamma 2.2 read as linear: decode it", |x| {
        rgbd(x).powf(1.0 / 2.2)
    }),
    ("RGBE read as linear: times 2^(255 alpha - 128)", rgbe),
    ("LogLuv read as linear: decode it", log_luv),
    ("half floats read as 16-bit integers", |x| {
        x.map(|x| f64::from(half::f16::from_f64(x).to_bits()) / 65535.0)
    }),
];

/// Cuts at a value: by channel, or of the whole colour, which keeps its hue.
pub type Cut = fn(DVec3, f64) -> DVec3;
pub static CUTS: [(&str, Cut); 3] = [
    ("", |x, most| x.min(DVec3::splat(most))),
    (" with its hue", |x, most| {
        x * (most / x.max_element().max(most))
    }),
    (": what is brighter is black", |x, most| {
        if x.max_element() > most {
            DVec3::ZERO
        } else {
            x
        }
    }),
];

/// The curve of Uncharted 2 before its division by white.
fn hable(x: DVec3) -> DVec3 {
    (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3
}

/// SMPTE ST 2084, of luminance over 10,000 nits.
fn pq(x: f64) -> f64 {
    let power = x.max(0.0).powf(1305.0 / 8192.0);
    ((0.8359375 + 18.8515625 * power) / (1.0 + 18.6875 * power)).powf(78.84375)
}

/// Colours of RGBM: over the range and over a multiplier of at most 1, in steps of 1/255.
pub fn rgbm(x: DVec3, range: f64) -> DVec3 {
    let multiplier = (255.0 * (x.max_element() / range).min(1.0)).ceil() / 255.0;
    if multiplier > 0.0 {
        (x / (range * multiplier)).min(DVec3::ONE)
    } else {
        x
    }
}

/// Colours of RGBD: times a divisor of at most 1 that brings the largest below 1.
fn rgbd(x: DVec3) -> DVec3 {
    x * ((255.0 / x.max_element().max(1e-6))
        .floor()
        .clamp(1.0, 255.0)
        / 255.0)
}

/// Mantissas of RGBE: over a power of two that brings the largest into [1/2, 1).
fn rgbe(x: DVec3) -> DVec3 {
    x / (x.max_element().max(1e-30).log2().floor() + 1.0).exp2()
}

/// First three channels of LogLuv in 32 bits (Larson 1998), with the matrix that three.js used.
fn log_luv(x: DVec3) -> DVec3 {
    const FROM_RGB: DMat3 = DMat3::from_cols_array(&[
        0.2209, 0.3390, 0.4184, 0.1138, 0.6780, 0.7319, 0.0102, 0.1130, 0.2969,
    ]);
    let [x, y, sum] = (FROM_RGB * x).max(DVec3::splat(1e-6)).to_array();
    let log = 2.0 * y.log2() + 127.0;
    DVec3::new(
        x / sum,
        y / sum,
        (log - (255.0 * log.fract()).floor() / 255.0) / 255.0,
    )
}
