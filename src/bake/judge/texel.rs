//! Slips that change each texel by itself.

use crate::base::color::{luminance, srgb_curve, srgb_decode};
use glam::{DMat3, DVec3, Vec3Swizzles};

/// An order of channels: the right channel (0 is red) that each stored channel holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelOrder(pub [usize; 3]);

impl ChannelOrder {
    pub const RIGHT: Self = Self([0, 1, 2]);
    pub const WRONG: [Self; 5] = [
        Self([0, 2, 1]),
        Self([1, 0, 2]),
        Self([2, 1, 0]),
        Self([1, 2, 0]),
        Self([2, 0, 1]),
    ];

    pub fn apply(self, color: DVec3) -> DVec3 {
        DVec3::from_array(self.0.map(|channel| color[channel]))
    }
}

/// Channels that do not hold red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChannelCopy {
    /// Alpha, red, green.
    AlphaFirst,
    Red,
    Green,
    Blue,
    Luminance,
    Mean,
}

impl ChannelCopy {
    pub const ALL: [Self; 6] = [
        Self::AlphaFirst,
        Self::Red,
        Self::Green,
        Self::Blue,
        Self::Luminance,
        Self::Mean,
    ];

    pub fn apply(self, color: DVec3) -> DVec3 {
        match self {
            Self::AlphaFirst => DVec3::new(1.0, color.x, color.y),
            Self::Red => color.xxx(),
            Self::Green => color.yyy(),
            Self::Blue => color.zzz(),
            Self::Luminance => DVec3::splat(luminance(color.as_vec3().to_array())),
            Self::Mean => DVec3::splat(color.element_sum() / 3.0),
        }
    }
}

/// Primaries of another linear colour space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primaries {
    AcesCg,
    Rec2020,
    DisplayP3,
    CieXyz,
}

impl Primaries {
    pub const ALL: [Self; 4] = [Self::AcesCg, Self::Rec2020, Self::DisplayP3, Self::CieXyz];

    /// Returns the matrix from linear Rec. 709.
    pub fn rec709_to_primaries(self) -> DMat3 {
        let rows = match self {
            Self::AcesCg => [
                [0.6131, 0.3395, 0.0474],
                [0.0702, 0.9164, 0.0134],
                [0.0206, 0.1096, 0.8698],
            ],
            Self::Rec2020 => [
                [0.6274, 0.3293, 0.0433],
                [0.0691, 0.9195, 0.0114],
                [0.0164, 0.0880, 0.8956],
            ],
            Self::DisplayP3 => [
                [0.8225, 0.1775, 0.0],
                [0.0332, 0.9668, 0.0],
                [0.0171, 0.0724, 0.9105],
            ],
            Self::CieXyz => [
                [0.4124, 0.3576, 0.1805],
                [0.2126, 0.7152, 0.0722],
                [0.0193, 0.1192, 0.9505],
            ],
        };
        DMat3::from_cols_array_2d(&rows).transpose()
    }
}

/// A conversion of colours that no bake needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColorConversion {
    To(Primaries),
    From(Primaries),
}

impl ColorConversion {
    pub fn matrix(self) -> DMat3 {
        match self {
            Self::To(primaries) => primaries.rec709_to_primaries(),
            Self::From(primaries) => primaries.rec709_to_primaries().inverse(),
        }
    }
}

/// A transfer curve that was applied to linear values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    /// `x^(1/2.2)`
    GammaEncoded,
    /// `x^2.2`
    GammaDecoded,
    SrgbEncoded,
    SrgbDecoded,
}

impl Curve {
    pub const ALL: [Self; 4] = [
        Self::GammaEncoded,
        Self::GammaDecoded,
        Self::SrgbEncoded,
        Self::SrgbDecoded,
    ];

    pub fn apply(self, x: f64) -> f64 {
        match self {
            Self::GammaEncoded => x.powf(1.0 / 2.2),
            Self::GammaDecoded => x.powf(2.2),
            Self::SrgbEncoded => srgb_curve(x),
            Self::SrgbDecoded => srgb_decode(x as f32).into(),
        }
    }

    pub fn inverse(self) -> Self {
        match self {
            Self::GammaEncoded => Self::GammaDecoded,
            Self::GammaDecoded => Self::GammaEncoded,
            Self::SrgbEncoded => Self::SrgbDecoded,
            Self::SrgbDecoded => Self::SrgbEncoded,
        }
    }
}

/// A tone curve of an exposed value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tone {
    Reinhard,
    /// Narkowicz's fit of ACES.
    Aces,
    Hable,
    Exponential,
    Logarithm,
    /// SMPTE ST 2084 with 1 at 100 nits.
    Pq,
}

/// White point of Hable's curve.
const HABLE_WHITE: f64 = 11.2;

impl Tone {
    pub const ALL: [Self; 6] = [
        Self::Reinhard,
        Self::Aces,
        Self::Hable,
        Self::Exponential,
        Self::Logarithm,
        Self::Pq,
    ];

