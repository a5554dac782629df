//! Sheen of cloth over a base ([`crate::instrument::brdf::SheenVisibility`]), with a colour C and a
//! width of its own.
//!
//! With base L_b, `I = ∫ f_s n·l L dl` of the lobe for colour 1 and its albedo `E = ∫ f_s n·l dl`,
//! the truth is
//!
//! `C I + max(0, 1 - max(C) E) L_b`
//!
//! as KHR_materials_sheen scales the base by n·v alone \[KhrSheen20\]. E may exceed 1, hence the
//! clamp. A coat lies over both.

use crate::base::glsl::constants as code;
use crate::base::names::listed;
use crate::instrument::brdf::{perceptual_roughness_from_alpha, reflect};
use glam::DVec3;

/// The map that a lookup reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheenMap {
    /// The prefiltered map of the image.
    Levels,
    /// A map prefiltered by the lobe of the sheen at n = v = r.
    Charlie,
    /// Irradiance over π at n.
    Irradiance,
}

/// The direction that is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum SheenToward {
    Normal = code::SHEEN_TOWARD_NORMAL,
    Mirror = code::SHEEN_TOWARD_MIRROR,
    /// A fit of the lobe's first moment. With `pr = √alpha` it is along `v + (u - n·v) n`, u from
    /// `2.7 pr + 3.48 alpha` at grazing views to `1.17 alpha`.
    Moment = code::SHEEN_TOWARD_MOMENT,
}

/// The level that is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum SheenLevel {
    /// The level of the sheen's alpha.
    Alpha = code::SHEEN_LEVEL_ALPHA,
    Roughest = code::SHEEN_LEVEL_ROUGHEST,
}

/// What the base loses to a sheen in PlayCanvas.
const PLAYCANVAS_LOSS: f64 = 0.157;
const _: () = assert!(PLAYCANVAS_LOSS as f32 == code::SHEEN_LOSS);

/// The albedo that scales a lookup, or the base's loss. Fits are of E for `ashikhmin`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum SheenAlbedo {
    /// 1: the sheen's image has its albedo.
    One = code::SHEEN_ALBEDO_ONE,
    /// E of the axis `sheen_visibility`.
    Exact = code::SHEEN_ALBEDO_EXACT,
    /// The fit of three.js.
    Three = code::SHEEN_ALBEDO_THREE,
    /// An older fit of three.js at 1 - roughness.
    PlayCanvas = code::SHEEN_ALBEDO_PLAYCANVAS,
    /// The rational fit of MaterialX.
    MaterialX = code::SHEEN_ALBEDO_MATERIALX,
    /// The loss in PlayCanvas.
    Constant = code::SHEEN_ALBEDO_CONSTANT,
}

impl SheenAlbedo {
    fn value(self, exact: f64, n_dot_v: f64, alpha: f64) -> f64 {
        let pr = perceptual_roughness_from_alpha(alpha);
        let fit = match self {
            Self::One => return 1.0,
            Self::Exact => return exact,
            Self::Three => three_albedo(n_dot_v, pr),
            Self::PlayCanvas => three_albedo_before(n_dot_v, 1.0 - pr),
            Self::MaterialX => materialx_albedo(n_dot_v, pr),
            Self::Constant => PLAYCANVAS_LOSS,
        };
        fit.clamp(0.0, 1.0)
    }
}

/// How a renderer looks up a sheen lobe.
#[derive(Debug)]
pub struct SheenLookup {
    pub name: &'static str,
    /// Its source, for `splitsum list sheen-lookups`.
    pub about: &'static str,
    pub map: SheenMap,
    pub toward: SheenToward,
    pub level: SheenLevel,
    /// Scales the lookup.
    pub factor: SheenAlbedo,
    /// What the base loses.
    pub loss: SheenAlbedo,
}

const MOMENT: SheenLookup = SheenLookup {
    name: "moment",
    about: "the roughest level along the lobe's mean direction, ours",
    map: SheenMap::Levels,
    toward: SheenToward::Moment,
    level: SheenLevel::Roughest,
    factor: SheenAlbedo::Exact,
    loss: SheenAlbedo::Exact,
};

/// Every lookup. Sources at the versions that `docs/sheen.md` names.
pub static SHEEN_LOOKUPS: &[SheenLookup] = &[
    MOMENT,
    SheenLookup {
        name: "normal",
        about: "the level of its roughness along n",
        toward: SheenToward::Normal,
        level: SheenLevel::Alpha,
        ..MOMENT
    },
    SheenLookup {
        name: "irradiance",
        about: "irradiance at n",
        map: SheenMap::Irradiance,
        ..MOMENT
    },
    SheenLookup {
        name: "charlie",
        about: "a map prefiltered by the sheen lobe, along n",
        map: SheenMap::Charlie,
        toward: SheenToward::Normal,
        level: SheenLevel::Alpha,
        ..MOMENT
    },
    SheenLookup {
        name: "filament",
        about: "evaluateSheenIBL of Filament, also Babylon.js: the level of its roughness along r",
        toward: SheenToward::Mirror,
        level: SheenLevel::Alpha,
        ..MOMENT
    },
    SheenLookup {
        name: "khronos",
        about: "getIBLRadianceCharlie of the glTF Sample Renderer: a map prefiltered by the sheen \
                lobe, along r",
        map: SheenMap::Charlie,
        toward: SheenToward::Mirror,
        level: SheenLevel::Alpha,
        ..MOMENT
    },
    SheenLookup {
        name: "three",
        about: "IBLSheenBRDF of three.js since November 2025: irradiance at n, a fit of the albedo",
        map: SheenMap::Irradiance,
        factor: SheenAlbedo::Three,
        loss: SheenAlbedo::Three,
        ..MOMENT
    },
    SheenLookup {
        name: "playcanvas",
        about: "addReflectionSheen of PlayCanvas: the roughest level along n, an older fit at 1 - \
                roughness; the base loses 0.157 C",
        toward: SheenToward::Normal,
        factor: SheenAlbedo::PlayCanvas,
        loss: SheenAlbedo::Constant,
        ..MOMENT
    },
    SheenLookup {
        name: "materialx",
        about: "mx_sheen_bsdf of MaterialX: irradiance at n, a rational fit of the albedo",
        map: SheenMap::Irradiance,
        factor: SheenAlbedo::MaterialX,
        loss: SheenAlbedo::MaterialX,
        ..MOMENT
    },
];

