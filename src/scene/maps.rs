//! Maps of materials: PNG or JPEG, to linear numbers.

use crate::color::srgb_decode;
use crate::pixels::lookup::Wrap;
use crate::pixels::{Pixels, RgbImage};
use image::{DynamicImage, ImageReader};
use std::io::Cursor;

/// Texels of all maps of a file together, such as two of 4096 x 4096: 1.9 GiB with [`TEXEL_BYTES`].
const MAX_TEXELS: u64 = 1 << 25;
/// Bytes of a texel at most: 12 as linear RGB, 16 on the way to the device, and 16 there, which may be this machine; its levels take a third
/// of that.
const TEXEL_BYTES: u64 = 59;

/// A map as it is looked up: linear RGB in levels, the finest first, down to one texel.
#[derive(Clone, Debug)]
pub struct Texture {
    pub levels: Vec<RgbImage>,
    pub wrap: Wrap,
}

impl Texture {
    /// The image with its levels: each texel is the mean of what it covers in the level before, also where a side is odd.
    pub fn new(image: RgbImage, wrap: Wrap) -> Self {
        let mut levels = vec![image];
        while let Some(last) = levels.last().filter(|last| last.width.max(last.height) > 1) {
            let [width, height] = [last.width, last.height].map(|side| (side / 2).max(1));
            let means = last.area_means(width, height, |texel| texel.map(f64::from));
            levels.push(means.map(|mean| mean.map(|value| value as f32)));
        }
        Self { levels, wrap }
    }

    /// The mean of all texels.
    pub fn mean(&self) -> [f32; 3] {
        self.levels[self.levels.len() - 1].data[0]
    }
}

/// What the numbers of a map are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    /// sRGB colour.
    Color,
    /// Fractions as they are.
    Linear,
    /// A unit vector about the normal, each of its coordinates as (x + 1)/2; x and y are then scaled.
    Normal { scale: f32 },
}

/// The decoded maps of a file.
#[derive(Default)]
pub(super) struct Maps {
    pub textures: Vec<Texture>,
    texel_count: u64,
}

impl Maps {
    /// Adds the map of a file of these bytes and gives its index.
    pub fn add(&mut self, bytes: &[u8], meaning: Meaning, wrap: Wrap) -> Result<usize, String> {
        let mut texture = decode(bytes, meaning == Meaning::Color, MAX_TEXELS - self.texel_count)?;
        if let Meaning::Normal { scale } = meaning {
            // Linear, so that a lookup between texels may follow it.
            let signed = |[x, y, z]: [f32; 3]| [scale * (2.0 * x - 1.0), scale * (2.0 * y - 1.0), 2.0 * z - 1.0];
            texture.data.iter_mut().for_each(|texel| *texel = signed(*texel));
        }
        self.texel_count += texture.data.len() as u64;
        self.textures.push(Texture::new(texture, wrap));
        Ok(self.textures.len() - 1)
    }
}

fn decode(bytes: &[u8], is_srgb: bool, most_texels: u64) -> Result<RgbImage, String> {
    let reader = || ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| error.to_string());
    let (width, height) = reader()?.into_dimensions().map_err(|error| error.to_string())?;
    if u64::from(width) * u64::from(height) > most_texels {
        let mebibytes = (u64::from(width) * u64::from(height) * TEXEL_BYTES) >> 20;
        return Err(format!(
            "it has {width}x{height} texels, which take {mebibytes} MiB; of {MAX_TEXELS} for all maps {most_texels} are left"
        ));
    }
    let to_linear = |x: f32| if is_srgb { srgb_decode(x) } else { x };
    let mut texels: Vec<[f32; 3]> = Vec::new();
    texels.try_reserve_exact(width as usize * height as usize).map_err(|error| error.to_string())?;
    match reader()?.decode().map_err(|error| error.to_string())? {
        deep @ (DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_)) => {
            let deep = deep.into_rgb16();
            let linear = |x: u16| to_linear(f32::from(x) / f32::from(u16::MAX));
            texels.extend(deep.pixels().map(|texel| texel.0.map(linear)));
        }
        image => {
            // A hundred million powers would take seconds; there are 256.
            let linear: [f32; 256] = std::array::from_fn(|x| to_linear(x as f32 / 255.0));
            texels.extend(image.into_rgb8().pixels().map(|texel| texel.0.map(|x| linear[usize::from(x)])));
        }
    }
    Ok(Pixels::new(width, height, texels))
}
