//! Level biases of well-known prefilters: offsets to the level whose texel covers the solid angle
//! of a sample.
//!
//! The level of filtered importance sampling is `l = 1/2 log2(omega_s / omega_p) + b`
//! \[Colbert07\], with `omega_s = 1 / (N pdf)` the solid angle of a sample and `omega_p` the one of
//! a texel of level 0. Programs with another `omega_p` or an added constant have a bias `b`.
//! Programs whose offset varies over the map are excluded. All belong to prefilters of about a
//! thousand samples per texel, so they are names on the axis of the prefiltered map, not of
//! per-pixel sampling.

#[derive(Clone, Copy, Debug)]
pub struct LevelBias {
    pub name: &'static str,
    pub about: &'static str,
    pub levels: f64,
}

const fn bias(name: &'static str, levels: f64, about: &'static str) -> LevelBias {
    LevelBias {
        name,
        about,
        levels,
    }
}

pub static LEVEL_BIASES: &[LevelBias] = &[
    bias("unbiased", 0.0, "the texel covers the sample's solid angle"),
    bias(
        "filament",
        1.0,
        "K = 4 times the solid angle: 1/2 log2 4; Babylon.js has the same",
    ),
    // log2(2 pi) - 3/2: it takes its largest level less 1.5 for log2(W / 2 pi) of a W x W/2 map.
    bias(
        "materialx",
        1.151_496_129_472_318_8,
        "lat-long with the largest level less 1.5: log2(2 pi) - 1.5",
    ),
    // 1/2 log2 6: it takes the texel of a cube's face for one of a square over the sphere.
    bias(
        "godot",
        1.292_481_250_360_578,
        "the constant of a cube map on an octahedral map: 1/2 log2 6",
    ),
    // 1/2 log2(4 pi).
    bias(
        "khronos-sampler",
        1.825_748_064_736_159_3,
        "glTF-IBL-Sampler: a factor 4 pi is missing, 1/2 log2(4 pi)",
    ),
];
