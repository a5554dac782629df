//! 8-bit RGB PNG, sRGB-encoded: the display-referred pictures.

use super::file::{Fault, PICTURE_TEXELS_MAX, check_claim, read_bounded, reserved};
use super::{Decoded, Pixels, PixelsError, Rgb8Image, write_atomically};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, ExtendedColorType, ImageEncoder, ImageFormat, ImageReader};
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

/// The samples of the PNG in `bytes` over their largest, as they stand: no transfer curve is undone, since tables have none. Of two channels,
/// grey and alpha, both are kept; alpha beside colour is dropped.
pub fn read_linear(path: &Path, bytes: &[u8]) -> Result<Decoded, PixelsError> {
    let read = || {
        let whole = decoded(bytes)?;
        let (width, height) = (whole.width(), whole.height());
        let is_pair = whole.color().channel_count() == 2;
        let mut data = reserved(width as usize * height as usize)?;
        match whole {
            // Both depths keep their own largest value: 255 as 65535 is exact, by the factor 257.
            pair if is_pair => data.extend(pair.into_luma_alpha16().pixels().map(|p| [p.0[0], p.0[1], 0])),
            other => data.extend(other.into_rgb16().pixels().map(|p| p.0)),
        }
        let words = Pixels::<[u16; 3]>::new(width, height, data);
        let rgb = words.map(|texel| texel.map(|value| f32::from(value) / 65535.0));
        Ok(Decoded { rgb, alpha: None, warnings: Vec::new() })
    };
    read().map_err(|fault: Fault| fault.at(path))
}

fn decode(bytes: &[u8]) -> Result<Rgb8Image, Fault> {
    let decoded = decoded(bytes)?.into_rgb8();
    let mut data = reserved(decoded.as_raw().len() / 3)?;
    data.extend_from_slice(decoded.as_raw().as_chunks().0);
    Ok(Rgb8Image::new(decoded.width(), decoded.height(), data))
}

fn decoded(bytes: &[u8]) -> Result<DynamicImage, Fault> {
    let refuse = |error: image::ImageError| Fault::new(format!("cannot be decoded ({error})"), "a whole PNG file");
    let (width, height) =
        ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png).into_dimensions().map_err(refuse)?;
    check_claim(width.into(), height.into(), PICTURE_TEXELS_MAX, bytes.len(), MAX_TEXELS_PER_BYTE)?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    // The size was checked above; the default limit of the crate would refuse images that we allow.
    reader.no_limits();
    reader.decode().map_err(refuse)
}