    pub fn apply(self, color: DVec3) -> DVec3 {
        let x = color;
        match self {
            Self::Reinhard => x / (1.0 + x),
            Self::Aces => (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).min(DVec3::ONE),
            Self::Hable => hable(x) / hable(DVec3::splat(HABLE_WHITE)),
            Self::Exponential => 1.0 - (-x).exp(),
            Self::Logarithm => x.map(f64::ln_1p),
            Self::Pq => x.map(|x| pq(x / 100.0)),
        }
    }
}

/// A packed format that was read as linear RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Packing {
    Rgbd,
    /// RGBD of values to the power of 1/2.2.
    RgbdGamma,
    Rgbe,
    LogLuv,
    /// Half floats as 16-bit integers.
    HalfAsInteger,
}

impl Packing {
    pub const ALL: [Self; 5] = [
        Self::Rgbd,
        Self::RgbdGamma,
        Self::Rgbe,
        Self::LogLuv,
        Self::HalfAsInteger,
    ];

    pub fn apply(self, color: DVec3) -> DVec3 {
        match self {
            Self::Rgbd => rgbd(color),
            Self::RgbdGamma => rgbd(color).powf(1.0 / 2.2),
            Self::Rgbe => rgbe(color),
            Self::LogLuv => log_luv(color),
            Self::HalfAsInteger => {
                color.map(|x| f64::from(half::f16::from_f64(x).to_bits()) / 65535.0)
            }
        }
    }
}

/// RGBM that was read as linear RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rgbm {
    /// Value of the multiplier 1.
    pub range: f64,
    /// Exponent of the decoder.
    pub exponent: f64,
}

impl Rgbm {
    pub const ALL: [Self; 9] = [
        Self::new(5.0, 1.0),
        Self::new(6.0, 1.0),
        Self::new(7.0, 1.0),
        Self::new(8.0, 1.0),
        Self::new(16.0, 1.0),
        Self::new(64.0, 1.0),
        Self::new(8.0, 2.0),
        Self::new(5.0, 2.2),
        Self::new(8.0, 2.2),
    ];

    const fn new(range: f64, exponent: f64) -> Self {
        Self { range, exponent }
    }

    /// Divides by the range and by a multiplier of at most 1, in steps of 1/255.
    pub fn apply(self, color: DVec3) -> DVec3 {
        let encoded = color.powf(1.0 / self.exponent);
        let multiplier = (255.0 * (encoded.max_element() / self.range).min(1.0)).ceil() / 255.0;
        if multiplier > 0.0 {
            (encoded / (self.range * multiplier)).min(DVec3::ONE)
        } else {
            encoded
        }
    }
}

/// A cut of bright values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cut {
    EachChannel,
    /// Scales the whole colour, which keeps its hue.
    WithHue,
    /// Replaces brighter colours by black.
    ToBlack,
}

impl Cut {
    pub const ALL: [Self; 3] = [Self::EachChannel, Self::WithHue, Self::ToBlack];

    pub fn apply(self, color: DVec3, limit: f64) -> DVec3 {
        match self {
            Self::EachChannel => color.min(DVec3::splat(limit)),
            Self::WithHue => color * (limit / color.max_element().max(limit)),
            Self::ToBlack if color.max_element() > limit => DVec3::ZERO,
            Self::ToBlack => color,
        }
    }
}

/// The curve of Uncharted 2 before its division by white.
fn hable(x: DVec3) -> DVec3 {
    (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3
}

/// SMPTE ST 2084, of luminance over 10,000 nits.
fn pq(x: f64) -> f64 {
    let power = x.max(0.0).powf(1305.0 / 8192.0);
    ((0.8359375 + 18.8515625 * power) / (1.0 + 18.6875 * power)).powf(78.84375)
}

/// Colours of RGBD: times a divisor of at most 1 that brings the largest below 1.
fn rgbd(x: DVec3) -> DVec3 {
    let divisor = (255.0 / x.max_element().max(1e-6))
        .floor()
        .clamp(1.0, 255.0);
    x * (divisor / 255.0)
}

/// Mantissas of RGBE: over a power of two that brings the largest into [1/2, 1).
fn rgbe(x: DVec3) -> DVec3 {
    x / (x.max_element().max(1e-30).log2().floor() + 1.0).exp2()
}

/// First three channels of LogLuv in 32 bits (Larson 1998), with the matrix that three.js used.
fn log_luv(x: DVec3) -> DVec3 {
    const FROM_RGB: DMat3 = DMat3::from_cols_array(&[
        0.2209, 0.3390, 0.4184, 0.1138, 0.6780, 0.7319, 0.0102, 0.1130, 0.2969,
    ]);
    let [x, y, sum] = (FROM_RGB * x).max(DVec3::splat(1e-6)).to_array();
    let log = 2.0 * y.log2() + 127.0;
    DVec3::new(
        x / sum,
        y / sum,
        (log - (255.0 * log.fract()).floor() / 255.0) / 255.0,
    )
}
