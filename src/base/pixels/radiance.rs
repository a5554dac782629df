//! Radiance pictures (`.hdr`, `.pic`) \[Ward94\].
//!
//! A texel has three mantissas and a shared exponent, `value = mantissa 2^(e - 136)`, 0 if `e = 0`.
//! (Radiance adds 0.5 to the mantissa; most software does not, and a stored 0 should stay 0.)
//! `EXPOSURE` and `COLORCORR`, which multiply, are divided out.
//!
//! Colours are Rec.709 unless PRIMARIES says otherwise. `32-bit_rle_xyze` is refused; `ra_xyze -r`
//! converts it.

use super::file::{ENVIRONMENT_TEXELS_MAX, Fault, check_claim, filled};
use super::{Decoded, PixelsError, RgbImage};
use crate::base::color::{Chromaticities, RADIANCE, REC709};
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

struct Header {
    /// Factor on the pixels, per channel.
    exposure: DVec3,
    primaries: Option<Chromaticities>,
    layout: Layout,
}

fn decode(bytes: &[u8]) -> Result<Decoded, Fault> {
    let mut input = Input { rest: bytes };
    let header = read_header(&mut input)?;
    let Layout {
        width,
        height,
        columns_first,
        flip_x,
        flip_y,
    } = header.layout;
    check_claim(
        width as u64,
        height as u64,
        ENVIRONMENT_TEXELS_MAX,
        bytes.len(),
        MAX_TEXELS_PER_BYTE,
    )?;

    let mut warnings = Vec::new();
    let to_rgb = conversion(&header, &mut warnings);
    let mut out_of_gamut = 0u64;
    let mut image = RgbImage::new(
        width as u32,
        height as u32,
        filled(width * height, [0.0; 3])?,
    );
    let (slow, fast) = if columns_first {
        (width, height)
    } else {
        (height, width)
    };
    let mut scanline = vec![[0u8; 4]; fast];
    for s in 0..slow {
        read_scanline(&mut input, &mut scanline).map_err(|problem| {
            let what = match problem {
                None => format!("the file ends within scanline {s} of {slow}"),
                Some(problem) => format!("scanline {s} of {slow}: {problem}"),
            };
            Fault::new(
                what,
                format!("{slow} scanlines of {fast} texels, flat or run-length coded"),
            )
        })?;
        for (f, &[r, g, b, e]) in scanline.iter().enumerate() {
            let (x, y) = if columns_first { (s, f) } else { (f, s) };
            let x = if flip_x { width - 1 - x } else { x };
            let y = if flip_y { height - 1 - y } else { y };
            if e == 0 {
                continue;
            }
            let mantissas = DVec3::new(r.into(), g.into(), b.into());
            let mut value = mantissas * 2f64.powi(i32::from(e) - EXPONENT_BIAS) / header.exposure;
            if let Some(to_rgb) = to_rgb {
                value = to_rgb * value;
                out_of_gamut += u64::from(value.min_element() < 0.0);
                // As Radiance does: radiance is not negative.
                value = value.max(DVec3::ZERO);
            }
            image.data[y * width + x] = value.as_vec3().to_array();
        }
    }
    if out_of_gamut > 0 {
        warnings.push(format!(
            "{out_of_gamut} texels lie outside Rec.709; their negative channels were set to 0."
        ));
    }
    Ok(Decoded {
        rgb: image,
        alpha: None,
        warnings,
    })
}

/// Returns the matrix to Rec.709, if one is needed.
fn conversion(header: &Header, warnings: &mut Vec<String>) -> Option<DMat3> {
    let is_foreign = |p: &Chromaticities| !p.is_close_to(&REC709) && !p.is_close_to(&RADIANCE);
    header
        .primaries
        .filter(is_foreign)?
        .to_rec709_with_warning("PRIMARIES", warnings)
}

