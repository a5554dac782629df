//! Known slips of a bake, as data; `words` writes them.

use super::directions::TexelGrid;
use super::doubt::Doubt;
use super::faces::FaceSlip;
use super::fit::Gain;
use super::light::SourceSlip;
use super::lobe::Lobe;
use super::mip_chain::MipSource;
use super::negative::NegativeTexels;
use super::table_slip::TableSlip;
use super::texel::{ChannelCopy, ChannelOrder, ColorConversion, Curve, Packing, Rgbm, Tone};
use crate::bake::convention::Axes;
use crate::instrument::precompute::prefilter::{LevelMapping, Weight};
use glam::DVec3;

/// What a verdict names: a slip, or that none is known.
#[derive(Clone, Debug, PartialEq)]
pub enum Cause {
    Unknown(Unknown),
    /// The axes or the light of the whole bake.
    Doubt(Doubt),
    Chain(ChainSlip),
    /// A level that is good otherwise has texels far below 0.
    Negative(NegativeTexels),
    /// Every texel of the level is black.
    Black,
    BlackFaces(Vec<usize>),
    Faces(FaceSlip),
    /// Too few samples: errors from texel to texel.
    Noise,
    /// A fit without a width or a gain that differs.
    SlightlyOff,
    Width(WidthSlip),
    Gain(GainSlip),
    Cut(CutSlip),
    Source(SourceSlip),
    Channels(ChannelOrder),
    Copy(ChannelCopy),
    Encoding(Encoding),
    Colors(ColorConversion),
    Turn(Turn),
    Weight(&'static Weight),
    /// Irradiance without the weight n·l.
    NoCosine,
    /// Name of another BRDF model.
    Model(&'static str),
    Lobe(Lobe),
    /// Filtered from the level before it by its whole width.
    BlursAddUp,
    Mips(Mips),
    /// Samples read mips these many levels too blurred, if there are 1024.
    CoarseMips {
        levels: f64,
        source: MipSource,
    },
    /// Each face of a cube is filtered without its neighbours.
    FacesAlone,
    /// Every texel has one value.
    Flat,
    Grid(TexelGrid),
    Sh(ShSlip),
    Table(TableSlip),
}

/// Why no slip is named.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unknown {
    /// No known slip leaves little of the error.
    NoSlip,
    /// A slip of one level proves nothing if the axes or the light do not fit.
    Doubt,
    /// Only the mean of a good level is off, by this share.
    Mean { bias_rel: f64 },
    /// No convention fits a table.
    OtherTable,
    /// No other convention fits a table better.
    Table { max_error: f64 },
}

/// Levels with widths other than the assumed ones.
#[derive(Clone, Debug, PartialEq)]
pub enum ChainSlip {
    Mapping(MappingSlip),
    Law { law: WidthLaw, alphas: Vec<f64> },
}

/// Levels of another mapping, or of a chain without some levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MappingSlip {
    /// `None` for the assumed mapping.
    pub mapping: Option<&'static LevelMapping>,
    /// Missing levels at either end of the chain.
    pub first_missing: usize,
    pub last_missing: usize,
    /// Levels of the whole chain.
    pub level_count: usize,
}

/// How the widths of all levels differ from the assumed ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WidthLaw {
    NextLevel,
    LevelBefore,
    /// alpha is the fourth power of roughness.
    SquaredTwice,
    /// alpha is roughness.
    NotSquared,
    /// The mapping covers levels that the engine does not read.
    EveryLevel,
    /// Roughness is k/n in a chain that is read at k/(n - 1).
    OverCount,
    /// Roughness is k/(n - 1/2) in a chain that is read at k/(n - 1): 2k/11 of six levels, as of
    /// PlayCanvas 2.23.
    OverHalfCount,
    /// A factor on the roughness of every level.
    RoughnessTimes(f64),
}

/// A level of another width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WidthSlip {
    pub found_alpha: f64,
    pub alpha: f64,
    /// Levels by which it is too blurred; `None` if widths are given one by one.
    pub shift: Option<f64>,
}

/// A wrong factor on values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GainSlip {
    /// A gain, and the factor of the file that it changes.
    Level { gain: Gain, scale: Scale },
    /// A gain of SH.
    Sh(Gain),
    /// Divided by the number of samples; expected the sum of their weights.
    MeanWeight,
    /// Gains of red, green and blue.
    Channels(DVec3),
}

