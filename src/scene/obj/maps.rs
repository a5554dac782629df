//! Albedo maps: PNG or JPEG, sRGB, to linear RGB.

use super::mtl::Libraries;
use super::source::SceneFiles;
use crate::color::srgb_decode;
use crate::pixels::{Pixels, RgbImage};
use image::{DynamicImage, ImageReader};
use std::io::Cursor;

/// Texels of all maps of a file together: 1.5 GiB as RGB floats.
const MAX_TEXELS: u64 = 1 << 27;

/// The textures, and the texture of each map. A map that cannot be read adds a warning only.
pub(super) fn read(
    files: &dyn SceneFiles,
    libraries: &Libraries,
    warnings: &mut Vec<String>,
) -> (Vec<RgbImage>, Vec<Option<usize>>) {
    let mut textures: Vec<RgbImage> = Vec::new();
    let mut texels_left = MAX_TEXELS;
    let mut texture_of = Vec::new();
    for path in &libraries.maps {
        let decoded = files.read(path).map_err(|error| error.to_string()).and_then(|bytes| decode(&bytes, texels_left));
        texture_of.push(match decoded {
            Ok(texture) => {
                texels_left -= texture.data.len() as u64;
                textures.push(texture);
                Some(textures.len() - 1)
            }
            Err(error) => {
                warnings.push(format!("{}: cannot read the albedo map: {error}; it is left out", path.display()));
                None
            }
        });
    }
    (textures, texture_of)
}

fn decode(bytes: &[u8], most_texels: u64) -> Result<RgbImage, String> {
    let reader = || ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| error.to_string());
    let (width, height) = reader()?.into_dimensions().map_err(|error| error.to_string())?;
    if u64::from(width) * u64::from(height) > most_texels {
        return Err(format!("it has {width}x{height} texels, where {most_texels} of {MAX_TEXELS} are left"));
    }
    let linear = |texel: [f32; 3]| texel.map(srgb_decode);
    let texels = match reader()?.decode().map_err(|error| error.to_string())? {
        deep @ (DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_)) => {
            let deep = deep.into_rgb16();
            deep.pixels().map(|texel| linear(texel.0.map(|x| f32::from(x) / f32::from(u16::MAX)))).collect()
        }
        image => image.into_rgb8().pixels().map(|texel| linear(texel.0.map(|x| f32::from(x) / 255.0))).collect(),
    };
    Ok(Pixels::new(width, height, texels))
}
