//! Image-based lighting: the methods that turn a g-buffer and an environment into radiance.

pub mod pass;
pub mod reference;
pub mod reference_pass;

/// How the specular term is computed. The names are the shader file stems (with `-` for `_`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Method {
    pub name: &'static str,
    /// One sentence for `splitsum list`.
    pub about: &'static str,
    /// Whether the sample count changes its result.
    pub uses_samples: bool,
}

/// Every specular method. Adding one: `shaders/shade/method/<stem>.glsl` and one line here.
pub static METHODS: &[Method] = &[
    Method {
        name: "sampled",
        about: "per-pixel half-vector importance sampling with Hammersley points, filtered by mip level",
        uses_samples: true,
    },
    Method { name: "sampled-unfiltered", about: "as sampled, always from the finest level", uses_samples: true },
    Method {
        name: "seed0-literal",
        about: "source document 0 exactly as printed, to show what its slips cost",
        uses_samples: true,
    },
    Method {
        name: "split-sum",
        about: "prefiltered map (n = v = r, n.l weight) times the DFG table",
        uses_samples: false,
    },
    Method { name: "none", about: "no specular term", uses_samples: false },
    Method {
        name: "reference",
        about: "unbiased: BRDF and environment sampling combined, many samples, unfiltered",
        uses_samples: true,
    },
];

/// How the diffuse irradiance is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Diffuse {
    pub name: &'static str,
    pub about: &'static str,
}

/// Every diffuse method.
pub static DIFFUSE: &[Diffuse] = &[
    Diffuse { name: "sh9", about: "nine spherical-harmonic coefficients evaluated per pixel" },
    Diffuse { name: "irradiance-map", about: "a small map of numerically integrated irradiance" },
    Diffuse { name: "reference", about: "unbiased: cosine and environment sampling combined, many samples" },
    Diffuse { name: "none", about: "no diffuse term" },
];

/// The method of that name.
pub fn method_by_name(name: &str) -> Option<&'static Method> {
    METHODS.iter().find(|method| method.name == name)
}

/// The diffuse method of that name.
pub fn diffuse_by_name(name: &str) -> Option<&'static Diffuse> {
    DIFFUSE.iter().find(|diffuse| diffuse.name == name)
}
