//! How engines look up an anisotropic lobe in tables made for one width: data for the method
//! `split-sum-bent`.
//!
//! An engine knows alpha and a strength by its own law of widths; both follow from the two widths.
//! With `pr = √alpha` and `g` the view less its part along the bitangent, the lookup `P(d, level)
//! (f0 A + B)` has a bent normal `n' = mix(n, g, share)`, a direction d between `r' = reflect(-v,
//! n')` and n or n', and one alpha for the level and, but for `-square`, for A and B. The formulas
//! are in `shaders/shade/method/split_sum_bent.glsl` and its twin; sources at the versions that
//! `docs/anisotropy.md` names.

use crate::base::glsl::constants as code;
use crate::base::names::listed;
use crate::instrument::brdf::Widths;

/// How an engine parametrises the two widths. Its alpha also indexes both tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Parameters {
    /// The narrow width; `s² = (x - y)/(1 - y)`.
    Narrow = code::BEND_PARAMETERS_NARROW,
    /// The mean; `a = (x - y)/(x + y)`.
    Mean = code::BEND_PARAMETERS_MEAN,
    /// The geometric mean; `a = (1 - y/x)/0.9`, at most 1.
    Geometric = code::BEND_PARAMETERS_GEOMETRIC,
    /// The root of the mean square, without a strength.
    Square = code::BEND_PARAMETERS_SQUARE,
}

/// The bent normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Normal {
    /// n.
    Plain = code::BEND_NORMAL_PLAIN,
    /// The share of g is a.
    Strength = code::BEND_NORMAL_STRENGTH,
    /// The share of g is `a sat(5 pr)`.
    Linear = code::BEND_NORMAL_LINEAR,
    /// `1 - (1 - s (1 - pr))⁴`.
    Quartic = code::BEND_NORMAL_QUARTIC,
    /// The same with g a unit vector.
    QuarticUnit = code::BEND_NORMAL_QUARTIC_UNIT,
    /// The same with alpha for pr.
    QuarticAlpha = code::BEND_NORMAL_QUARTIC_ALPHA,
    /// The same with √pr for pr.
    QuarticRoot = code::BEND_NORMAL_QUARTIC_ROOT,
    /// `a sat(1.5 √pr)`.
    Root = code::BEND_NORMAL_ROOT,
    /// The mean visible normal (`split-sum-cap`, [Dupuy23]).
    Cap = code::BEND_NORMAL_CAP,
}

/// The direction that is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Toward {
    /// r'.
    Mirror = code::BEND_TOWARD_MIRROR,
    /// `mix(r', n, alpha²)`.
    Normal = code::BEND_TOWARD_NORMAL,
    /// `mix(r', n', alpha)`.
    Bent = code::BEND_TOWARD_BENT,
    /// `mix(r', n', alpha²)`.
    BentLess = code::BEND_TOWARD_BENT_LESS,
    /// Frostbite's mix of n' and the direction of `BentLess`.
    Twice = code::BEND_TOWARD_TWICE,
    /// With pr times `sat(1.2 - a)`, of the level too: Unity's share between n and r', and back to
    /// r' by `smoothstep(0, 1, alpha²)`.
    Unity = code::BEND_TOWARD_UNITY,
    /// From alpha 0.4 to 0.8, over to Frostbite's direction.
    Cap = code::BEND_TOWARD_CAP,
}

/// The width at which the DFG table is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum DfgWidth {
    /// The alpha of the level.
    Level,
    /// The root of the mean square.
    Square,
}

/// How one renderer looks up an anisotropic lobe.
#[derive(Debug)]
pub struct Bend {
    pub name: &'static str,
    /// Its source, for `splitsum list bends`.
    pub about: &'static str,
    pub parameters: Parameters,
    pub normal: Normal,
    pub toward: Toward,
    pub dfg: DfgWidth,
}

