//! Albedo maps: PNG or JPEG, sRGB, to linear RGB.

use super::add_first;
use super::mtl::Libraries;
use super::source::SceneFiles;
use crate::color::srgb_decode;
use crate::pixels::{Pixels, RgbImage};
use image::{DynamicImage, ImageReader};
use std::io::Cursor;

/// Texels of all maps of a file together, such as two of 4096 x 4096: 1.5 GiB with [`TEXEL_BYTES`].
const MAX_TEXELS: u64 = 1 << 25;
/// Bytes of a texel at most: 12 as linear RGB, 16 on the way to the device, and 16 there, which may be this machine.
const TEXEL_BYTES: u64 = 44;

/// The textures, and the texture of each map. A map that cannot be read adds a warning only.
pub(super) fn read(
    files: &dyn SceneFiles,
    libraries: &Libraries,
    warnings: &mut Vec<String>,
) -> (Vec<RgbImage>, Vec<Option<usize>>) {
    let mut textures: Vec<RgbImage> = Vec::new();
    let mut texels_left = MAX_TEXELS;
    let (mut texture_of, mut unreadable) = (Vec::new(), Vec::new());
    for path in &libraries.maps {
        let decoded = files.read(path).map_err(|error| error.to_string()).and_then(|bytes| decode(&bytes, texels_left));
        texture_of.push(match decoded {
            Ok(texture) => {
                texels_left -= texture.data.len() as u64;
                textures.push(texture);
                Some(textures.len() - 1)
            }
            Err(error) => {
                unreadable.push(format!("{}: cannot read the albedo map: {error}; it is left out", path.display()));
                None
            }
        });
    }
    add_first(warnings, unreadable);
    (textures, texture_of)
}

fn decode(bytes: &[u8], most_texels: u64) -> Result<RgbImage, String> {
    let reader = || ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| error.to_string());
    let (width, height) = reader()?.into_dimensions().map_err(|error| error.to_string())?;
    if u64::from(width) * u64::from(height) > most_texels {
        let mebibytes = (u64::from(width) * u64::from(height) * TEXEL_BYTES) >> 20;
        return Err(format!(
            "it has {width}x{height} texels, which take {mebibytes} MiB; of {MAX_TEXELS} for all maps {most_texels} are left"
        ));
    }
    let mut texels: Vec<[f32; 3]> = Vec::new();
    texels.try_reserve_exact(width as usize * height as usize).map_err(|error| error.to_string())?;
    match reader()?.decode().map_err(|error| error.to_string())? {
        deep @ (DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_)) => {
            let deep = deep.into_rgb16();
            let linear = |x: u16| srgb_decode(f32::from(x) / f32::from(u16::MAX));
            texels.extend(deep.pixels().map(|texel| texel.0.map(linear)));
        }
        image => {
            // A hundred million powers would take seconds; there are 256.
            let linear: [f32; 256] = std::array::from_fn(|x| srgb_decode(x as f32 / 255.0));
            texels.extend(image.into_rgb8().pixels().map(|texel| texel.0.map(|x| linear[usize::from(x)])));
        }
    }
    Ok(Pixels::new(width, height, texels))
}
