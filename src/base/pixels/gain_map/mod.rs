//! JPEG pictures with a gain map ("UltraHDR"), as linear radiance.
//!
//! A file has two pictures after each other: an sRGB picture for ordinary screens, and a map of
//! gains. With a gain g in \[0, 1\] of the map, per channel and in linear light,
//! `hdr = (sdr + offset_sdr) 2^(min + (max - min) g^(1/gamma)) - offset_hdr`.
//! [Google, "Ultra HDR Image Format v1.1"; ISO 21496-1]
//!
//! Eight bits and JPEG lose more than the other formats: a mean is right within some per cent.

mod icc;
mod metadata;
mod streams;

use super::file::{ENVIRONMENT_TEXELS_MAX, Fault, check_claim};
use super::lookup::{Wrap, bilinear};
use super::{Decoded, Pixels, PixelsError, Rgb8Image, RgbImage};
use crate::base::color::{out_of_gamut, srgb_decode};
use glam::{DVec2, DVec3};
use image::codecs::jpeg::JpegDecoder;
use image::{DynamicImage, ImageDecoder, ImageError};
use metadata::GainMap;
use std::io::Cursor;
use std::path::Path;
use streams::{Stream, streams};

/// Only absurd claims exceed it: progressive files code runs of equal blocks in a few bits.
const MAX_TEXELS_PER_BYTE: u64 = 1 << 14;

/// Decodes the file at `path` as linear Rec.709, row 0 at the top. There are no layers.
pub fn read_bytes(path: &Path, bytes: &[u8], layer: Option<&str>) -> Result<Decoded, PixelsError> {
    if let Some(name) = layer {
        return Err(Fault::new(
            format!("is asked for layer {name:?}"),
            "no layer: a JPEG picture has one image",
        )
        .in_file(path));
    }
    decode(bytes).map_err(|fault| fault.in_file(path))
}

fn decode(bytes: &[u8]) -> Result<Decoded, Fault> {
    let streams = streams(bytes);
    let picture = streams
        .first()
        .ok_or_else(|| Fault::new("is not a JPEG file", "a JPEG picture with a gain map"))?;
    let gains = streams[1..]
        .iter()
        .find_map(|stream| Some((stream, GainMap::of(stream)?)));
    let Some((gain_stream, parameters)) = gains else {
        return Err(Fault::new(
            "is a JPEG picture without a gain map",
            "radiance: a JPEG with a gain map (UltraHDR), OpenEXR or Radiance; a picture for screens \
             holds no light above its white",
        ));
    };
    let gain_map = parameters?;
    let mut warnings = Vec::new();
    let to_rec709 = icc::to_rec709(picture, &mut warnings);
    let gains = unpack(gain_stream)?;
    let sdr = unpack(picture)?;
    let mut out_of_gamut_count = 0;
    let mut rgb = apply(&sdr, &gains, &gain_map);
    if let Some(to_rec709) = to_rec709 {
        for texel in &mut rgb.data {
            let converted = to_rec709 * DVec3::from_array(texel.map(f64::from));
            out_of_gamut_count += u64::from(converted.min_element() < 0.0);
            *texel = converted.max(DVec3::ZERO).as_vec3().to_array();
        }
    }
    warnings.extend(out_of_gamut(out_of_gamut_count));
    Ok(Decoded::new(rgb, warnings))
}

fn unpack(stream: &Stream) -> Result<Rgb8Image, Fault> {
    let refuse = |error: ImageError| {
        Fault::new(
            format!("cannot be decoded ({error})"),
            "a whole JPEG file with a gain map",
        )
    };
    let decoder = JpegDecoder::new(Cursor::new(stream.bytes)).map_err(refuse)?;
    let (width, height) = decoder.dimensions();
    check_claim(
        width.into(),
        height.into(),
        ENVIRONMENT_TEXELS_MAX,
        stream.bytes.len(),
        MAX_TEXELS_PER_BYTE,
    )?;
    let samples = DynamicImage::from_decoder(decoder).map_err(refuse)?;
    let samples = samples.into_rgb8().into_raw();
    Ok(Pixels::new(width, height, samples.as_chunks().0.to_vec()))
}

/// Applies a gain map, which may be smaller than the picture: it is looked up bilinearly.
fn apply(sdr: &Rgb8Image, gains: &Rgb8Image, gain_map: &GainMap) -> RgbImage {
    let linear: Vec<f64> = (0..=u8::MAX)
        .map(|code| f64::from(srgb_decode(f32::from(code) / 255.0)))
        .collect();
    let size = DVec2::new(sdr.width.into(), sdr.height.into());
    RgbImage::from_fn(sdr.width, sdr.height, |x, y| {
        let uv = (DVec2::new(x.into(), y.into()) + 0.5) / size;
        let gain = bilinear(gains, uv, Wrap::EQUIRECT, |texel: [u8; 3]| {
            DVec3::from_array(texel.map(f64::from)) / 255.0
        });
        let sdr = sdr.get(x, y).map(|code| linear[usize::from(code)]);
        // Rounding of the dark codes may fall below 0.
        gain_map
            .radiance(DVec3::from_array(sdr), gain)
            .max(DVec3::ZERO)
            .as_vec3()
            .to_array()
    })
}
