//! Sheen of cloth over a base ([`crate::instrument::brdf::SheenVisibility`]), with its own colour C and width.
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

/// What a lookup reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheenMap {
    /// The prefiltered map of the image.
    Levels,
    /// A map prefiltered by the lobe of the sheen at n = v = r.
    Charlie,
    /// Irradiance over π at n.
    Irradiance,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum SheenToward {
    Normal = code::SHEEN_TOWARD_NORMAL,
    Mirror = code::SHEEN_TOWARD_MIRROR,
    /// A fit of the lobe's first moment. With `pr = √alpha` it is along `v + (u - n·v) n`, u from
    /// `2.7 pr + 3.48 alpha` at grazing views to `1.17 alpha`.
    Moment = code::SHEEN_TOWARD_MOMENT,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum SheenLevel {
    /// Of the sheen's alpha.
    Own = code::SHEEN_LEVEL_OWN,
    Roughest = code::SHEEN_LEVEL_ROUGHEST,
}

/// The albedo that scales a lookup, or the base's loss.
#[derive(Clone, Copy, Debug)]
pub enum SheenAlbedo {
    /// E of the axis `sheen_visibility`.
    Exact,
    /// A renderer's fit of E for `ashikhmin`, by n·v and perceptual roughness.
    Fit(fn(f64, f64) -> f64),
}

impl SheenAlbedo {
    fn at(self, exact: f64, n_dot_v: f64, alpha: f64) -> f64 {
        match self {
            Self::Exact => exact,
            Self::Fit(fit) => fit(n_dot_v, perceptual_roughness_from_alpha(alpha)).clamp(0.0, 1.0),
        }
    }
}

/// How a renderer looks up a sheen lobe.
#[derive(Debug)]
pub struct SheenLookup {
    pub name: &'static str,
    /// Where it is from, for `splitsum list sheen-lookups`.
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
        level: SheenLevel::Own,
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
        level: SheenLevel::Own,
        ..MOMENT
    },
    SheenLookup {
        name: "filament",
        about: "evaluateSheenIBL of Filament, also Babylon.js: the level of its roughness along r",
        toward: SheenToward::Mirror,
        level: SheenLevel::Own,
        ..MOMENT
    },
    SheenLookup {
        name: "khronos",
        about: "getIBLRadianceCharlie of the glTF Sample Renderer: a map prefiltered by the sheen \
                lobe, along r",
        map: SheenMap::Charlie,
        toward: SheenToward::Mirror,
        level: SheenLevel::Own,
        ..MOMENT
    },
    SheenLookup {
        name: "three",
        about: "IBLSheenBRDF of three.js since November 2025: irradiance at n, a fit of the albedo",
        map: SheenMap::Irradiance,
        factor: SheenAlbedo::Fit(three_albedo),
        loss: SheenAlbedo::Fit(three_albedo),
        ..MOMENT
    },
    SheenLookup {
        name: "playcanvas",
        about: "addReflectionSheen of PlayCanvas: the roughest level along n, an older fit at 1 - \
                roughness; the base loses 0.157 C",
        toward: SheenToward::Normal,
        factor: SheenAlbedo::Fit(|n_dot_v, pr| three_albedo_before(n_dot_v, 1.0 - pr)),
        loss: SheenAlbedo::Fit(|_, _| 0.157),
        ..MOMENT
    },
    SheenLookup {
        name: "materialx",
        about: "mx_sheen_bsdf of MaterialX: irradiance at n, a rational fit of the albedo",
        map: SheenMap::Irradiance,
        factor: SheenAlbedo::Fit(materialx_albedo),
        loss: SheenAlbedo::Fit(materialx_albedo),
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
    let (a, b, more) = match pr < 0.25 {
        true => (
            -339.2 * pr * pr + 161.4 * pr - 25.9,
            44.0 * pr * pr - 23.7 * pr + 3.26,
            0.0,
        ),
        false => (
            -8.48 * pr * pr + 14.3 * pr - 9.95,
            1.97 * pr * pr - 3.27 * pr + 0.72,
            0.1 * (pr - 0.25),
        ),
    };
    (a * n_dot_v + b).exp() + more
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

    pub fn code(&self) -> u32 {
        self.toward as u32 | (self.level as u32) << 4
    }

    /// Returns direction and alpha of the level that are looked up, as
    /// `shaders/shade/method/sheen_lookup.glsl`.
    pub fn place(&self, [n, v]: [DVec3; 2], alpha: f64) -> (DVec3, f64) {
        let n_dot_v = n.dot(v);
        let grazing = 2.7 * perceptual_roughness_from_alpha(alpha) + 3.48 * alpha;
        let direction = match self.toward {
            SheenToward::Normal => n,
            SheenToward::Mirror => reflect(v, n),
            SheenToward::Moment => {
                (v + (grazing + (1.17 * alpha - grazing) * n_dot_v - n_dot_v) * n).normalize()
            }
        };
        (
            direction,
            if self.level == SheenLevel::Roughest {
                1.0
            } else {
                alpha
            },
        )
    }
}

/// What the images of a surface with sheen count: the base's and the sheen's. Without a lookup the
/// sheen's image is I.
pub fn shares(
    lookup: Option<&SheenLookup>,
    color: DVec3,
    alpha: f64,
    n_dot_v: f64,
    albedo: f64,
) -> [DVec3; 2] {
    let [factor, loss] = match lookup {
        Some(lookup) => [lookup.factor, lookup.loss].map(|of| of.at(albedo, n_dot_v, alpha)),
        None => [1.0, albedo],
    };
    [
        DVec3::splat((1.0 - color.max_element() * loss).max(0.0)),
        factor * color,
    ]
}
