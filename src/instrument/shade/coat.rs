//! Clear coat: a second specular lobe over the base, with a weight c, a width alpha_c and a normal
//! n_c of its own.
//!
//! With base L_b and, at μ = n_c·v and alpha_c, the coat's integrals `I1 = ∫ f n·l L dl` for F = 1
//! and `I` for f0 = 0.04, its albedo `E = 0.04 A + B` and Schlick's `F = 0.04 + 0.96 (1 - μ)⁵`, the
//! truths are
//!
//! | | radiance | source |
//! |---|---|---|
//! | `khr` | `(1 - c F) L_b + c F I1` | KHR_materials_clearcoat, "Layering" \[KhrClearcoat20\] |
//! | `albedo` | `(1 - c E) L_b + c I` | OpenPBR 1.1, albedo scaling; exact in a white furnace |
//!
//! The base loses light once, diffuse term included. Refraction, absorption and light between the
//! layers are left out.

use crate::base::glsl::constants as code;
use crate::base::names::listed;
use crate::instrument::brdf::{RoughnessUnderCoat, UnderCoatLaw, f_schlick};
use glam::{DVec2, DVec3};

/// F0 of every coat: index of refraction 1.5.
pub const COAT_F0: f64 = 0.04;
const _: () = assert!(COAT_F0 as f32 == code::COAT_F0);

/// The exact radiance of a coated surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CoatLayering {
    #[default]
    Khr,
    Albedo,
}

listed!(CoatLayering, "coat layering", { "khr": Khr, "albedo": Albedo });

impl CoatLayering {
    /// What the base loses.
    pub fn loss(self) -> CoatWeight {
        match self {
            Self::Khr => CoatWeight::Fresnel,
            Self::Albedo => CoatWeight::Albedo,
        }
    }

    /// F0 of the coat's integral.
    pub fn f0(self) -> f64 {
        match self {
            Self::Khr => 1.0,
            Self::Albedo => COAT_F0,
        }
    }
}

/// The reflectance that scales a coat's lookup, or that the base loses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum CoatWeight {
    /// 1: the coat's integral has its F0.
    One = code::COAT_WEIGHT_ONE,
    /// Schlick's F at n_c·v.
    Fresnel = code::COAT_WEIGHT_FRESNEL,
    /// `0.04 A + B`, of the DFG table.
    Albedo = code::COAT_WEIGHT_ALBEDO,
    /// The product of both.
    FresnelTimesAlbedo = code::COAT_WEIGHT_FRESNEL_TIMES_ALBEDO,
}

impl CoatWeight {
    /// Returns the reflectance at μ = n_c·v; `pair` is (A, B).
    pub fn reflectance(self, n_dot_v: f64, pair: DVec2) -> f64 {
        let fresnel = f_schlick(DVec3::splat(COAT_F0), n_dot_v).x;
        let albedo = COAT_F0 * pair.x + pair.y;
        match self {
            Self::One => 1.0,
            Self::Fresnel => fresnel,
            Self::Albedo => albedo,
            Self::FresnelTimesAlbedo => fresnel * albedo,
        }
    }
}

/// How a renderer shades a coat.
#[derive(Debug)]
pub struct CoatRenderer {
    pub name: &'static str,
    /// Where it is from, for `splitsum list coats`.
    pub about: &'static str,
    /// The method of the coat's lookup `P (A + B)`, of which only P counts; `None` for the exact
    /// layers by the method of the image.
    pub lookup: Option<&'static str>,
    /// Converts alpha_c to the alpha of the level that is read.
    pub alpha: fn(f32) -> f32,
    /// Scales P.
    pub scale: CoatWeight,
    /// The reflectance w that the base loses: a term of the base is scaled by `(1 - c w)^power`.
    pub loss: CoatWeight,
    /// Power for the specular term.
    pub specular_power: u32,
    /// Power for the diffuse term.
    pub diffuse_power: u32,
    /// What it does to F0 and roughness of the base.
    pub base: UnderCoatLaw,
}

/// F0 of a base below a coat of index 1.5, as Filament's `f0ClearCoatToSurface` and Babylon.js'
/// `getR0RemappedForClearCoat` fit `((n - 1.5)/(n + 1.5))²`, n the index of the F0 in air.
const F0_OF_FILAMENT: [f32; 4] = [-0.028_599_8, 0.346_479, 0.941_892, -0.263_008];
/// Another fit of it: `ConvertF0ForAirInterfaceToF0ForClearCoat15` of Unity's core library.
const F0_OF_UNITY: [f32; 4] = [-0.025_686_8, 0.326_846, 0.978_946, -0.283_835];

const EXACT: CoatRenderer = CoatRenderer {
    name: "exact",
    about: "the layers of coat_layering, each by the image's method",
    lookup: None,
    alpha: |alpha| alpha,
    scale: CoatWeight::Fresnel,
    loss: CoatWeight::Fresnel,
    specular_power: 1,
    diffuse_power: 1,
    base: UnderCoatLaw::UNCHANGED,
};

