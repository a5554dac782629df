//! Radiance pictures (`.hdr`, `.pic`) \[Ward94\].
//!
//! A texel has three mantissas and a shared exponent, `value = mantissa 2^(e - 136)`, 0 if `e = 0`.
//! (Radiance adds 0.5 to the mantissa; most software does not, and a stored 0 should stay 0.)
//! `EXPOSURE` and `COLORCORR`, which multiply, are divided out.
//!
//! Colours are Rec.709 unless PRIMARIES says otherwise. `32-bit_rle_xyze` is refused; `ra_xyze -r`
//! converts it.
//!
//! Long because header fields, orders of texels and two run-length forms are one format.

use super::file::{ENVIRONMENT_TEXELS_MAX, Fault, check_claim, filled};
use super::{Decoded, PixelsError, RgbImage};
use crate::base::color::{Chromaticities, RADIANCE, REC709, out_of_gamut};
use glam::{DMat3, DVec2, DVec3};
use std::path::Path;

/// The old run-length form holds up to 32767 equal texels in 12 bytes.
const MAX_TEXELS_PER_BYTE: u64 = 1 << 12;
/// Scanline lengths with the newer run-length form.
const NEW_RLE_LENGTHS: std::ops::RangeInclusive<usize> = 8..=0x7fff;
const FORMAT: &str = "32-bit_rle_rgbe";
/// 128 of the format, and 8 bits of mantissa.
const EXPONENT_BIAS: i32 = 136;

