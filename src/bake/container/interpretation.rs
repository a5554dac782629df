//! What a header says of its texels beside their format: colours, alpha, order of channels and
//! direction of rows.

use super::Texture;
use crate::base::color::{
    ACES_AP0, ACES_AP1, ADOBE_RGB, Chromaticities, DISPLAY_P3, REC709, REC2020, srgb_decode,
    xyz_to_rec709,
};
use crate::base::pixels::{Fault, Pixels, RgbImage};
use glam::{DMat3, DVec3};

/// Where a channel comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ChannelSource {
    /// Red is 0.
    Stored(usize),
    Zero,
    One,
}

/// How stored texels become linear Rec.709 in rows from the top.
#[derive(Clone, Debug, Default)]
pub struct Interpretation {
    /// Sources of red, green, blue and alpha; `None` as stored.
    swizzle: Option<[ChannelSource; 4]>,
    is_premultiplied: bool,
    is_srgb: bool,
    to_rec709: Option<DMat3>,
    /// Whether columns run from right to left, and rows from bottom to top.
    is_mirrored: bool,
    is_bottom_up: bool,
    /// One sentence for each conversion that other readers may not make.
    warnings: Vec<String>,
}

impl Interpretation {
    /// Reads the keys `KTXorientation` and `KTXswizzle` of a KTX file. A value that no
    /// specification defines has no effect but a warning.
    pub fn of_keys(keys: &[(String, String)]) -> Self {
        let mut found = Self::default();
        let value = |name: &str| {
            let mut named = keys.iter().filter(|(key, _)| key == name);
            named.next().map(|(_, value)| value.as_str())
        };
        if let Some(text) = value("KTXorientation") {
            found.orient(text);
        }
        if let Some(text) = value("KTXswizzle").filter(|text| *text != "rgba") {
            found.swizzle = swizzle(text);
            found.warnings.push(match found.swizzle {
                Some(_) => format!("the channels were reordered as KTXswizzle says, {text:?}"),
                None => format!("KTXswizzle is {text:?}, not four of r, g, b, a, 0 and 1; ignored"),
            });
        }
        found
    }

    /// Takes `rd` of KTX 2, or `S=r,T=d` of KTX 1.
    fn orient(&mut self, text: &str) {
        let directions: Vec<char> = text
            .split(',')
            .flat_map(|part| match part.split_once('=') {
                Some((_, direction)) => direction.chars().collect::<Vec<_>>(),
                None => part.chars().collect(),
            })
            .collect();
        self.is_mirrored = directions.first() == Some(&'l');
        self.is_bottom_up = directions.get(1) == Some(&'u');
        let is_known = matches!(directions.first(), Some('r' | 'l'))
            && matches!(directions.get(1), Some('d' | 'u'));
        if !is_known {
            self.warnings
                .push(format!("KTXorientation is {text:?}, not rd or ru; ignored"));
        } else if self.is_mirrored || self.is_bottom_up {
            self.warnings.push(format!(
                "every image was turned as KTXorientation says, {text:?}"
            ));
        }
    }

    /// Takes the colours of a data format descriptor by its codes. Refuses transfer functions
    /// that are not converted.
    pub fn take_descriptor(
        &mut self,
        [_, primaries, transfer, flags]: [u8; 4],
    ) -> Result<(), Fault> {
        match transfer {
            UNSPECIFIED | LINEAR => {}
            SRGB => {
                self.is_srgb = true;
                self.warnings
                    .push("the values were decoded from sRGB, its transfer function".to_owned());
            }
            code => {
                let name = TRANSFERS.get(usize::from(code)).unwrap_or(&"unknown");
                return Err(Fault::new(
                    format!("its transfer function is {name} (code {code})"),
                    "linear values (`ktx create --assign-tf linear`)",
                ));
            }
        }
        match PRIMARIES.iter().find(|known| known.code == primaries) {
            None if primaries != UNSPECIFIED => self.warnings.push(format!(
                "its primaries have the code {primaries}, which is not known; taken as Rec.709"
            )),
            None => {}
            Some(known) => {
                self.to_rec709 = known.to_rec709();
                if self.to_rec709.is_some() {
                    self.warnings.push(format!(
                        "the colours were converted from its primaries, {}, to Rec.709; channels \
                         below 0 by that were set to 0",
                        known.name
                    ));
                }
            }
        }
        if flags & PREMULTIPLIED != 0 {
            self.take_premultiplied();
        }
        Ok(())
    }

    /// Adds a warning: one sentence about the file.
    pub fn warn_of(&mut self, sentence: &str) {
        self.warnings.push(sentence.to_owned());
    }

