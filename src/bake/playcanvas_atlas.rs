//! PlayCanvas' atlas: lat-long levels in one square PNG in RGBP.
//!
//! Rectangles of an atlas of 512 texels, each with a border of one texel for linear lookups
//! [PlayCanvas 2.23.3, `env-lighting.js`, `generateAtlas`; `envAtlas.js`, `mapRoughnessUv`]:
//! level 0 in the upper half, level k in 256/2^(k-1) x 128/2^(k-1) below it, mips of level 0 to the
//! right, irradiance over π at (128, 384). Level k is read at roughness k/5.

use super::container::{Interpretation, RGBP};
use super::parts::Map;
use super::rgbp;
use crate::base::names::Listed;
use crate::base::pixels::{Fault, Pixels, RgbImage, png};
use crate::instrument::environment::layout::MapLayout;

/// Name of the conventions in the list of presets.
pub const PRESET: &str = "playcanvas-atlas";
/// Side of the atlas that the rectangles are for, texels.
pub const SIDE: u32 = 512;
const LEVEL_COUNT: u32 = 6;

/// A rectangle of an atlas of 512 texels, border included.
#[derive(Clone, Copy, Debug)]
struct Rectangle {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

impl Rectangle {
    /// Returns the rectangle of a level.
    fn of_level(level: u32) -> Self {
        if level == 0 {
            return Self {
                x: 0,
                y: 0,
                width: SIDE,
                height: SIDE / 2,
            };
        }
        Self {
            x: 0,
            y: SIDE - (SIDE >> level),
            width: SIDE >> level,
            height: SIDE >> (level + 1),
        }
    }

    const IRRADIANCE: Self = Self {
        x: 128,
        y: 384,
        width: 64,
        height: 32,
    };

    /// Cuts the rectangle out of an atlas `scale` times as large, without its border.
    fn cut(self, atlas: &RgbImage, scale: u32) -> RgbImage {
        let [x, y] = [self.x, self.y].map(|start| scale * (start + 1));
        let [width, height] = [self.width, self.height].map(|side| scale * (side - 2));
        RgbImage::from_fn(width, height, |column, row| atlas.get(x + column, y + row))
    }
}

/// The contents of an atlas.
#[derive(Debug)]
pub struct Atlas {
    pub specular: Map,
    pub irradiance: Map,
    pub has_rounded_up_scale: bool,
}

/// Whether a PNG is an atlas: tables have no alpha, and atlases of most maps have bright texels.
/// `is_map` says that the file is named as a map.
pub fn is_atlas(image: &Pixels<[u8; 4]>, is_map: bool) -> bool {
    let is_bright = |texel: &[u8; 4]| texel[3] < u8::MAX;
    has_size(image) && (is_map || image.data.iter().any(is_bright))
}

fn has_size(image: &Pixels<[u8; 4]>) -> bool {
    image.width == image.height && image.width > 0 && image.width.is_multiple_of(SIDE)
}

/// Reads the levels of an atlas.
pub fn read(image: &Pixels<[u8; 4]>) -> Result<Atlas, Fault> {
    if !has_size(image) {
        return Err(Fault::new(
            format!("it is {}x{}", image.width, image.height),
            "an atlas of PlayCanvas, 512x512",
        ));
    }
    let texels = image.data.as_flattened();
    let atlas = RGBP.image(
        image.width,
        image.height,
        texels,
        &Interpretation::default(),
    )?;
    let scale = image.width / SIDE;
    let map = |levels: Vec<RgbImage>| Map {
        layout: MapLayout::listed("equirect"),
        levels: levels.into_iter().map(|image| vec![image]).collect(),
    };
    let levels = (0..LEVEL_COUNT).map(|level| Rectangle::of_level(level).cut(&atlas, scale));
    Ok(Atlas {
        specular: map(levels.collect()),
        irradiance: map(vec![Rectangle::IRRADIANCE.cut(&atlas, scale)]),
        has_rounded_up_scale: rgbp::has_rounded_up_scale(&image.data),
    })
}

impl Rectangle {
    /// Returns the rectangle of a mip of level 0, from 1 on.
    fn of_mip(mip: u32) -> Self {
        Self {
            x: SIDE - (SIDE >> mip),
            y: SIDE - (SIDE >> mip),
            width: SIDE >> mip,
            height: SIDE >> (mip + 1),
        }
    }

    /// Returns the size without the border.
    fn inner(self, scale: u32) -> [u32; 2] {
        [self.width, self.height].map(|side| scale * (side - 2))
    }

    /// Puts an image in, with a border for linear lookups: columns wrap, rows go on behind the
    /// poles.
    fn paste(self, atlas: &mut RgbImage, image: &RgbImage, scale: u32) {
        let [width, height] = [image.width, image.height];
        for row in 0..scale * self.height {
            for column in 0..scale * self.width {
                let x = (column + width - scale) % width;
                let (x, y) = match (row + height - scale).checked_sub(height) {
                    // Above the first row.
                    None => ((x + width / 2) % width, scale - 1 - row),
                    Some(y) if y < height => (x, y),
                    Some(y) => ((x + width / 2) % width, 2 * height - 1 - y),
                };
                let index = (scale * self.y + row) * atlas.width + scale * self.x + column;
                atlas.data[index as usize] = image.get(x, y.min(height - 1));
            }
        }
    }
}

/// Mips of level 0, after level 0 itself.
const MIP_COUNT: u32 = 5;

/// The images of an atlas without their borders.
#[derive(Debug)]
pub struct Images {
    pub levels: Vec<RgbImage>,
    /// Level 0 at half the size, a quarter, and so on.
    pub mips: Vec<RgbImage>,
    pub irradiance: Vec<RgbImage>,
}

/// Returns the size of a level in an atlas of `side` texels.
pub fn level_size(side: u32, level: u32) -> [u32; 2] {
    Rectangle::of_level(level).inner(side / SIDE)
}

/// Returns the sizes of the mips of level 0.
pub fn mip_sizes(side: u32) -> impl Iterator<Item = [u32; 2]> {
    (1..=MIP_COUNT).map(move |mip| Rectangle::of_mip(mip).inner(side / SIDE))
}

pub fn irradiance_size(side: u32) -> [u32; 2] {
    Rectangle::IRRADIANCE.inner(side / SIDE)
}

/// Writes an atlas of `side` texels.
pub fn write(side: u32, images: &Images) -> Vec<u8> {
    let scale = side / SIDE;
    let mut atlas = RgbImage::filled(side, side, [0.0; 3]);
    for (level, image) in (0..).zip(&images.levels) {
        Rectangle::of_level(level).paste(&mut atlas, image, scale);
    }
    for (mip, image) in (1..).zip(&images.mips) {
        Rectangle::of_mip(mip).paste(&mut atlas, image, scale);
    }
    for image in &images.irradiance {
        Rectangle::IRRADIANCE.paste(&mut atlas, image, scale);
    }
    let texels = RGBP.bytes_of(&atlas);
    let pixels = Pixels::new(side, side, texels.as_chunks::<4>().0.to_vec());
    png::encode_rgba8(&pixels).expect("memory does not fail")
}
