//! Radiance by direction: environments from files and from formulas.

use crate::pixels::RgbImage;

/// A distant environment: an equirectangular map of linear radiance (see `math::equirect`), looked up bilinearly.
#[derive(Clone, Debug)]
pub struct Environment {
    /// What the user wrote: `builtin:sky` or the file's path.
    pub name: String,
    pub image: RgbImage,
    /// blake3 (hex) of the size and the pixels.
    pub hash: String,
    /// Odd but usable facts about the input (aspect ratio not 2:1, clamped texels ...), one sentence each.
    pub warnings: Vec<String>,
}