/// Decodes the file at `path` as linear Rec.709, row 0 at the top. There are no layers.
pub fn read_bytes(path: &Path, bytes: &[u8], layer: Option<&str>) -> Result<Decoded, PixelsError> {
    if let Some(name) = layer {
        return Err(Fault::new(
            format!("is asked for layer {name:?}"),
            "no layer: a Radiance picture has one image",
        )
        .at(path));
    }
    decode(bytes).map_err(|fault| fault.at(path))
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

struct Header {
    /// Factor on the pixels, per channel.
    exposure: DVec3,
    primaries: Option<Chromaticities>,
    layout: Layout,
    warnings: Vec<String>,
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
    Ok(Decoded {
        rgb: RgbImage::new(layout.width as u32, layout.height as u32, texels),
        alpha: None,
        warnings,
    })
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

const EXPECTED_FIRST_LINE: &str = "a Radiance picture, whose first line is #?RADIANCE or #?RGBE";
const EXPECTED_RESOLUTION: &str = "a resolution such as \"-Y 512 +X 1024\"";

fn read_header(input: &mut Input) -> Result<Header, Fault> {
    let first = input
        .line()
        .ok_or_else(|| Fault::new("has no first line", EXPECTED_FIRST_LINE))?;
    // The word after the mark names the program; stitchers write their own.
    if !first.starts_with("#?") {
        return Err(Fault::new(
            format!("the first line is {:?}", shorten(&first)),
            EXPECTED_FIRST_LINE,
        ));
    }
    let mut fields = Fields::read(input)?;
    if !matches!(first.trim_end(), "#?RADIANCE" | "#?RGBE") {
        fields.warnings.push(format!(
            "The first line is {:?}, not #?RADIANCE; the file was read as a Radiance picture.",
            shorten(first.trim_end())
        ));
    }
    fields.warnings.extend(scaled(fields.exposure));
    let line = input
        .line()
        .ok_or_else(|| Fault::new("the file ends after the header", EXPECTED_RESOLUTION))?;
    let layout = parse_resolution(&line).ok_or_else(|| {
        Fault::new(
            format!("the resolution line is {:?}", shorten(&line)),
            EXPECTED_RESOLUTION,
        )
    })?;
    Ok(Header {
        exposure: fields.exposure,
        primaries: fields.primaries,
        layout,
        warnings: fields.warnings,
    })
}

/// The lines `NAME=VALUE` between the first line and the resolution.
struct Fields {
    /// Product of the factors.
    exposure: DVec3,
    primaries: Option<Chromaticities>,
    warnings: Vec<String>,
}

/// Warns of a factor that other programs do not divide out.
fn scaled(exposure: DVec3) -> Option<String> {
    if exposure == DVec3::ONE {
        return None;
    }
    let factor = if exposure == DVec3::splat(exposure.x) {
        exposure.x.to_string()
    } else {
        format!("{} {} {}", exposure.x, exposure.y, exposure.z)
    };
    Some(format!(
        "The light was divided by the header's exposure {factor}, as Radiance does; many programs \
         ignore it, so that their pictures differ by this factor."
    ))
}

impl Fields {
    /// Reads up to the blank line that ends them.
    fn read(input: &mut Input) -> Result<Self, Fault> {
        let mut fields = Self {
            exposure: DVec3::ONE,
            primaries: None,
            warnings: Vec::new(),
        };
        loop {
            let line = input.line().ok_or_else(|| {
                Fault::new(
                    "the header has no end",
                    format!("a blank line and then {EXPECTED_RESOLUTION}"),
                )
            })?;
            if line.trim().is_empty() {
                break;
            }
            if parse_resolution(&line).is_some() {
                let what = format!(
                    "the blank line before the resolution {:?} is missing",
                    line.trim()
                );
                return Err(Fault::new(what, "a blank line that ends the header"));
            }
            fields.add(&line)?;
        }
        let exposure = fields.exposure;
        if !(exposure.is_finite() && exposure.min_element() > 0.0) {
            return Err(Fault::new(
                format!("EXPOSURE and COLORCORR multiply to {exposure}"),
                "finite products above 0",
            ));
        }
        Ok(fields)
    }

    /// Adds a line. Unknown and indented lines are ignored; the latter are copied from a program's
    /// input.
    fn add(&mut self, line: &str) -> Result<(), Fault> {
        let Some((name, value)) = line.split_once('=') else {
            return Ok(());
        };
        match name {
            "FORMAT" if value.trim() != FORMAT => Err(Fault::new(
                format!("FORMAT is {:?}", shorten(value.trim())),
                format!("{FORMAT}; `ra_xyze -r` converts XYZE"),
            )),
            "EXPOSURE" => self.add_exposure(value),
            "COLORCORR" => {
                self.exposure *= DVec3::from(factors::<3>(name, value)?);
                Ok(())
            }
            "PRIMARIES" => {
                self.primaries = parse_primaries(value)?;
                Ok(())
            }
            _ => Ok(()),
        }
    }
}

impl Fields {
    /// Multiplies by an exposure. Some programs write 0 or nothing for "not exposed", or a comment
    /// behind the number.
    fn add_exposure(&mut self, text: &str) -> Result<(), Fault> {
        let first_word = text.split_whitespace().next().unwrap_or_default();
        let number = first_word.parse::<f64>().ok();
        if first_word.is_empty() || number == Some(0.0) {
            self.warnings.push(format!(
                "EXPOSURE is {:?}; it is ignored.",
                shorten(text.trim())
            ));
            return Ok(());
        }
        if first_word != text.trim() {
            self.warnings.push(format!(
                "EXPOSURE is {:?}; {first_word} was used.",
                shorten(text.trim())
            ));
        }
        self.exposure *= DVec3::splat(factors::<1>("EXPOSURE", first_word)?[0]);
        Ok(())
    }
}

fn factors<const N: usize>(name: &str, text: &str) -> Result<[f64; N], Fault> {
    let expected = if N == 1 {
        "a number above 0".to_owned()
    } else {
        format!("{N} numbers above 0")
    };
    let fault = || {
        Fault::new(
            format!("{name} is {:?}", shorten(text.trim())),
            expected.as_str(),
        )
    };
    let numbers = numbers(text).ok_or_else(fault)?;
    let numbers: [f64; N] = numbers.try_into().map_err(|_| fault())?;
    if numbers
        .iter()
        .all(|number| number.is_finite() && *number > 0.0)
    {
        Ok(numbers)
    } else {
        Err(fault())
    }
}

/// Parses x and y of red, green, blue and white; all zeros mean none.
fn parse_primaries(text: &str) -> Result<Option<Chromaticities>, Fault> {
    let numbers: Option<[f64; 8]> = numbers(text).and_then(|numbers| numbers.try_into().ok());
    let [rx, ry, gx, gy, bx, by, wx, wy] = numbers.ok_or_else(|| {
        Fault::new(
            format!("PRIMARIES is {:?}", shorten(text.trim())),
            "eight chromaticity coordinates",
        )
    })?;
    let chromaticities = Chromaticities {
        red: DVec2::new(rx, ry),
        green: DVec2::new(gx, gy),
        blue: DVec2::new(bx, by),
        white: DVec2::new(wx, wy),
    };
    let is_present = [rx, ry, gx, gy, bx, by, wx, wy].iter().any(|x| *x != 0.0);
    Ok(is_present.then_some(chromaticities))
}

fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split_whitespace()
        .map(|word| word.parse().ok())
        .collect()
}

/// Parses `-Y 512 +X 1024` and the other seven orders. `-Y` counts downwards, `+X` to the right.
fn parse_resolution(line: &str) -> Option<Layout> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let &[axis_1, count_1, axis_2, count_2] = words.as_slice() else {
        return None;
    };
    let count_1 = count_1.parse::<u32>().ok()? as usize;
    let count_2 = count_2.parse::<u32>().ok()? as usize;
    let (columns_first, x, y) = match (axis_1, axis_2) {
        ("+Y" | "-Y", "+X" | "-X") => (false, axis_2, axis_1),
        ("+X" | "-X", "+Y" | "-Y") => (true, axis_1, axis_2),
        _ => return None,
    };
    let (width, height) = if columns_first {
        (count_1, count_2)
    } else {
        (count_2, count_1)
    };
    Some(Layout {
        width,
        height,
        columns_first,
        flip_x: x == "-X",
        flip_y: y == "+Y",
    })
}

