//! The weight of a direction in the mean radiance of a lobe. The twin of
//! `shaders/lib/prefilter_weight.glsl`.

use crate::base::glsl::constants::{
    PREFILTER_WEIGHT_COSINE, PREFILTER_WEIGHT_MASKING, PREFILTER_WEIGHT_NONE,
};
use crate::base::names::listed;
use crate::instrument::brdf::{Brdf, MaskingShadowing, g1};

#[derive(Debug)]
pub struct Weight {
    pub name: &'static str,
    pub about: &'static str,
    pub code: u32,
    pub uses_masking: bool,
    /// Weight of a direction above the horizon, by kernel, alpha and n·l.
    value: fn(&Kernel, f64, f64) -> f64,
}

/// Every weight; the first, of \[Karis13\], is the default.
pub static WEIGHTS: &[Weight] = &[
    Weight {
        name: "cosine",
        about: "n.l: most renderers",
        code: PREFILTER_WEIGHT_COSINE,
        uses_masking: false,
        value: |_, _, n_dot_l| n_dot_l,
    },
    Weight {
        name: "masking",
        about: "G1(l) of the model and its masking: exact at n = v, where n.l is not",
        code: PREFILTER_WEIGHT_MASKING,
        uses_masking: true,
        value: |kernel, alpha, n_dot_l| g1(kernel.brdf, n_dot_l, alpha, kernel.masking),
    },
    Weight {
        name: "none",
        about: "1: the plain mean over D(h) above the horizon",
        code: PREFILTER_WEIGHT_NONE,
        uses_masking: false,
        value: |_, _, _| 1.0,
    },
];

listed!(Weight, "prefilter weight", WEIGHTS);

impl PartialEq for Weight {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// The kernel that a prefiltered map averages with: `D(h) w(l)`.
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    pub brdf: &'static dyn Brdf,
    pub weight: &'static Weight,
    /// The default if the weight does not depend on it, so that equal maps have equal kernels.
    pub masking: MaskingShadowing,
}

impl Kernel {
    pub fn new(
        brdf: &'static dyn Brdf,
        weight: &'static Weight,
        masking: MaskingShadowing,
    ) -> Self {
        Self {
            brdf,
            weight,
            masking: if weight.uses_masking {
                masking
            } else {
                MaskingShadowing::default()
            },
        }
    }

    pub fn cosine(brdf: &'static dyn Brdf) -> Self {
        Self::new(brdf, &WEIGHTS[0], MaskingShadowing::default())
    }

    /// Returns the weight of a direction by its cosine to n; 0 below the horizon.
    pub fn weight(&self, alpha: f64, n_dot_l: f64) -> f64 {
        if n_dot_l > 0.0 {
            (self.weight.value)(self, alpha, n_dot_l)
        } else {
            0.0
        }
    }
}
