//! The file of a prefiltered map, by its name.

use super::babylon_env;
use super::container::{FORMATS, Format, RGBD, RGBP, TEXELS, Texel};
use super::f3d_cache;
use super::playcanvas_atlas;
use crate::base::names::Listed;
use crate::instrument::environment::layout::{LAYOUTS, MapLayout};

/// How a bake for an engine stores its prefiltered map.
#[derive(Clone, Copy, Debug)]
pub enum MapForm {
    /// A folder with an EXR file for each face.
    Faces,
    Container(&'static Format),
    /// Babylon.js' `.env`, with SH in it.
    BabylonEnv,
    /// PlayCanvas' atlas of lat-long levels, with irradiance in it.
    PlayCanvasAtlas,
    /// F3D's list of levels, each an image in a folder beside it.
    F3dCache,
}

impl MapForm {
    /// Returns the form of a file or folder of this name.
    pub fn of(name: &str) -> Self {
        let has_extension = |extension: &str| name.ends_with(&format!(".{extension}"));
        if has_extension(babylon_env::EXTENSION) {
            Self::BabylonEnv
        } else if has_extension("png") {
            Self::PlayCanvasAtlas
        } else if has_extension(f3d_cache::EXTENSION) {
            Self::F3dCache
        } else {
            container(name).map_or(Self::Faces, Self::Container)
        }
    }

    /// Returns the word for messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Faces => "EXR faces",
            Self::Container(format) => format.name,
            Self::BabylonEnv => ".env",
            Self::PlayCanvasAtlas => "an atlas",
            Self::F3dCache => "F3D's cache",
        }
    }

    /// Whether a shader can read the levels by the table of taps: both packed files have levels of
    /// other widths or another layout, and F3D has shaders of its own.
    pub fn has_taps(self) -> bool {
        matches!(self, Self::Faces | Self::Container(_))
    }

    /// Lists the pixel formats that it can have.
    pub fn texels(self) -> Vec<&'static Texel> {
        match self {
            Self::BabylonEnv => vec![&RGBD],
            Self::PlayCanvasAtlas => vec![&RGBP],
            Self::Faces | Self::F3dCache => vec![Texel::listed("rgba32f")],
            Self::Container(format) => TEXELS
                .iter()
                .filter(|texel| texel.channels >= 3 && (!format.needs_dxgi || texel.dxgi.is_some()))
                .collect(),
        }
    }

    pub fn layout(self) -> &'static MapLayout {
        match self {
            Self::PlayCanvasAtlas => MapLayout::listed("equirect"),
            _ => &LAYOUTS[0],
        }
    }

    /// Returns the size of a face of a level; `side` is the side of the first face or of the atlas.
    pub fn level_size(self, side: u32, level: u32) -> [u32; 2] {
        match self {
            Self::PlayCanvasAtlas => playcanvas_atlas::level_size(side, level),
            _ => [(side >> level).max(1); 2],
        }
    }

    /// Returns the size of a face of the irradiance map, which an atlas determines.
    pub fn irradiance_size(self, side: u32, irradiance_side: u32) -> [u32; 2] {
        match self {
            Self::PlayCanvasAtlas => playcanvas_atlas::irradiance_size(side),
            _ => [irradiance_side; 2],
        }
    }
}

/// Returns the container of a file name; `None` for a folder of faces.
pub fn container(name: &str) -> Option<&'static Format> {
    FORMATS
        .iter()
        .find(|format| name.ends_with(&format!(".{}", format.extension)))
}