/// Shortens an unknown line for a message.
fn shorten(text: &str) -> String {
    const LONGEST: usize = 60;
    text.chars().take(LONGEST).collect()
}

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

    /// Takes the next bytes of a scanline.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], ScanlineFault> {
        let (&head, rest) = self.rest.split_first_chunk().ok_or(ScanlineFault::Ends)?;
        self.rest = rest;
        Ok(head)
    }
}

/// Why a scanline cannot be read.
enum ScanlineFault {
    /// The file ends in it.
    Ends,
    Damaged(String),
}

/// Reports the fault of the scanline with that number, from 0.
fn scanline_fault(fault: ScanlineFault, number: usize, layout: &Layout) -> Fault {
    let count = layout.scanline_count();
    let what = match fault {
        ScanlineFault::Ends => format!("the file ends within scanline {number} of {count}"),
        ScanlineFault::Damaged(what) => format!("scanline {number} of {count}: {what}"),
    };
    let length = layout.scanline_length();
    Fault::new(
        what,
        format!("{count} scanlines of {length} texels, flat or run-length coded"),
    )
}

fn read_scanline(input: &mut Input, scanline: &mut [[u8; 4]]) -> Result<(), ScanlineFault> {
    match input.rest {
        // In the old form (2, 2) has a blue mantissa of at least 128: one of three mantissas is.
        [2, 2, high, low, ..] if *high < 128 && NEW_RLE_LENGTHS.contains(&scanline.len()) => {
            let length = usize::from(u16::from_be_bytes([*high, *low]));
            if length != scanline.len() {
                return Err(ScanlineFault::Damaged(format!(
                    "it claims {length} texels, not {}",
                    scanline.len()
                )));
            }
            input.rest = &input.rest[4..];
            (0..4).try_for_each(|channel| read_channel(input, scanline, channel))
        }
        _ => read_flat(input, scanline),
    }
}

/// Reads one channel of the newer form: counts above 128 repeat a byte `count - 128` times, others
/// copy bytes.
fn read_channel(
    input: &mut Input,
    scanline: &mut [[u8; 4]],
    channel: usize,
) -> Result<(), ScanlineFault> {
    let mut x = 0;
    while x < scanline.len() {
        let [count] = input.take()?;
        let is_run = count > 128;
        let length = usize::from(if is_run { count - 128 } else { count });
        if length == 0 {
            return Err(ScanlineFault::Damaged(format!(
                "a run of length 0 at texel {x}"
            )));
        }
        if length > scanline.len() - x {
            return Err(ScanlineFault::Damaged(format!(
                "a run of length {length} at texel {x} passes the end"
            )));
        }
        let texels = &mut scanline[x..x + length];
        if is_run {
            let [repeated] = input.take()?;
            texels
                .iter_mut()
                .for_each(|texel| texel[channel] = repeated);
        } else {
            for texel in texels {
                let [value] = input.take()?;
                texel[channel] = value;
            }
        }
        x += length;
    }
    Ok(())
}

/// Reads flat texels. In the old run-length form (1, 1, 1, n) repeats the texel before n times;
/// consecutive runs are digits of base 256.
fn read_flat(input: &mut Input, scanline: &mut [[u8; 4]]) -> Result<(), ScanlineFault> {
    let mut x = 0;
    let mut shift = 0;
    while x < scanline.len() {
        let texel: [u8; 4] = input.take()?;
        if texel[..3] != [1, 1, 1] {
            scanline[x] = texel;
            x += 1;
            shift = 0;
            continue;
        }
        // 0 is a digit of a longer run.
        let length = usize::from(texel[3]) << shift;
        if x == 0 || length > scanline.len() - x {
            return Err(ScanlineFault::Damaged(format!(
                "a run of length {length} at texel {x} repeats nothing or passes the end"
            )));
        }
        let previous = scanline[x - 1];
        scanline[x..x + length].fill(previous);
        x += length;
        // A length over 2^24 exceeds every plausible scanline.
        shift = (shift + 8).min(24);
    }
    Ok(())
}