listed!(SheenLookup, "sheen lookup", SHEEN_LOOKUPS);

/// `IBLSheenBRDF` since pull request 32397.
fn three_albedo(n_dot_v: f64, pr: f64) -> f64 {
    let inverse = 1.0 / (pr + 0.1);
    let a = -1.9362 + 1.0678 * pr + 0.4573 * pr * pr - 0.8469 * inverse;
    let b = -0.6014 + 0.5538 * pr - 0.4670 * pr * pr - 0.1255 * inverse;
    (a * n_dot_v + b).exp()
}

/// The same function before, π times.
fn three_albedo_before(n_dot_v: f64, pr: f64) -> f64 {
    if pr < 0.25 {
        let a = -339.2 * pr * pr + 161.4 * pr - 25.9;
        let b = 44.0 * pr * pr - 23.7 * pr + 3.26;
        (a * n_dot_v + b).exp()
    } else {
        let a = -8.48 * pr * pr + 14.3 * pr - 9.95;
        let b = 1.97 * pr * pr - 3.27 * pr + 0.72;
        (a * n_dot_v + b).exp() + 0.1 * (pr - 0.25)
    }
}

/// `mx_imageworks_sheen_dir_albedo_analytic`, whose roughness is alpha.
fn materialx_albedo(x: f64, pr: f64) -> f64 {
    let alpha = pr * pr;
    let up = 13.673 - 68.78018 * x + 799.08825 * alpha - 905.00061 * x * alpha
        + 60.28956 * x * x
        + 1086.96473 * alpha * alpha;
    let down = 1.0
        + 61.57746 * x
        + 442.78211 * alpha
        + 2597.49308 * x * alpha
        + 121.81241 * x * x
        + 3045.55075 * alpha * alpha;
    up / down
}

impl SheenLookup {
    /// Returns itself if it reads the prefiltered map of the image, scaled by the exact albedo;
    /// else the first.
    pub fn plain(&'static self) -> &'static Self {
        let is_plain = matches!(
            (self.map, self.factor),
            (SheenMap::Levels, SheenAlbedo::Exact)
        );
        if is_plain { self } else { &SHEEN_LOOKUPS[0] }
    }

    /// Returns the specialization constant `sheen_lookup`.
    pub fn code(&self) -> u32 {
        self.toward as u32 | (self.level as u32) << 4
    }

    /// Returns the lookup for a unit normal and view, as
    /// `shaders/shade/method/sheen_lookup.glsl`.
    pub fn tap(&self, [n, v]: [DVec3; 2], alpha: f64) -> SheenTap {
        let n_dot_v = n.dot(v);
        let direction = match self.toward {
            SheenToward::Normal => n,
            SheenToward::Mirror => reflect(v, n),
            SheenToward::Moment => {
                let grazing = 2.7 * perceptual_roughness_from_alpha(alpha) + 3.48 * alpha;
                (v + (grazing + (1.17 * alpha - grazing) * n_dot_v - n_dot_v) * n).normalize()
            }
        };
        SheenTap {
            direction,
            alpha: match self.level {
                SheenLevel::Alpha => alpha,
                SheenLevel::Roughest => 1.0,
            },
        }
    }
}

/// A lookup of the prefiltered map.
#[derive(Clone, Copy, Debug)]
pub struct SheenTap {
    pub direction: DVec3,
    /// Alpha of the level.
    pub alpha: f64,
}

/// What scales the image of a sheen, and what its base loses. Without a lookup the image is I.
pub fn albedos_of(lookup: Option<&SheenLookup>) -> [SheenAlbedo; 2] {
    match lookup {
        Some(lookup) => [lookup.factor, lookup.loss],
        None => [SheenAlbedo::One, SheenAlbedo::Exact],
    }
}

/// What the images of a surface with sheen count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheenShares {
    pub base: DVec3,
    pub sheen: DVec3,
}

/// Returns the shares at a pixel. Without a lookup the sheen's image is I.
pub fn shares(
    lookup: Option<&SheenLookup>,
    color: DVec3,
    alpha: f64,
    n_dot_v: f64,
    albedo: f64,
) -> SheenShares {
    let [factor, loss] = albedos_of(lookup).map(|of| of.value(albedo, n_dot_v, alpha));
    SheenShares {
        base: DVec3::splat((1.0 - color.max_element() * loss).max(0.0)),
        sheen: factor * color,
    }
}
