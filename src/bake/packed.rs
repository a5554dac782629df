//! Files that hold a whole bake in an engine's own form.

use super::parts::Map;
use super::sh::Coefficients;
use super::{babylon_env, f3d_cache, playcanvas_atlas};
use crate::base::pixels::{PixelsError, png, read_bounded};
use std::path::Path;

/// The parts in such a file.
#[derive(Debug)]
pub struct Packed {
    pub specular: Map,
    pub irradiance: Option<Map>,
    pub sh: Option<Coefficients>,
    /// Name of its conventions.
    pub preset: &'static str,
    /// Width of each level, if the file states it.
    pub alphas: Option<Vec<f64>>,
    /// Whether the maps are RGBP whose scale was rounded up.
    pub has_rounded_up_scale: bool,
}

/// Reads Babylon.js' `.env`, F3D's cache or PlayCanvas' atlas; `None` for other files. A PNG is an atlas only
/// if it `may_be_map`; one that is named as a map, `is_map`, need not have bright texels.
pub fn read(path: &Path, may_be_map: bool, is_map: bool) -> Result<Option<Packed>, PixelsError> {
    let extension = path
        .extension()
        .map(|extension| extension.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some(babylon_env::EXTENSION) => {
            let found =
                babylon_env::read(&read_bounded(path)?).map_err(|fault| fault.in_file(path))?;
            Ok(Some(Packed {
                specular: found.map,
                irradiance: None,
                sh: found.sh,
                preset: babylon_env::PRESET,
                alphas: Some(found.alphas),
                has_rounded_up_scale: false,
            }))
        }
        Some(f3d_cache::EXTENSION) => Ok(Some(Packed {
            specular: f3d_cache::read(path)?,
            irradiance: None,
            sh: None,
            preset: f3d_cache::PRESET,
            alphas: None,
            has_rounded_up_scale: false,
        })),
        Some("png") if may_be_map && path.is_file() => {
            // Other forms of PNG are tables.
            let Ok(image) = png::decode_rgba8(&read_bounded(path)?) else {
                return Ok(None);
            };
            if !playcanvas_atlas::is_atlas(&image, is_map) {
                return Ok(None);
            }
            let found = playcanvas_atlas::read(&image).map_err(|fault| fault.in_file(path))?;
            Ok(Some(Packed {
                specular: found.specular,
                irradiance: Some(found.irradiance),
                sh: None,
                preset: playcanvas_atlas::PRESET,
                alphas: None,
                has_rounded_up_scale: found.has_rounded_up_scale,
            }))
        }
        _ => Ok(None),
    }
}
