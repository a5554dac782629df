//! OpenEXR: linear f32 images with layers.

mod write;

use crate::pixels::{Decoded, PixelsError};
pub use write::{write_channels, write_rgba};
pub fn read(_path: &std::path::Path) -> Result<Decoded, PixelsError> {
    Ok(Decoded { rgb: super::RgbImage::filled(1, 1, [0.0; 3]), alpha: None, warnings: vec![] })
}
