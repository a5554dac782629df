//! Replaces OpenEXR in a build without the feature `exr`: every call fails.

use super::{Content, Decoded, Fault, GrayImage, PixelsError, RgbImage};
use std::path::Path;

pub const IS_BUILT: bool = false;

fn refused<T>(path: &Path) -> Result<T, PixelsError> {
    Err(Fault::new(
        "is OpenEXR, which this build of splitsum does not support",
        "the feature `exr` or `gpu`",
    )
    .in_file(path))
}

pub fn read_bytes(
    path: &Path,
    _bytes: &[u8],
    _layer: Option<&str>,
) -> Result<Decoded, PixelsError> {
    refused(path)
}

pub fn write_rgba(
    path: &Path,
    _rgb: &RgbImage,
    _alpha: &GrayImage,
    _layers: &[(&str, &RgbImage)],
) -> Result<(), PixelsError> {
    refused(path)
}

pub fn write_channels(
    path: &Path,
    _content: Content,
    _channels: Vec<(String, GrayImage)>,
) -> Result<(), PixelsError> {
    refused(path)
}