/// One line for each renderer.
macro_rules! bends {
    ($($name:literal $parameters:ident $normal:ident $toward:ident $dfg:ident $about:literal;)*) => {
        /// Every lookup. The first does not bend the normal; the next two do not either, at other
        /// widths.
        pub static BENDS: &[Bend] = &[$(Bend {
            name: $name,
            about: $about,
            parameters: Parameters::$parameters,
            normal: Normal::$normal,
            toward: Toward::$toward,
            dfg: DfgWidth::$dfg,
        }),*];
    };
}

bends! {
    "none" Square Plain Mirror Level "along r at the root mean square width";
    "none-narrow" Narrow Plain Mirror Level "along r at the narrow width";
    "none-mean" Mean Plain Mirror Level "along r at the mean width";
    "cap" Square Cap Cap Level "the mirror direction about the mean visible normal, ours";
    "filament" Mean Linear Normal Level "getReflectedVector of Filament";
    "gltf" Narrow QuarticUnit Bent Level "KHR_materials_anisotropy, section on image-based lighting";
    "khronos" Narrow Quartic Mirror Level "getIBLRadianceAnisotropy of the glTF Sample Renderer";
    "three" Narrow QuarticUnit BentLess Level "getIBLAnisotropyRadiance of three.js since 2025";
    "bevy" Narrow QuarticAlpha Twice Level "bend_normal_for_anisotropy of Bevy";
    "godot" Geometric Linear Bent Level "the sky's lookup of Godot's forward renderer";
    "playcanvas" Narrow QuarticRoot Mirror Level "reflDirAniso of PlayCanvas";
    "unity" Mean Root Unity Level "GetGGXAnisotropicModifiedNormalAndRoughness of HDRP";
    "vtk" Geometric Strength Mirror Level "vtkOpenGLPolyDataMapper::ReplaceShaderLight of VTK";
    "materialx" Geometric Plain Mirror Level "mx_environment_prefilter of MaterialX: no bend";
    "filament-square" Mean Linear Normal Square "filament, with A and B at the root mean square \
                                                 width";
    "gltf-square" Narrow QuarticUnit Bent Square "gltf, with A and B at the root mean square width";
    "unity-square" Mean Root Unity Square "unity, with A and B at the root mean square width";
}

listed!(Bend, "bend", BENDS);

/// A lobe of two widths as a renderer parametrises it.
#[derive(Clone, Copy, Debug)]
pub struct OneWidth {
    pub alpha: f64,
    /// From 0, a round lobe, to 1.
    pub strength: f64,
}

impl Parameters {
    /// Returns the parameters of two widths.
    pub fn of(self, widths: Widths) -> OneWidth {
        let [x, y] = widths.0.to_array();
        match self {
            Self::Narrow => OneWidth {
                alpha: y,
                strength: if x > y {
                    ((x - y) / (1.0 - y)).sqrt()
                } else {
                    0.0
                },
            },
            Self::Mean => OneWidth {
                alpha: 0.5 * (x + y),
                strength: (x - y) / (x + y),
            },
            Self::Geometric => OneWidth {
                alpha: (x * y).sqrt(),
                strength: ((1.0 - y / x) / 0.9).min(1.0),
            },
            Self::Square => OneWidth {
                alpha: widths.mean(),
                strength: 0.0,
            },
        }
    }
}

impl Bend {
    /// Returns the alpha at which the DFG table is read: for the specular term, and for a
    /// compensation and the diffuse term beside it.
    pub fn table_alpha(&self, widths: Widths) -> f64 {
        match self.dfg {
            DfgWidth::Level => self.parameters.of(widths).alpha,
            DfgWidth::Square => widths.mean(),
        }
    }

    /// Returns the specialization constant `bend`.
    pub fn code(&self) -> u32 {
        self.parameters as u32
            | (self.normal as u32) << 4
            | (self.toward as u32) << 8
            | (self.dfg as u32) << 12
    }
}