    /// Divides colours by alpha.
    pub fn take_premultiplied(&mut self) {
        self.is_premultiplied = true;
        self.warnings
            .push("the colours are premultiplied; they were divided by alpha".to_owned());
    }

    /// Returns the colour of a stored texel.
    pub fn color(&self, stored: [f32; 4]) -> [f32; 3] {
        let [r, g, b, alpha] = match self.swizzle {
            None => stored,
            Some(sources) => sources.map(|source| match source {
                ChannelSource::Stored(channel) => stored[channel],
                ChannelSource::Zero => 0.0,
                ChannelSource::One => 1.0,
            }),
        };
        let mut rgb = [r, g, b];
        if self.is_premultiplied && alpha > 0.0 {
            rgb = rgb.map(|value| value / alpha);
        }
        if self.is_srgb {
            rgb = rgb.map(srgb_decode);
        }
        match self.to_rec709 {
            None => rgb,
            Some(matrix) => {
                let converted = matrix * DVec3::from_array(rgb.map(f64::from));
                // Colours outside Rec.709, as in every other format.
                let is_color = rgb.iter().all(|value| *value >= 0.0);
                let least = if is_color { 0.0 } else { f64::NEG_INFINITY };
                converted.max(DVec3::splat(least)).as_vec3().to_array()
            }
        }
    }

    /// Turns an image so that its first row is the top one.
    pub fn turned(&self, image: RgbImage) -> RgbImage {
        if !self.is_mirrored && !self.is_bottom_up {
            return image;
        }
        let Pixels { width, height, .. } = image;
        let at = |is_turned: bool, index: u32, size: u32| {
            if is_turned { size - 1 - index } else { index }
        };
        RgbImage::from_fn(width, height, |x, y| {
            image.get(
                at(self.is_mirrored, x, width),
                at(self.is_bottom_up, y, height),
            )
        })
    }

    /// Adds the warnings to a texture.
    pub fn warn(self, texture: Texture) -> Texture {
        Texture {
            warnings: self.warnings,
            ..texture
        }
    }
}

fn swizzle(text: &str) -> Option<[ChannelSource; 4]> {
    let source = |letter: char| {
        Some(match letter {
            '0' => ChannelSource::Zero,
            '1' => ChannelSource::One,
            letter => ChannelSource::Stored("rgba".find(letter)?),
        })
    };
    let sources: Option<Vec<ChannelSource>> = text.chars().map(source).collect();
    sources?.try_into().ok()
}

/// Codes of the Khronos Data Format, section 5.
const UNSPECIFIED: u8 = 0;
const LINEAR: u8 = 1;
const SRGB: u8 = 2;
const PREMULTIPLIED: u8 = 1;

/// Transfer functions by their codes, for messages.
const TRANSFERS: [&str; 20] = [
    "unspecified",
    "linear",
    "sRGB",
    "ITU",
    "NTSC",
    "S-Log",
    "S-Log2",
    "BT.1886",
    "HLG OETF",
    "HLG EOTF",
    "PQ EOTF",
    "PQ OETF",
    "DCI-P3",
    "PAL OETF",
    "PAL 625 EOTF",
    "ST 240",
    "ACEScc",
    "ACEScct",
    "Adobe RGB",
    "HLG unnormalized OETF",
];

/// Primaries of a descriptor.
struct StatedPrimaries {
    code: u8,
    name: &'static str,
    /// `None` for CIE XYZ.
    chromaticities: Option<Chromaticities>,
}

const fn rgb(code: u8, name: &'static str, chromaticities: Chromaticities) -> StatedPrimaries {
    StatedPrimaries {
        code,
        name,
        chromaticities: Some(chromaticities),
    }
}

const PRIMARIES: [StatedPrimaries; 7] = [
    rgb(1, "BT.709", REC709),
    rgb(4, "BT.2020", REC2020),
    StatedPrimaries {
        code: 5,
        name: "CIE XYZ",
        chromaticities: None,
    },
    rgb(6, "ACES 2065-1", ACES_AP0),
    rgb(7, "ACEScg", ACES_AP1),
    rgb(10, "Display P3", DISPLAY_P3),
    rgb(11, "Adobe RGB", ADOBE_RGB),
];

impl StatedPrimaries {
    /// Returns the matrix to Rec.709; `None` if the colours are Rec.709 already.
    fn to_rec709(&self) -> Option<DMat3> {
        match self.chromaticities {
            None => Some(xyz_to_rec709()),
            Some(REC709) => None,
            Some(chromaticities) => chromaticities.to_rec709(),
        }
    }
}