/// The convention's factor on a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    pub flag: ScaleFlag,
    pub value: f64,
}

/// The map that a factor applies to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScaleFlag {
    Radiance,
    Irradiance,
}

/// A level whose bright values are cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutSlip {
    /// Largest value of the level.
    pub limit: f64,
    /// Share by which the mean is off, if that alone is wrong.
    pub bias_rel: Option<f64>,
}

/// An encoding that was read as linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Encoding {
    Curve(Curve),
    Tone {
        tone: Tone,
        exposure: f64,
    },
    Packing(Packing),
    Rgbm(Rgbm),
    /// RGBP whose scale was rounded up, so that the largest channel is cut.
    RgbpScaleRoundedUp,
}

/// A world axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TurnAxis {
    X,
    Y,
    Z,
}

impl TurnAxis {
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    pub fn vector(self) -> DVec3 {
        match self {
            Self::X => DVec3::X,
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }
}

/// A turn of the environment about an axis of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    pub axis: TurnAxis,
    pub degrees: f64,
}

/// A level that is not prefiltered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mips {
    /// Each texel is the mean of four texels of the level before.
    OfLevelBefore,
    /// The environment, averaged over each texel.
    OfEnvironment,
    /// One lookup of the environment a texel.
    OneLookup,
    /// One lookup a texel, of the pixel whose index is rounded: half a pixel off.
    OneLookupRounded,
}

/// A slip of SH that maps cannot have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShSlip {
    Form(ShForm),
    Axes(Axes),
    /// Not convolved with the cosine.
    NoCosine,
    CosineTwice,
    Window(ShWindow),
}

/// The form of coefficients in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShForm {
    /// Odd m have the other sign.
    CondonShortley,
    /// Without the constants of the basis, as of cmgen's `--sh-irradiance`.
    Unscaled,
    /// Nine numbers of a channel, one channel after the other.
    Planar,
    /// m = l to -l.
    Descending,
    /// Degree 1 as x, y, z.
    Xyz,
    /// Degree 1 as x, z, y.
    Xzy,
}

/// Factors on degrees 1 and 2, over the factor on degree 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShWindow {
    NoDegree2,
    /// Against ringing: falling factors from 0 to 1.
    Falling([f64; 2]),
    Other([f64; 2]),
}

impl Cause {
    /// Whether no slip is named.
    pub fn is_unknown(&self) -> bool {
        matches!(self, Self::Unknown(_))
    }

    /// Whether it names black texels.
    pub fn is_black(&self) -> bool {
        matches!(self, Self::Black | Self::BlackFaces(_))
    }

    /// Whether it only moves or spreads light, which keeps the mean of a level.
    pub fn keeps_mean(&self) -> bool {
        matches!(
            self,
            Self::Faces(_)
                | Self::Width(_)
                | Self::Turn(_)
                | Self::Weight(_)
                | Self::Model(_)
                | Self::Lobe(_)
                | Self::BlursAddUp
                | Self::Mips(Mips::OfEnvironment)
                | Self::CoarseMips { .. }
                | Self::Grid(_)
        )
    }

    /// Whether it names a cut of the level or of its source.
    pub fn is_cut(&self) -> bool {
        matches!(
            self,
            Self::Cut(_)
                | Self::Source(
                    SourceSlip::Cut { .. } | SourceSlip::CutAndCurve(_) | SourceSlip::Level0
                )
        )
    }

    /// Whether it is a gain that no program is known to forget.
    pub fn is_unknown_gain(&self) -> bool {
        let Self::Gain(GainSlip::Level { gain, .. }) = self else {
            return false;
        };
        matches!(gain, Gain::Other(_))
    }

    /// Whether it names how the file rounds its values, beside which others are named.
    pub fn is_rounding(&self) -> bool {
        *self == Self::Encoding(Encoding::RgbpScaleRoundedUp)
    }

    /// Whether the level seems not to be prefiltered.
    pub fn is_mips(&self) -> bool {
        matches!(self, Self::Mips(_))
    }

    /// Whether it names axes.
    pub fn is_axes(&self) -> bool {
        match self {
            Self::Doubt(doubt) => doubt.axes().is_some(),
            Self::Faces(FaceSlip::Axes(_)) | Self::Sh(ShSlip::Axes(_)) => true,
            _ => false,
        }
    }
}