/// Every renderer; the first is exact. Sources at the versions that `docs/coat.md` names.
pub static COAT_RENDERERS: &[CoatRenderer] = &[
    EXACT,
    CoatRenderer {
        name: "filament",
        about: "evaluateClearCoatIBL of Filament: c F P along r over a base of less F0, at least as \
                rough as the coat",
        lookup: Some("split-sum"),
        base: UnderCoatLaw {
            f0: F0_OF_FILAMENT,
            roughness: RoughnessUnderCoat::AtLeastCoat,
        },
        ..EXACT
    },
    CoatRenderer {
        name: "khronos",
        about: "the glTF Sample Renderer and PlayCanvas: c F P along r over the plain base",
        lookup: Some("split-sum"),
        ..EXACT
    },
    CoatRenderer {
        name: "bevy",
        about: "environment_map_light_clearcoat of Bevy: Frostbite's direction, the base's \
                specular term attenuated twice",
        lookup: Some("split-sum-frostbite"),
        specular_power: 2,
        ..EXACT
    },
    CoatRenderer {
        name: "unity",
        about: "EvaluateBSDF_Env of HDRP's Lit: a mirror over a base of less F0, widened by \
                refraction, its specular term attenuated twice and its diffuse term never",
        lookup: Some("split-sum"),
        alpha: |_| code::ALPHA_MIN,
        specular_power: 2,
        diffuse_power: 0,
        base: UnderCoatLaw {
            f0: F0_OF_UNITY,
            roughness: RoughnessUnderCoat::Refracted,
        },
        ..EXACT
    },
    CoatRenderer {
        name: "three",
        about: "RE_IndirectSpecular_Physical of three.js: c (0.04 A + B) P, bent to n by alpha^2",
        lookup: Some("split-sum-filament"),
        scale: CoatWeight::Albedo,
        ..EXACT
    },
    CoatRenderer {
        name: "babylon",
        about: "clearcoatBlock of Babylon.js: c (0.04 A + B) P along r over a base of less F0",
        lookup: Some("split-sum"),
        scale: CoatWeight::Albedo,
        base: UnderCoatLaw {
            f0: F0_OF_FILAMENT,
            ..UnderCoatLaw::UNCHANGED
        },
        ..EXACT
    },
    CoatRenderer {
        name: "vtk",
        about: "ReplaceShaderLight of VTK: c F (0.04 A + B) P along r over an unattenuated base",
        lookup: Some("split-sum"),
        scale: CoatWeight::FresnelTimesAlbedo,
        // Its shader attenuates both terms after it has added them.
        specular_power: 0,
        diffuse_power: 0,
        ..EXACT
    },
    CoatRenderer {
        name: "openpbr",
        about: "mx_dielectric_bsdf of MaterialX, as OpenPBR layers it: c (0.04 A + B) P along r, \
                the base scaled by the albedo",
        lookup: Some("split-sum"),
        scale: CoatWeight::Albedo,
        loss: CoatWeight::Albedo,
        ..EXACT
    },
];

listed!(CoatRenderer, "coat renderer", COAT_RENDERERS);

/// What the images of a coated surface count, pixel by pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatShares {
    pub base_specular: f64,
    pub base_diffuse: f64,
    pub coat: f64,
}

/// How coat and base add up: by an exact layering or as a renderer does it.
#[derive(Clone, Copy, Debug)]
pub struct CoatLaw {
    /// Scales the coat's image.
    pub scale: CoatWeight,
    /// The reflectance w that the base loses: a term of it is scaled by `(1 - c w)^power`.
    pub loss: CoatWeight,
    /// Whether the coat's image is a lookup `P (A + B)`, of which only P counts.
    pub is_lookup: bool,
    pub specular_power: u32,
    pub diffuse_power: u32,
}

impl CoatLaw {
    pub fn new(layering: CoatLayering, renderer: &CoatRenderer) -> Self {
        let is_lookup = renderer.lookup.is_some();
        let [scale, loss] = match layering {
            _ if is_lookup => [renderer.scale, renderer.loss],
            CoatLayering::Khr => [CoatWeight::Fresnel, layering.loss()],
            CoatLayering::Albedo => [CoatWeight::One, layering.loss()],
        };
        Self {
            scale,
            loss,
            is_lookup,
            specular_power: renderer.specular_power,
            diffuse_power: renderer.diffuse_power,
        }
    }

    /// Whether the shares depend on the coat's (A, B).
    pub fn needs_pair(&self) -> bool {
        self.is_lookup || self.loss == CoatWeight::Albedo
    }

    /// Returns the shares for a coat of weight `weight` at μ = n_c·v; `pair` is its (A, B).
    pub fn shares(&self, weight: f64, n_dot_v: f64, pair: DVec2) -> CoatShares {
        let whole = if self.is_lookup { pair.x + pair.y } else { 1.0 };
        let coat = self.scale.reflectance(n_dot_v, pair) / whole;
        let left = 1.0 - weight * self.loss.reflectance(n_dot_v, pair);
        CoatShares {
            base_specular: left.powi(self.specular_power as i32),
            base_diffuse: left.powi(self.diffuse_power as i32),
            coat: weight * coat,
        }
    }
}
