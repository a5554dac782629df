//! PNG: 8-bit RGB pictures, and tables.

use super::file::{Fault, PICTURE_TEXELS_MAX, check_claim, reserved};
use super::{Content, Decoded, Pixels, PixelsError, Rgb8Image, write_atomically};
use png::{
    BitDepth, ColorType, Compression, Decoder, DecodingError, Encoder, Limits, Transformations,
};
use std::io::{self, Cursor, Write};
use std::path::Path;

/// Deflate expands at most 1032 times and a texel takes at least one bit.
const MAX_TEXELS_PER_BYTE: u64 = 1 << 14;

pub fn write_rgb8(path: &Path, image: &Rgb8Image) -> Result<(), PixelsError> {
    write_atomically(path, |writer| encode(writer, image, Compression::Fast))
}

/// Encodes a picture as small as possible.
pub fn encode_rgb8(image: &Rgb8Image) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode(&mut bytes, image, Compression::High)?;
    Ok(bytes)
}

fn encode(to: impl Write, image: &Rgb8Image, compression: Compression) -> io::Result<()> {
    let mut encoder = Encoder::new(to, image.width, image.height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(compression);
    encoder.set_filter(png::Filter::Adaptive);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(image.data.as_flattened())?;
    Ok(writer.finish()?)
}

/// Encodes a picture of four channels losslessly.
pub(crate) fn encode_rgba8(image: &Pixels<[u8; 4]>) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, image.width, image.height);
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::High);
    encoder.set_filter(png::Filter::Adaptive);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(image.data.as_flattened())?;
    writer.finish()?;
    Ok(bytes)
}

/// Decodes a picture of 8 bits and four channels.
pub(crate) fn decode_rgba8(bytes: &[u8]) -> Result<Pixels<[u8; 4]>, Fault> {
    let raw = decode_raw(bytes)?;
    if (raw.color, raw.depth) != (ColorType::Rgba, BitDepth::Eight) {
        return Err(Fault::new(
            format!("it has {:?} samples of {:?} bits", raw.color, raw.depth),
            "four channels of 8 bits",
        ));
    }
    let data = raw.samples.as_chunks::<4>().0.to_vec();
    Ok(Pixels::new(raw.width, raw.height, data))
}

/// Samples as a file has them, palettes and bits expanded.
struct Raw {
    width: u32,
    height: u32,
    color: ColorType,
    depth: BitDepth,
    samples: Vec<u8>,
}

/// Decodes samples as fractions of their maximum, without a transfer curve. Keeps grey and alpha as
/// two channels; drops alpha beside colour.
pub fn read_linear(path: &Path, bytes: &[u8]) -> Result<Decoded, PixelsError> {
    let samples = decode(bytes).map_err(|fault| fault.in_file(path))?;
    let rgb = samples.map(|texel| texel.map(|value| f32::from(value) / 65535.0));
    Ok(Decoded {
        content: Content::Data,
        ..Decoded::new(rgb, Vec::new())
    })
}

/// Decodes samples of 16 bits: three channels of each texel without alpha. Grey becomes three equal
/// channels; grey and alpha stay the first two.
fn decode(bytes: &[u8]) -> Result<Pixels<[u16; 3]>, Fault> {
    let Raw {
        width,
        height,
        color,
        depth,
        samples: raw,
    } = decode_raw(bytes)?;
    let words: Vec<u16> = match depth {
        BitDepth::Sixteen => raw
            .as_chunks()
            .0
            .iter()
            .map(|word| u16::from_be_bytes(*word))
            .collect(),
        _ => raw.iter().map(|byte| 257 * u16::from(*byte)).collect(),
    };
    let texel = |texel: &[u16]| match texel {
        [grey, alpha] => [*grey, *alpha, 0],
        [grey] => [*grey; 3],
        texel => [texel[0], texel[1], texel[2]],
    };
    let mut data = reserved(width as usize * height as usize)?;
    data.extend(words.chunks_exact(color.samples()).map(texel));
    Ok(Pixels::new(width, height, data))
}

fn decode_raw(bytes: &[u8]) -> Result<Raw, Fault> {
    let refuse = |error: DecodingError| {
        Fault::new(format!("cannot be decoded ({error})"), "a whole PNG file")
    };
    // The crate's default limit would refuse valid sizes; the claim is checked below.
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: usize::MAX });
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(Transformations::EXPAND);
    let (width, height) = decoder.read_header_info().map_err(refuse)?.size();
    check_claim(
        width.into(),
        height.into(),
        PICTURE_TEXELS_MAX,
        bytes.len(),
        MAX_TEXELS_PER_BYTE,
    )?;
    let mut reader = decoder.read_info().map_err(refuse)?;
    let (color, depth) = reader.output_color_type();
    let size = reader
        .output_buffer_size()
        .ok_or_else(|| Fault::new("is too large for memory", "a smaller PNG file"))?;
    let mut raw = reserved(size)?;
    raw.resize(size, 0);
    reader.next_frame(&mut raw).map_err(refuse)?;
    Ok(Raw {
        width,
        height,
        color,
        depth,
        samples: raw,
    })
}
