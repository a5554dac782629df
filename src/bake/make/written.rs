//! Levels of a bake as read back, and what their pixel format loses.

use super::making::{Making, formats};
use crate::bake::container::Texel;
use crate::bake::judge::{Errors, GOOD, GOOD_BIAS, Part};
use crate::base::pixels::RgbImage;
use std::fmt;

/// Smallest share of a level's light that is reported if a format cuts it.
const CUT_MIN: f64 = 1e-3;

/// A level as read back.
#[derive(Clone, Debug)]
pub struct Written {
    pub part: Part,
    pub side: u32,
    pub alpha: f64,
    /// relMSE against its integral.
    pub relmse: f64,
    /// Mean over the sphere, relative to the exact mean, minus 1.
    pub bias_rel: f64,
    /// What the pixel format loses, if it loses much.
    pub loss: Option<Loss>,
}

/// What a pixel format loses of a level.
#[derive(Clone, Copy, Debug)]
pub enum Loss {
    /// Values above the largest of the format are cut.
    Cut(CutLoss),
    /// Dark channels beside bright ones are rounded.
    Rounding {
        texel: &'static Texel,
        /// Whether the same file may have other formats.
        has_choice: bool,
    },
}

/// Values that a format cuts.
#[derive(Clone, Copy, Debug)]
pub struct CutLoss {
    pub texel: &'static Texel,
    pub texel_count: usize,
    /// Largest value of the level.
    pub largest: f32,
    /// Share of the level's light that is cut.
    pub share: f64,
    /// The smallest format of the same file that holds the largest value.
    pub enough: Option<&'static Texel>,
}

impl Loss {
    /// Returns the loss of the exact faces of a level with these errors. relMSE alone would miss a
    /// cut sun: it is few texels, and most of the light.
    pub(super) fn of(making: &Making, faces: &[RgbImage], errors: Errors) -> Option<Self> {
        let texel = making.texel;
        let largest_of = |rgb: &[f32; 3]| rgb.iter().copied().fold(0.0, f32::max);
        let values = || faces.iter().flat_map(|face| &face.data).map(largest_of);
        let texel_count = values().filter(|value| *value > texel.largest).count();
        let share = -errors.bias_rel;
        let is_off = errors.relmse > GOOD || errors.bias_rel.abs() > GOOD_BIAS;
        if texel_count > 0 && (is_off || share > CUT_MIN) {
            let largest = values().fold(0.0, f32::max);
            return Some(Self::Cut(CutLoss {
                texel,
                texel_count,
                largest,
                share,
                enough: formats(making.preset.product())
                    .filter(|format| format.largest >= largest)
                    .min_by_key(|format| format.bytes),
            }));
        }
        is_off.then(|| Self::Rounding {
            texel,
            has_choice: formats(making.preset.product()).count() > 1,
        })
    }
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Cut(CutLoss {
                texel,
                texel_count,
                largest,
                share,
                enough,
            }) => {
                write!(
                    f,
                    "loses {:.2} % of its light: {texel_count} texels, up to {largest:.3e}, are \
                     cut at {}, the maximum of {}; ",
                    100.0 * share,
                    texel.largest,
                    texel.name
                )?;
                match enough {
                    Some(format) => write!(f, "--format {} holds them", format.name),
                    None => f.write_str("clip the map before the bake"),
                }
            }
            Self::Rounding { texel, has_choice } => {
                write!(f, "{} rounds dark channels beside bright ones", texel.name)?;
                if *has_choice {
                    f.write_str("; try another --format")?;
                }
                Ok(())
            }
        }
    }
}
