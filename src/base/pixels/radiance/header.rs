//! The header of a Radiance picture: fields, then the resolution with the order of texels.

use super::super::file::Fault;
use super::{Input, Layout};
use crate::base::color::Chromaticities;
use glam::{DVec2, DVec3};

const FORMAT: &str = "32-bit_rle_rgbe";
const EXPECTED_FIRST_LINE: &str = "a Radiance picture, whose first line is #?RADIANCE or #?RGBE";
const EXPECTED_RESOLUTION: &str = "a resolution such as \"-Y 512 +X 1024\"";

pub(super) struct Header {
    /// Factor on the pixels, per channel.
    pub(super) exposure: DVec3,
    pub(super) primaries: Option<Chromaticities>,
    pub(super) layout: Layout,
    pub(super) warnings: Vec<String>,
}

pub(super) fn read_header(input: &mut Input) -> Result<Header, Fault> {
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
            "PIXASPECT" => {
                let aspect = value.trim();
                if aspect.parse() != Ok(1.0) {
                    self.warnings.push(format!(
                        "The pixel aspect ratio {} is ignored; pixels are taken as square.",
                        shorten(aspect)
                    ));
                }
                Ok(())
            }
            "VIEW" => {
                self.warnings.extend(other_view(value));
                Ok(())
            }
            "GAMMA" => {
                let gamma = value.trim();
                if gamma.parse() != Ok(1.0) {
                    self.warnings.push(format!(
                        "GAMMA is {:?}, which Radiance does not define; values were taken as \
                         linear.",
                        shorten(gamma)
                    ));
                }
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

/// Warns of a view of Radiance's programs, none of which is a lat-long map.
fn other_view(value: &str) -> Option<String> {
    let mut words = value.split_whitespace();
    let kind = words.find_map(|word| word.strip_prefix("-vt"))?;
    let name = match kind.chars().next()? {
        'v' => "a perspective view",
        'l' => "a parallel view",
        'a' => "an angular fisheye",
        'h' => "a hemispherical fisheye",
        's' => "a planisphere",
        _ => return None,
    };
    Some(format!(
        "The header's VIEW says that the picture is {name} (-vt{kind}); it was read as a lat-long map."
    ))
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
