//! Texture files as environments: a cube, or a lat-long image, of which the first level is used.

use super::babylon_env;
use super::container::{FACE_COUNT, Texture, from_bytes};
use super::convention::{Axes, Preset};
use crate::base::names::Listed;
use crate::base::pixels::{Decoded, Fault, PixelsError, Projection, RgbImage, TexelPosition};
use crate::instrument::environment::Format;
use glam::{DMat3, DVec3};
use std::path::Path;

/// Formats for [`crate::instrument::environment::LoadOptions::more_formats`].
pub static ENVIRONMENT_FORMATS: &[Format] = &[
    Format {
        name: "ktx2",
        extension: "ktx2",
        about: "level 0 of a KTX 2 cube or lat-long map; FILE#+x+y-z names a cube's axes",
        read,
    },
    Format {
        name: "ktx",
        extension: "ktx",
        about: "the same in KTX 1",
        read,
    },
    Format {
        name: "dds",
        extension: "dds",
        about: "the same in DDS",
        read,
    },
    Format {
        name: babylon_env::PRESET,
        extension: babylon_env::EXTENSION,
        about: "level 0 of Babylon.js' prefiltered cube",
        read: read_babylon_env,
    },
];

/// Decodes the first level; `axes` is the text after `#`.
fn read(path: &Path, bytes: &[u8], axes: Option<&str>) -> Result<Decoded, PixelsError> {
    let texture = from_bytes(path, bytes)?;
    if !texture.is_cube() {
        return single(texture, axes).map_err(|fault| fault.in_file(path));
    }
    let mut warnings = texture.warnings.clone();
    let axes = match stated_axes(axes).map_err(|fault| fault.in_file(path))? {
        Some(axes) => axes,
        None => {
            warnings.push(
                "The cube was looked up along the axes of the world (+x+y+z). If its light is \
                 mirrored or turned, name the axes of its program: FILE#+x+y-z for Bevy, \
                 FILE#-x+y+z for three.js."
                    .to_owned(),
            );
            Axes::SAME
        }
    };
    Ok(cube(&texture.levels[0], axes, warnings))
}

/// Decodes level 0 of Babylon.js' `.env`; `axes` is the text after `#`.
fn read_babylon_env(path: &Path, bytes: &[u8], axes: Option<&str>) -> Result<Decoded, PixelsError> {
    let found = babylon_env::read(bytes).map_err(|fault| fault.in_file(path))?;
    let stated = stated_axes(axes).map_err(|fault| fault.in_file(path))?;
    let of_babylon = || Preset::listed(babylon_env::PRESET).convention().axes;
    let axes = stated.unwrap_or_else(of_babylon);
    Ok(cube(&found.map.levels[0], axes, Vec::new()))
}

/// Parses the axes of a cube after `#`.
fn stated_axes(text: Option<&str>) -> Result<Option<Axes>, Fault> {
    let parsed = |text: &str| {
        Axes::parse(text).map_err(|_| {
            Fault::new(
                format!("{text:?} is not a list of axes"),
                "the cube's axis for the world's x, y and z, such as FILE#+x+y-z",
            )
        })
    };
    text.map(parsed).transpose()
}

fn cube(faces: &[RgbImage], axes: Axes, warnings: Vec<String>) -> Decoded {
    Decoded {
        projection: Some(Projection::Cube {
            texels: TexelPosition::Centres,
            file_from_world: DMat3::from_cols(
                axes.to_file(DVec3::X),
                axes.to_file(DVec3::Y),
                axes.to_file(DVec3::Z),
            ),
        }),
        ..Decoded::new(strip(faces), warnings)
    }
}

/// Takes a texture of one image, as a lat-long map.
fn single(mut texture: Texture, axes: Option<&str>) -> Result<Decoded, Fault> {
    if let Some(axes) = axes {
        return Err(Fault::new(
            format!("has one face, and is asked for the axes {axes:?}"),
            "axes of a cube",
        ));
    }
    let image = texture.levels.swap_remove(0).swap_remove(0);
    Ok(Decoded::new(image, texture.warnings))
}

/// Puts the faces below each other.
fn strip(faces: &[RgbImage]) -> RgbImage {
    let side = faces[0].width;
    let texels = faces.iter().flat_map(|face| face.data.iter().copied());
    RgbImage::new(side, FACE_COUNT as u32 * side, texels.collect())
}
