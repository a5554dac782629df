//! WebP pictures of 8 bits and four channels, lossless or lossy.

use super::Pixels;
use super::file::Fault;

/// Whether a file begins as WebP does.
pub(crate) fn is_webp(bytes: &[u8]) -> bool {
    bytes.get(..4) == Some(b"RIFF") && bytes.get(8..12) == Some(b"WEBP")
}

/// Decodes a picture; one without alpha is opaque.
#[cfg(feature = "gpu")]
pub(crate) fn decode_rgba8(bytes: &[u8]) -> Result<Pixels<[u8; 4]>, Fault> {
    use super::file::{PICTURE_TEXELS_MAX, check_claim};
    use image::codecs::webp::WebPDecoder;
    use image::{DynamicImage, ImageDecoder, ImageError};
    use std::io::Cursor;

    /// Only absurd claims exceed it: runs of equal blocks take a few bits.
    const MAX_TEXELS_PER_BYTE: u64 = 1 << 20;

    let refuse =
        |error: ImageError| Fault::new(format!("cannot be decoded ({error})"), "a whole WebP file");
    let decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(refuse)?;
    let (width, height) = decoder.dimensions();
    check_claim(
        width.into(),
        height.into(),
        PICTURE_TEXELS_MAX,
        bytes.len(),
        MAX_TEXELS_PER_BYTE,
    )?;
    let samples = DynamicImage::from_decoder(decoder).map_err(refuse)?;
    let samples = samples.into_rgba8().into_raw();
    Ok(Pixels::new(width, height, samples.as_chunks().0.to_vec()))
}

/// Refuses every picture.
#[cfg(not(feature = "gpu"))]
pub(crate) fn decode_rgba8(_bytes: &[u8]) -> Result<Pixels<[u8; 4]>, Fault> {
    Err(Fault::new(
        "is WebP, which this build of splitsum does not support",
        "the feature `gpu`",
    ))
}