fn read_header(input: &mut Input) -> Result<Header, Fault> {
    let magic = || "a Radiance picture, whose first line is #?RADIANCE or #?RGBE";
    let first = input
        .line()
        .ok_or_else(|| Fault::new("has no first line", magic()))?;
    if !matches!(first.trim_end(), "#?RADIANCE" | "#?RGBE") {
        return Err(Fault::new(
            format!("the first line is {:?}", shorten(&first)),
            magic(),
        ));
    }
    let (mut exposure, mut primaries) = (DVec3::ONE, None);
    loop {
        let end = || {
            Fault::new(
                "the header has no end",
                "a blank line and then a resolution such as \"-Y 512 +X 1024\"",
            )
        };
        let line = input.line().ok_or_else(end)?;
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
        // Ignores unknown and indented lines; the latter are copied from a program's input.
        if let Some(value) = line.strip_prefix("FORMAT=") {
            if value.trim() != FORMAT {
                let what = format!("FORMAT is {:?}", shorten(value.trim()));
                return Err(Fault::new(
                    what,
                    format!("{FORMAT}; `ra_xyze -r` converts XYZE"),
                ));
            }
        } else if let Some(value) = line.strip_prefix("EXPOSURE=") {
            exposure *= DVec3::splat(factors::<1>("EXPOSURE", value)?[0]);
        } else if let Some(value) = line.strip_prefix("COLORCORR=") {
            exposure *= DVec3::from(factors::<3>("COLORCORR", value)?);
        } else if let Some(value) = line.strip_prefix("PRIMARIES=") {
            primaries = parse_primaries(value)?;
        }
    }
    if !(exposure.is_finite() && exposure.min_element() > 0.0) {
        return Err(Fault::new(
            format!("EXPOSURE and COLORCORR multiply to {exposure}"),
            "finite products above 0",
        ));
    }
    let resolution = "a resolution such as \"-Y 512 +X 1024\"";
    let line = input
        .line()
        .ok_or_else(|| Fault::new("the file ends after the header", resolution))?;
    let layout = parse_resolution(&line).ok_or_else(|| {
        Fault::new(
            format!("the resolution line is {:?}", shorten(&line)),
            resolution,
        )
    })?;
    Ok(Header {
        exposure,
        primaries,
        layout,
    })
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
    let [red, green, blue, white] = [
        DVec2::new(rx, ry),
        DVec2::new(gx, gy),
        DVec2::new(bx, by),
        DVec2::new(wx, wy),
    ];
    let given = [red, green, blue, white]
        .iter()
        .any(|xy| *xy != DVec2::ZERO);
    Ok(given.then_some(Chromaticities {
        red,
        green,
        blue,
        white,
    }))
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
    let (count_1, count_2) = (
        count_1.parse::<u32>().ok()? as usize,
        count_2.parse::<u32>().ok()? as usize,
    );
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

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (&head, rest) = self.rest.split_first_chunk()?;
        self.rest = rest;
        Some(head)
    }
}

/// Fault of a scanline; `None` if the file ends in it.
type ScanlineProblem = Option<String>;

fn read_scanline(input: &mut Input, scanline: &mut [[u8; 4]]) -> Result<(), ScanlineProblem> {
    match input.rest {
        // In the old form (2, 2) has a blue mantissa of at least 128: one of three mantissas is.
        [2, 2, high, low, ..] if *high < 128 && NEW_RLE_LENGTHS.contains(&scanline.len()) => {
            let length = usize::from(u16::from_be_bytes([*high, *low]));
            if length != scanline.len() {
                return Err(Some(format!(
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
) -> Result<(), ScanlineProblem> {
    let mut x = 0;
    while x < scanline.len() {
        let [count] = input.take().ok_or(None)?;
        let (run, length) = if count > 128 {
            (true, usize::from(count - 128))
        } else {
            (false, usize::from(count))
        };
        if length == 0 {
            return Err(Some(format!("a run of length 0 at texel {x}")));
        }
        if length > scanline.len() - x {
            return Err(Some(format!(
                "a run of length {length} at texel {x} passes the end"
            )));
        }
        let repeated = if run {
            input.take::<1>().ok_or(None)?[0]
        } else {
            0
        };
        for texel in &mut scanline[x..x + length] {
            texel[channel] = if run {
                repeated
            } else {
                input.take::<1>().ok_or(None)?[0]
            };
        }
        x += length;
    }
    Ok(())
}

/// Reads flat texels. In the old run-length form (1, 1, 1, n) repeats the texel before n times;
/// consecutive runs are digits of base 256.
fn read_flat(input: &mut Input, scanline: &mut [[u8; 4]]) -> Result<(), ScanlineProblem> {
    let (mut x, mut shift) = (0, 0);
    while x < scanline.len() {
        let texel: [u8; 4] = input.take().ok_or(None)?;
        if texel[..3] != [1, 1, 1] {
            scanline[x] = texel;
            x += 1;
            shift = 0;
            continue;
        }
        // 0 is a digit of a longer run.
        let length = usize::from(texel[3]) << shift;
        if x == 0 || length > scanline.len() - x {
            return Err(Some(format!(
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
