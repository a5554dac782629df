//! Image-based lighting: the methods that turn a g-buffer and an environment into radiance.

pub mod level_bias;
pub mod pass;
pub mod reference;
pub mod reference_pass;

/// Name of the unbiased method, specular and diffuse.
pub const REFERENCE: &str = "reference";
/// Name of the method that leaves its term out, specular and diffuse.
pub const NONE: &str = "none";

/// How the specular term is computed. The names are the shader file stems (with `-` for `_`).
///
/// The flags say what changes its result: an experiment has one cell, not many, along an axis that a method ignores.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Method {
    pub name: &'static str,
    /// One sentence for `splitsum list`.
    pub about: &'static str,
    /// The sample count.
    pub uses_samples: bool,
    /// The sequence of points and the choice among its sets (`math::sequence`).
    pub uses_point_set: bool,
    /// The bias of the mip level.
    pub uses_lod_bias: bool,
    /// The prefiltered map.
    pub uses_prefiltered: bool,
    /// The DFG table, for the specular term itself; see [`Method::needs_dfg`].
    pub uses_dfg: bool,
}

/// A method that depends on nothing but the scene.
const PLAIN: Method = Method {
    name: "",
    about: "",
    uses_samples: false,
    uses_point_set: false,
    uses_lod_bias: false,
    uses_prefiltered: false,
    uses_dfg: false,
};

/// Every specular method. Adding one: `shaders/shade/method/<stem>.glsl` and one entry here.
pub static METHODS: &[Method] = &[
    Method {
        name: "sampled",
        about: "per-pixel half-vector importance sampling, filtered by mip level",
        uses_samples: true,
        uses_point_set: true,
        uses_lod_bias: true,
        ..PLAIN
    },
    Method {
        name: "sampled-unfiltered",
        about: "as sampled, always from the finest level",
        uses_samples: true,
        uses_point_set: true,
        ..PLAIN
    },
    Method {
        name: "seed0-literal",
        about: "source document 0's estimator as printed, but for the misprinted G of GGX, to show what its slips cost",
        uses_samples: true,
        uses_point_set: true,
        ..PLAIN
    },
    Method {
        name: "split-sum",
        about: "prefiltered map (n = v = r, n.l weight) times the DFG table",
        uses_prefiltered: true,
        uses_dfg: true,
        ..PLAIN
    },
    Method { name: NONE, about: "no specular term", ..PLAIN },
    Method {
        name: REFERENCE,
        about: "unbiased: BRDF and environment sampling combined, many samples, unfiltered",
        uses_samples: true,
        ..PLAIN
    },
];

impl Method {
    /// Whether it is the unbiased one.
    pub fn is_reference(&self) -> bool {
        self.name == REFERENCE
    }

    /// Whether it leaves the term out.
    pub fn is_none(&self) -> bool {
        self.name == NONE
    }

    /// Whether a frame reads the DFG table: for the specular term itself, or to weight what else the surface reflects beside it.
    pub fn needs_dfg(&self, diffuse: &Diffuse, has_lights: bool) -> bool {
        self.uses_dfg || (!self.is_none() && (!diffuse.is_none() || has_lights))
    }
}

/// How the diffuse irradiance is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Diffuse {
    pub name: &'static str,
    pub about: &'static str,
    /// Whether the size and sample count of the irradiance map change its result.
    pub uses_irradiance_map: bool,
    /// Whether it reads the spherical-harmonic coefficients.
    pub uses_sh9: bool,
}

impl Diffuse {
    /// Whether it is the unbiased one.
    pub fn is_reference(&self) -> bool {
        self.name == REFERENCE
    }

    /// Whether it leaves the term out.
    pub fn is_none(&self) -> bool {
        self.name == NONE
    }
}

/// Every diffuse method.
pub static DIFFUSE: &[Diffuse] = &[
    Diffuse {
        name: "sh9",
        about: "nine spherical-harmonic coefficients evaluated per pixel",
        uses_irradiance_map: false,
        uses_sh9: true,
    },
    Diffuse {
        name: "irradiance-map",
        about: "a small map of numerically integrated irradiance",
        uses_irradiance_map: true,
        uses_sh9: false,
    },
    Diffuse {
        name: REFERENCE,
        about: "unbiased: cosine and environment sampling combined, many samples",
        uses_irradiance_map: false,
        uses_sh9: false,
    },
    Diffuse { name: NONE, about: "no diffuse term", uses_irradiance_map: false, uses_sh9: false },
];

/// The method of that name.
pub fn method_by_name(name: &str) -> Option<&'static Method> {
    METHODS.iter().find(|method| method.name == name)
}

/// The diffuse method of that name.
pub fn diffuse_by_name(name: &str) -> Option<&'static Diffuse> {
    DIFFUSE.iter().find(|diffuse| diffuse.name == name)
}
