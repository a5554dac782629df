//! 8-bit RGB PNG, sRGB-encoded: the display-referred pictures.

use super::file::{Fault, PICTURE_TEXELS_MAX, check_claim, read_bounded, reserved};
use super::{PixelsError, Rgb8Image, write_atomically};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageFormat, ImageReader};
use std::io::{self, Cursor};
use std::path::Path;

/// Deflate expands at most 1032 times and a texel takes at least one bit.
const MAX_TEXELS_PER_BYTE: u64 = 1 << 14;

/// Writes `image` (already sRGB-encoded) to `path` in one step.
pub fn write_rgb8(path: &Path, image: &Rgb8Image) -> Result<(), PixelsError> {
    write_atomically(path, |writer| {
        PngEncoder::new(writer)
            .write_image(image.data.as_flattened(), image.width, image.height, ExtendedColorType::Rgb8)
            .map_err(io::Error::other)
    })
}

/// The bytes of a PNG file of `image` (already sRGB-encoded), as few as the encoder can make.
pub fn encode_rgb8(image: &Rgb8Image) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive)
        .write_image(image.data.as_flattened(), image.width, image.height, ExtendedColorType::Rgb8)
        .map_err(io::Error::other)?;
    Ok(bytes)
}

/// Reads any PNG as 8-bit RGB; alpha is dropped, 16-bit samples are rounded.
pub fn read_rgb8(path: &Path) -> Result<Rgb8Image, PixelsError> {
    let bytes = read_bounded(path)?;
    decode(&bytes).map_err(|fault| fault.at(path))
}

fn decode(bytes: &[u8]) -> Result<Rgb8Image, Fault> {
    let refuse = |error: image::ImageError| Fault::new(format!("cannot be decoded ({error})"), "a whole PNG file");
    let (width, height) =
        ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png).into_dimensions().map_err(refuse)?;
    check_claim(width.into(), height.into(), PICTURE_TEXELS_MAX, bytes.len(), MAX_TEXELS_PER_BYTE)?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    // The size was checked above; the default limit of the crate would refuse images that we allow.
    reader.no_limits();
    let decoded = reader.decode().map_err(refuse)?.into_rgb8();
    let mut data = reserved(decoded.as_raw().len() / 3)?;
    data.extend_from_slice(decoded.as_raw().as_chunks().0);
    Ok(Rgb8Image::new(width, height, data))
}
