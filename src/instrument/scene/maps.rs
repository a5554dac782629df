//! Textures of materials: PNG, JPEG or WebP to linear numbers.

use crate::base::color::srgb_decode;
use crate::base::pixels::lookup::Wrap;
use crate::base::pixels::{Pixels, RgbImage};
use glam::Vec2;
use image::{DynamicImage, ImageReader};
use std::io::Cursor;

/// Most texels of a file's maps together: 1.9 GiB at up to 59 bytes each, on the host and on the
/// device.
const MAX_TEXELS: u64 = 1 << 25;
/// Most texels of one map: below 1.4 GiB while decoding.
const MAX_FILE_TEXELS: u64 = 1 << 26;

/// A texture: linear RGB in levels, the finest first, down to one texel.
#[derive(Clone, Debug)]
pub struct Texture {
    pub levels: Vec<RgbImage>,
    pub wrap: Wrap,
}

impl Texture {
    /// Builds the levels by area means, also for odd sides.
    pub fn new(image: RgbImage, wrap: Wrap) -> Self {
        let mut levels = vec![image];
        while let Some(last) = levels.last().filter(|last| last.width.max(last.height) > 1) {
            let [width, height] = [last.width, last.height].map(|side| (side / 2).max(1));
            let means = last.area_means(width, height, |texel| texel.map(f64::from));
            levels.push(means.map(|mean| mean.map(|value| value as f32)));
        }
        Self { levels, wrap }
    }

    pub fn mean(&self) -> [f32; 3] {
        self.levels[self.levels.len() - 1].data[0]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    /// sRGB colour.
    Color,
    /// Fractions.
    Linear,
    /// Fractions in the alpha channel, 1 without one.
    Alpha,
    /// A normal, each coordinate as (x + 1)/2; x and y are then scaled.
    Normal { scale: f32 },
    /// Fractions `1 + strength (x - 1)`.
    Occlusion { strength: f32 },
    /// A direction of red and green, each coordinate as (x + 1)/2; its length is blue.
    Direction,
}

impl Meaning {
    /// Converts the linear channels of a texel to what the map means, so that filtering may follow.
    fn value(self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Color | Self::Linear | Self::Alpha => [x, y, z],
            Self::Normal { scale } => [
                scale * (2.0 * x - 1.0),
                scale * (2.0 * y - 1.0),
                2.0 * z - 1.0,
            ],
            Self::Occlusion { strength } => [x, y, z].map(|x| 1.0 + strength * (x - 1.0)),
            Self::Direction => {
                let unit = Vec2::new(2.0 * x - 1.0, 2.0 * y - 1.0).normalize_or(Vec2::X);
                (z * unit).extend(0.0).to_array()
            }
        }
    }
}

/// The textures of a scene's files, reduced while they are too many texels together.
pub(super) struct Maps {
    textures: Vec<Texture>,
    /// Longest side, a power of two; halved while all textures have too many texels together.
    longest_side: u32,
    is_any_cut: bool,
}

/// All textures of a scene.
pub(super) struct ReadMaps {
    pub textures: Vec<Texture>,
    /// Whether textures were reduced, in a sentence.
    pub warning: Option<String>,
}

impl Default for Maps {
    fn default() -> Self {
        Self {
            textures: Vec::new(),
            longest_side: 1 << 31,
            is_any_cut: false,
        }
    }
}

impl Maps {
    /// Decodes a texture and returns its index.
    pub fn add(&mut self, bytes: &[u8], meaning: Meaning, wrap: Wrap) -> Result<usize, String> {
        let mut image = decode(bytes, meaning)?;
        for texel in &mut image.data {
            *texel = meaning.value(*texel);
        }
        self.textures.push(Texture::new(image, wrap));
        self.cut();
        while self.longest_side > 1 && self.texel_count() > MAX_TEXELS {
            self.longest_side /= 2;
            self.cut();
        }
        Ok(self.textures.len() - 1)
    }

    /// Counts the texels of all finest levels.
    fn texel_count(&self) -> u64 {
        self.textures
            .iter()
            .map(|map| map.levels[0].data.len() as u64)
            .sum()
    }

    /// Drops levels longer than the longest side; independent of the textures' order.
    fn cut(&mut self) {
        for map in &mut self.textures {
            let is_longer = |level: &RgbImage| level.width.max(level.height) > self.longest_side;
            let first = map
                .levels
                .iter()
                .position(|level| !is_longer(level))
                .unwrap_or(0);
            self.is_any_cut |= first > 0;
            map.levels.drain(..first);
        }
    }

    pub fn finish(self) -> ReadMaps {
        let side = self.longest_side;
        let warning = self.is_any_cut.then(|| {
            format!(
                "textures with more than {MAX_TEXELS} texels together were halved to at most \
                 {side} x {side}"
            )
        });
        ReadMaps {
            textures: self.textures,
            warning,
        }
    }
}

fn decode(bytes: &[u8], meaning: Meaning) -> Result<RgbImage, String> {
    let reader = || {
        ImageReader::new(Cursor::new(bytes))
            .with_guessed_format()
            .map_err(|error| error.to_string())
    };
    if reader()?.format().is_none() {
        return Err("not a PNG, JPEG or WebP file".to_owned());
    }
    let (width, height) = reader()?
        .into_dimensions()
        .map_err(|error| error.to_string())?;
    if u64::from(width) * u64::from(height) > MAX_FILE_TEXELS {
        return Err(format!(
            "it has {width}x{height} texels; expected at most {MAX_FILE_TEXELS}"
        ));
    }
    let to_linear: fn(f32) -> f32 = if meaning == Meaning::Color {
        srgb_decode
    } else {
        |x: f32| x
    };
    let reads_alpha = meaning == Meaning::Alpha;
    let mut texels: Vec<[f32; 3]> = Vec::new();
    texels
        .try_reserve_exact(width as usize * height as usize)
        .map_err(|error| error.to_string())?;
    match reader()?.decode().map_err(|error| error.to_string())? {
        deep @ (DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_)) => {
            let deep = deep.into_rgba16();
            let linear = |x: u16| to_linear(f32::from(x) / f32::from(u16::MAX));
            texels.extend(
                deep.pixels()
                    .map(|texel| channels(texel.0, reads_alpha).map(linear)),
            );
        }
        image => {
            // A table of 256 replaces a hundred million powers.
            let linear: [f32; 256] = std::array::from_fn(|x| to_linear(x as f32 / 255.0));
            let bytes = image.into_rgba8();
            texels.extend(
                bytes
                    .pixels()
                    .map(|texel| channels(texel.0, reads_alpha).map(|x| linear[usize::from(x)])),
            );
        }
    }
    Ok(Pixels::new(width, height, texels))
}

/// Returns the channels of a texel that a map reads.
fn channels<T: Copy>([r, g, b, a]: [T; 4], reads_alpha: bool) -> [T; 3] {
    if reads_alpha { [a; 3] } else { [r, g, b] }
}
