//! Exact answers in f64 to tables of queries, on the CPU: references for the device and all
//! approximations.
//!
//! Each [`Kind`] of query is a table with its own columns. [`Queries::read`] checks a whole file
//! before anything is computed; [`Queries::answer`] computes all rows in parallel. The integrals
//! are the same as in the stages' references: the environment's bilinear map is integrated exactly,
//! the other factor adaptively, and each number has a bound of its absolute error. Directions are
//! in the environment's frame (y up), radiance is linear RGB in the units of the map.

mod answers;
mod queries;
mod row;

pub use answers::Answers;
pub use queries::{Queries, QueryFaults};

use crate::base::names::listed;
use crate::instrument::brdf::{Brdf, MaskingShadowing, SheenVisibility, WidthLaw};
use crate::instrument::precompute::prefilter::Kernel;
use crate::instrument::shade::coat::CoatLayering;
use crate::instrument::shade::reference::Surface;
use crate::instrument::shade::{METHODS, Method};
use glam::DVec3;

/// Narrowest lobe that is integrated: a tenth of the device's limit. Near 1e-5, lobes are too
/// narrow for the rounding of their mirror direction to meet the default tolerance.
pub const ALPHA_MIN: f64 = 1e-4;

/// The integral that a table asks for; see [`KindColumns`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Outgoing radiance of a point: specular and diffuse.
    Shading,
    /// The rungs of the ladder for a point, from the specular integral to the levels of the split
    /// sum.
    Ladder,
    /// (A, B) of a BRDF: its directional albedo is `f0 A + f90 B`.
    Dfg,
    /// One texel of a prefiltered map.
    Prefilter,
    Irradiance,
    /// The nine spherical-harmonic coefficients of a map.
    Sh9,
}

/// The columns of a [`Kind`], in the order of help and results.
#[derive(Clone, Copy, Debug)]
pub struct KindColumns {
    /// Columns that every table needs, in any order; `ior` may be in place of `f0`.
    pub required: &'static [&'static str],
    /// Optional columns. Defaults: `masking` `separable`, `weight` `cosine`, `levels` as in the
    /// default tables.
    pub optional: &'static [&'static str],
    /// Result columns with three channels and bounds; the results of other kinds are single
    /// columns.
    pub colors: &'static [&'static str],
    pub numbers: &'static [&'static str],
}

listed!(Kind, "kind of query", {
    "shading": Shading,
    "ladder": Ladder,
    "dfg": Dfg,
    "prefilter": Prefilter,
    "irradiance": Irradiance,
    "sh9": Sh9,
});

/// Columns of a lit point: what it reflects, its normal and its view.
const SURFACE_COLUMNS: &[&str] = &[
    "environment",
    "brdf",
    "alpha",
    F0_COLUMN,
    "nx",
    "ny",
    "nz",
    "vx",
    "vy",
    "vz",
];

const F0_COLUMN: &str = "f0";
/// The column that may be in place of [`F0_COLUMN`]: an index of refraction.
const IOR_COLUMN: &str = "ior";

impl Kind {
    pub fn columns(self) -> &'static KindColumns {
        match self {
            Self::Shading => &KindColumns {
                required: SURFACE_COLUMNS,
                optional: &[
                    "masking",
                    IOR_COLUMN,
                    "anisotropy",
                    "anisotropy_rotation_deg",
                    "anisotropy_widths",
                    "coat",
                    "coat_alpha",
                    "coat_layering",
                    "sheen_color",
                    "sheen_alpha",
                    "sheen_visibility",
                    "id",
                ],
                colors: &["specular", "specular_white", "diffuse", "lambert"],
                numbers: &[],
            },
            Self::Ladder => &KindColumns {
                required: SURFACE_COLUMNS,
                optional: &["masking", IOR_COLUMN, "levels", "id"],
                colors: &[],
                numbers: &[],
            },
            Self::Dfg => &KindColumns {
                required: &["brdf", "alpha", "n_dot_v"],
                optional: &["masking", "id"],
                colors: &[],
                numbers: &["f0_scale", "f90_scale", "albedo", "error"],
            },
            Self::Prefilter => &KindColumns {
                required: &["environment", "brdf", "alpha", "rx", "ry", "rz"],
                optional: &["weight", "masking", "id"],
                colors: &["prefiltered"],
                numbers: &[],
            },
            Self::Irradiance => &KindColumns {
                required: &["environment", "nx", "ny", "nz"],
                optional: &["id"],
                colors: &["irradiance"],
                numbers: &[],
            },
            Self::Sh9 => &KindColumns {
                required: &["environment"],
                optional: &["id"],
                colors: &[
                    "l00", "l1m1", "l10", "l11", "l2m2", "l2m1", "l20", "l21", "l22",
                ],
                numbers: &[],
            },
        }
    }

    pub fn colors(self) -> Vec<String> {
        match self {
            Self::Ladder => rungs()
                .map(|method| method.name.replace('-', "_"))
                .collect(),
            _ => self
                .columns()
                .colors
                .iter()
                .map(|name| name.to_string())
                .collect(),
        }
    }
}

/// Lists the methods that are integrals.
fn rungs() -> impl Iterator<Item = &'static Method> {
    METHODS.iter().filter(|method| method.is_integrated())
}

/// A clear coat with the normal of the surface.
#[derive(Clone, Copy, Debug)]
struct Coat {
    weight: f64,
    alpha: f64,
    layering: CoatLayering,
}

/// Two widths of the lobe of the surface.
#[derive(Clone, Copy, Debug)]
struct Anisotropy {
    /// In (0, 1].
    strength: f64,
    /// Of the tangent, radians.
    turn: f64,
    law: WidthLaw,
}

/// Sheen with the normal of the surface.
#[derive(Clone, Copy, Debug)]
struct Sheen {
    color: DVec3,
    alpha: f64,
    visibility: &'static SheenVisibility,
}

/// Columns of a layer over the surface.
struct LayerColumns {
    /// The column that asks for it.
    asks: &'static str,
    /// The result with the layer's radiance.
    color: &'static str,
    /// The result with the share that the surface below keeps.
    base_share: &'static str,
}

const LAYERS: [LayerColumns; 2] = [
    LayerColumns {
        asks: "coat",
        color: "coat",
        base_share: "base_share",
    },
    LayerColumns {
        asks: "sheen_color",
        color: "sheen",
        base_share: "sheen_base_share",
    },
];

#[derive(Clone, Debug)]
struct Query {
    /// Index into the table's environments; `None` for [`Kind::Dfg`].
    environment: Option<usize>,
    integral: Integral,
}

#[derive(Clone, Debug)]
enum Integral {
    Shading {
        surface: Surface,
        coat: Option<Coat>,
        sheen: Option<Sheen>,
    },
    Ladder {
        surface: Surface,
        levels: u32,
    },
    Dfg {
        model: &'static dyn Brdf,
        masking: MaskingShadowing,
        alpha: f64,
        n_dot_v: f64,
    },
    Prefilter {
        kernel: Kernel,
        alpha: f64,
        r: DVec3,
    },
    Irradiance {
        n: DVec3,
    },
    Sh9,
}
