//! Radiance pictures (`.hdr`, `.pic`) \[Ward94\].
//!
//! A texel has three mantissas and a shared exponent, `value = mantissa 2^(e - 136)`, 0 if `e = 0`.
//! (Radiance adds 0.5 to the mantissa; most software does not, and a stored 0 should stay 0.)
//! `EXPOSURE` and `COLORCORR`, which multiply, are divided out.
//!
//! Colours are Rec.709 unless PRIMARIES says otherwise. `32-bit_rle_xyze` is refused; `ra_xyze -r`
//! converts it.

mod header;
mod scanlines;

use super::file::{ENVIRONMENT_TEXELS_MAX, Fault, check_claim, filled};
use super::{Decoded, PixelsError, RgbImage};
use crate::base::color::{Chromaticities, RADIANCE, REC709, out_of_gamut};
use glam::{DMat3, DVec3};
use header::{Header, read_header};
use scanlines::{read_scanline, scanline_fault};
use std::path::Path;

/// The old run-length form holds up to 32767 equal texels in 12 bytes.
const MAX_TEXELS_PER_BYTE: u64 = 1 << 12;
/// 128 of the format, and 8 bits of mantissa.
const EXPONENT_BIAS: i32 = 136;

/// Decodes the file at `path` as linear Rec.709, row 0 at the top. There are no layers.
pub fn read_bytes(path: &Path, bytes: &[u8], layer: Option<&str>) -> Result<Decoded, PixelsError> {
    if let Some(name) = layer {
        return Err(Fault::new(
            format!("is asked for layer {name:?}"),
            "no layer: a Radiance picture has one image",
        )
        .in_file(path));
    }
    decode(bytes).map_err(|fault| fault.in_file(path))
}

/// Order of texels; the first axis of the resolution line is the slow one.
#[derive(Clone, Copy)]
struct Layout {
    width: usize,
    height: usize,
    columns_first: bool,
    flip_x: bool,
    flip_y: bool,
}

impl Layout {
    fn scanline_count(&self) -> usize {
        if self.columns_first {
            self.width
        } else {
            self.height
        }
    }

    fn scanline_length(&self) -> usize {
        if self.columns_first {
            self.height
        } else {
            self.width
        }
    }

    /// Returns the index in row-major order, from the top left, of a texel of a scanline.
    fn index(&self, scanline: usize, texel: usize) -> usize {
        let (x, y) = if self.columns_first {
            (scanline, texel)
        } else {
            (texel, scanline)
        };
        let x = if self.flip_x { self.width - 1 - x } else { x };
        let y = if self.flip_y { self.height - 1 - y } else { y };
        y * self.width + x
    }
}

fn decode(bytes: &[u8]) -> Result<Decoded, Fault> {
    let mut input = Input { rest: bytes };
    let header = read_header(&mut input)?;
    let layout = header.layout;
    check_claim(
        layout.width as u64,
        layout.height as u64,
        ENVIRONMENT_TEXELS_MAX,
        bytes.len(),
        MAX_TEXELS_PER_BYTE,
    )?;
    let mut warnings = Vec::new();
    let mut colors = Colors {
        exposure: header.exposure,
        to_rec709: conversion(&header, &mut warnings),
        out_of_gamut_count: 0,
    };
    let mut texels = filled(layout.width * layout.height, [0.0; 3])?;
    let mut scanline = vec![[0; 4]; layout.scanline_length()];
    for number in 0..layout.scanline_count() {
        read_scanline(&mut input, &mut scanline)
            .map_err(|fault| scanline_fault(fault, number, &layout))?;
        for (i, rgbe) in scanline.iter().enumerate() {
            texels[layout.index(number, i)] = colors.radiance(*rgbe);
        }
    }
    warnings.extend(out_of_gamut(colors.out_of_gamut_count));
    warnings.extend(header.warnings);
    let rgb = RgbImage::new(layout.width as u32, layout.height as u32, texels);
    Ok(Decoded::new(rgb, warnings))
}

/// Converts stored texels to radiance.
struct Colors {
    exposure: DVec3,
    to_rec709: Option<DMat3>,
    out_of_gamut_count: u64,
}

impl Colors {
    fn radiance(&mut self, [r, g, b, e]: [u8; 4]) -> [f32; 3] {
        if e == 0 {
            return [0.0; 3];
        }
        let mantissas = DVec3::new(r.into(), g.into(), b.into());
        let mut value = mantissas * 2f64.powi(i32::from(e) - EXPONENT_BIAS) / self.exposure;
        if let Some(to_rec709) = self.to_rec709 {
            value = to_rec709 * value;
            self.out_of_gamut_count += u64::from(value.min_element() < 0.0);
            // As Radiance does: radiance is not negative.
            value = value.max(DVec3::ZERO);
        }
        value.as_vec3().to_array()
    }
}

/// Returns the matrix to Rec.709, if one is needed.
fn conversion(header: &Header, warnings: &mut Vec<String>) -> Option<DMat3> {
    let is_foreign = |p: &Chromaticities| !p.is_close_to(&REC709) && !p.is_close_to(&RADIANCE);
    header
        .primaries
        .filter(is_foreign)?
        .to_rec709_with_warning("PRIMARIES", warnings)
}

/// The bytes of a file that are not read yet.
struct Input<'a> {
    rest: &'a [u8],
}

impl Input<'_> {
    /// Returns the next line without LF or CR LF; `None` if there is none.
    fn line(&mut self) -> Option<String> {
        let end = self.rest.iter().position(|&byte| byte == b'\n')?;
        let line = String::from_utf8_lossy(&self.rest[..end])
            .trim_end_matches('\r')
            .to_owned();
        self.rest = &self.rest[end + 1..];
        Some(line)
    }
}
