//! Maps of materials: PNG or JPEG, to linear numbers.

use crate::color::srgb_decode;
use crate::pixels::lookup::Wrap;
use crate::pixels::{Pixels, RgbImage};
use image::{DynamicImage, ImageReader};
use std::io::Cursor;

/// Texels of the finest levels of all maps of a file together, such as two of 4096 x 4096. One takes at most 59 bytes: 12 as linear RGB, 16 on
/// the way to the device, and 16 there, which may be this machine; its levels take a third of that. That is 1.9 GiB.
const MAX_TEXELS: u64 = 1 << 25;
/// Texels of one file, such as 8192 x 8192: below 1.4 GiB with 4 bytes as they are decoded and 16 as linear RGB with levels.
const MAX_FILE_TEXELS: u64 = 1 << 26;

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
pub(super) struct Maps {
    textures: Vec<Texture>,
    /// The longest side that a map keeps, a power of two: finer levels are left out where all maps have too many texels together.
    longest_side: u32,
    is_any_cut: bool,
}

impl Default for Maps {
    fn default() -> Self {
        Self { textures: Vec::new(), longest_side: 1 << 31, is_any_cut: false }
    }
}

impl Maps {
    /// Adds the map of a file of these bytes and gives its index.
    pub fn add(&mut self, bytes: &[u8], meaning: Meaning, wrap: Wrap) -> Result<usize, String> {
        let mut texture = decode(bytes, meaning == Meaning::Color)?;
        if let Meaning::Normal { scale } = meaning {
            // Linear, so that a lookup between texels may follow it.
            let signed = |[x, y, z]: [f32; 3]| [scale * (2.0 * x - 1.0), scale * (2.0 * y - 1.0), 2.0 * z - 1.0];
            texture.data.iter_mut().for_each(|texel| *texel = signed(*texel));
        }
        self.textures.push(Texture::new(texture, wrap));
        self.cut();
        let texels = |maps: &[Texture]| maps.iter().map(|map| map.levels[0].data.len() as u64).sum::<u64>();
        while self.longest_side > 1 && texels(&self.textures) > MAX_TEXELS {
            self.longest_side /= 2;
            self.cut();
        }
        Ok(self.textures.len() - 1)
    }

    /// Leaves out the levels that are longer than the longest side. Which those are does not depend on the order of the maps.
    fn cut(&mut self) {
        for map in &mut self.textures {
            let is_longer = |level: &RgbImage| level.width.max(level.height) > self.longest_side;
            let first = map.levels.iter().position(|level| !is_longer(level)).unwrap_or(0);
            self.is_any_cut |= first > 0;
            map.levels.drain(..first);
        }
    }

    /// The maps, and a warning if some are coarser than their files.
    pub fn finish(self) -> (Vec<Texture>, Option<String>) {
        let side = self.longest_side;
        let warning =
            || format!("maps of more than {MAX_TEXELS} texels together are halved to {side} x {side} at most");
        let warning = self.is_any_cut.then(warning);
        (self.textures, warning)
    }
}

fn decode(bytes: &[u8], is_srgb: bool) -> Result<RgbImage, String> {
    let reader = || ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| error.to_string());
    if reader()?.format().is_none() {
        return Err("it is neither PNG nor JPEG".to_owned());
    }
    let (width, height) = reader()?.into_dimensions().map_err(|error| error.to_string())?;
    if u64::from(width) * u64::from(height) > MAX_FILE_TEXELS {
        return Err(format!("it has {width}x{height} texels, expected at most {MAX_FILE_TEXELS}"));
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
