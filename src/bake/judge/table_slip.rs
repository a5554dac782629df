//! Slips of a DFG table: other readings of its texels, and other integrals.

use super::texel::Curve;
use crate::base::glsl::constants::ALPHA_MIN;
use crate::instrument::brdf::{MaskingShadowing, alpha_from_perceptual_roughness};
use glam::DVec2;

/// Why a table differs from its integrals. Shares are of the rms error, left without the slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TableSlip {
    /// Other conventions fit.
    Convention {
        flags: TableFlags,
        rms_left: f64,
    },
    Reading {
        reading: Reading,
        share_left: f64,
    },
    Shift {
        texels: DVec2,
        share_left: f64,
    },
    Stretch {
        lines: StretchedLines,
        share_left: f64,
    },
    Integral(Integral),
    /// Other conventions fit, with another reading.
    ConventionAndReading {
        flags: TableFlags,
        reading: Reading,
    },
    /// Errs at grazing angles only.
    TooFewSamples,
    /// Only the outermost texels err.
    Borders(WrongBorders),
}

/// The sides of a table whose outermost texels are wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WrongBorders {
    pub left: bool,
    pub right: bool,
    pub top: bool,
    pub bottom: bool,
}

impl WrongBorders {
    /// Returns the sides that a texel at these texture coordinates lies on, in a table with texels
    /// of this size.
    pub fn at(uv: DVec2, texel_size: DVec2) -> Self {
        Self {
            left: uv.x < texel_size.x,
            right: 1.0 - uv.x < texel_size.x,
            top: uv.y < texel_size.y,
            bottom: 1.0 - uv.y < texel_size.y,
        }
    }

    pub fn is_empty(self) -> bool {
        self == Self::default()
    }

    /// Returns the number of sides.
    pub fn count(self) -> usize {
        let sides = [self.left, self.right, self.top, self.bottom];
        sides.into_iter().filter(|side| *side).count()
    }

    /// Whether both have a side.
    pub fn intersects(self, other: Self) -> bool {
        self.left && other.left
            || self.right && other.right
            || self.top && other.top
            || self.bottom && other.bottom
    }

    pub fn or(self, other: Self) -> Self {
        Self {
            left: self.left || other.left,
            right: self.right || other.right,
            top: self.top || other.top,
            bottom: self.bottom || other.bottom,
        }
    }
}

/// Conventions of a table that differ from the assumed ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TableFlags {
    pub axes: Option<&'static str>,
    pub channels: Option<&'static str>,
    pub masking: Option<&'static str>,
}

impl TableFlags {
    pub fn is_empty(self) -> bool {
        self == Self::default()
    }
}

/// Lines of a table whose first and last are at the edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StretchedLines {
    Columns,
    Rows,
    Both,
}

impl StretchedLines {
    pub const ALL: [Self; 3] = [Self::Columns, Self::Rows, Self::Both];

    pub fn axes(self) -> DVec2 {
        match self {
            Self::Columns => DVec2::X,
            Self::Rows => DVec2::Y,
            Self::Both => DVec2::ONE,
        }
    }
}

/// Another meaning of a table's parameters or values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// Values with this curve.
    Curve(Curve),
    /// Roughness is alpha.
    Alpha,
    RootOfRoughness,
    RootOfNDotV,
}

impl Reading {
    pub const ALL: [Self; 7] = [
        Self::Curve(Curve::GammaEncoded),
        Self::Curve(Curve::SrgbEncoded),
        Self::Curve(Curve::GammaDecoded),
        Self::Curve(Curve::SrgbDecoded),
        Self::Alpha,
        Self::RootOfRoughness,
        Self::RootOfNDotV,
    ];

    /// Returns n·v and perceptual roughness of a texel whose place says `parameters`.
    pub fn parameters(self, parameters: DVec2) -> DVec2 {
        let DVec2 { x, y } = parameters;
        match self {
            Self::Curve(_) => parameters,
            Self::Alpha => DVec2::new(x, y.sqrt()),
            Self::RootOfRoughness => DVec2::new(x, y * y),
            Self::RootOfNDotV => DVec2::new(x * x, y),
        }
    }

    pub fn values(self, texel: DVec2) -> DVec2 {
        match self {
            Self::Curve(curve) => texel.map(|x| curve.inverse().apply(x)),
            Self::Alpha | Self::RootOfRoughness | Self::RootOfNDotV => texel,
        }
    }
}

/// An integral other than A and B.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integral {
    /// Schlick's masking with k = (r + 1)²/8.
    SchlickDirect,
    /// Schlick's masking with k = alpha²/2.
    SchlickAlphaSquared,
    /// Schlick's masking with k = alpha.
    SchlickAlpha,
    /// Schlick's masking with k = alpha/4, as in SAPIEN.
    SchlickQuarter,
    /// Schlick's masking with k = r/2.
    SchlickRoughness,
    MaskingByRoughness,
    MaskingByAlphaSquared,
    FresnelOfHalf,
    FresnelOfView,
    /// Samples without the factor v·h of their weight.
    WithoutFactor,
    /// Samples without the divisor n·h of their weight.
    WithoutDivisor,
}

impl Integral {
    pub const ALL: [Self; 11] = [
        Self::SchlickDirect,
        Self::SchlickAlphaSquared,
        Self::SchlickAlpha,
        Self::SchlickQuarter,
        Self::SchlickRoughness,
        Self::MaskingByRoughness,
        Self::MaskingByAlphaSquared,
        Self::FresnelOfHalf,
        Self::FresnelOfView,
        Self::WithoutFactor,
        Self::WithoutDivisor,
    ];

    /// Returns the masking, if it is not the expected one.
    pub fn masking(self) -> Option<MaskingShadowing> {
        matches!(
            self,
            Self::SchlickDirect
                | Self::SchlickAlphaSquared
                | Self::SchlickAlpha
                | Self::SchlickQuarter
                | Self::SchlickRoughness
        )
        .then_some(MaskingShadowing::Schlick)
    }

    /// Returns the masking's width; Schlick's k is half of it.
    pub fn masking_width(self, roughness: f64) -> f64 {
        let r = roughness;
        match self {
            Self::SchlickDirect => (r + 1.0).powi(2) / 4.0,
            Self::SchlickAlphaSquared | Self::MaskingByAlphaSquared => r.powi(4),
            Self::SchlickAlpha => 2.0 * r * r,
            Self::SchlickQuarter => r * r / 2.0,
            Self::SchlickRoughness | Self::MaskingByRoughness => r,
            _ => shaded_alpha(r),
        }
    }

    /// Returns the factor of a sample and the cosine of its Fresnel term, as
    /// [`dfg_by`](crate::instrument::precompute::dfg::reference::dfg_by) takes them.
    pub fn facet(self, v_dot_h: f64, n_dot_h: f64, n_dot_v: f64) -> [f64; 2] {
        match self {
            Self::FresnelOfHalf => [v_dot_h, n_dot_h],
            Self::FresnelOfView => [v_dot_h, n_dot_v],
            Self::WithoutFactor => [1.0, v_dot_h],
            Self::WithoutDivisor => [v_dot_h * n_dot_h, v_dot_h],
            _ => [v_dot_h; 2],
        }
    }
}

/// Returns alpha of a perceptual roughness, no narrower than the device shades.
pub fn shaded_alpha(roughness: f64) -> f64 {
    alpha_from_perceptual_roughness(roughness).max(ALPHA_MIN.into())
}
