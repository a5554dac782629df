//! Float images in memory and their files.
//!
//! Readers accept hostile bytes: they never panic, and allocate only what the file's size makes
//! plausible. Writers replace the target in one step or not at all.

#[cfg(feature = "exr")]
pub mod exr;
#[cfg(not(feature = "exr"))]
#[path = "exr_absent.rs"]
pub mod exr;
mod file;
#[cfg(feature = "gpu")]
pub mod gain_map;
pub mod lookup;
#[cfg(feature = "cli")]
pub mod packed;
pub mod png;
pub mod radiance;
mod shrink;
pub(crate) mod webp;

pub(crate) use file::{ENVIRONMENT_TEXELS_MAX, Fault, read_bounded, reserved, write_atomically};
pub use file::{PART_PREFIX, PixelsError, Staged};

use glam::DMat3;

#[derive(Clone, Debug)]
pub struct Decoded {
    pub rgb: RgbImage,
    pub alpha: Option<GrayImage>,
    /// One sentence each.
    pub warnings: Vec<String>,
    pub content: Content,
    /// The projection that the file states.
    pub projection: Option<Projection>,
}

impl Decoded {
    /// Makes an image of radiance, without alpha, of which nothing else is known.
    pub fn new(rgb: RgbImage, warnings: Vec<String>) -> Self {
        Self {
            rgb,
            alpha: None,
            warnings,
            content: Content::Radiance,
            projection: None,
        }
    }
}

/// What the numbers of an image are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Linear Rec.709.
    Radiance,
    /// Tables: not colours.
    Data,
}

/// How an environment is laid out on an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    LatLong,
    /// Six faces below each other, in the order and layout of a Vulkan cube map.
    Cube {
        texels: TexelPosition,
        /// Converts world directions to directions of the cube.
        file_from_world: DMat3,
    },
}

/// Where the outermost texel centres of an image lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexelPosition {
    /// Half a texel inside the image.
    Centres,
    /// On its edges.
    Edges,
}

/// The largest finite half. Brighter texels (a sun) are clamped, as in engines: infinity would
/// spoil all filtered texels.
pub const HALF_MAX: f32 = 65504.0;

/// Row-major image; row 0 is the top row.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels<T> {
    pub width: u32,
    pub height: u32,
    pub data: Vec<T>,
}

/// Linear RGB, Rec.709 primaries.
pub type RgbImage = Pixels<[f32; 3]>;
/// One float per pixel; masks hold 0 or 1.
pub type GrayImage = Pixels<f32>;
/// Display-referred 8-bit RGB.
pub type Rgb8Image = Pixels<[u8; 3]>;

impl<T: Copy> Pixels<T> {
    /// Wraps `data`, which must have `width * height` pixels.
    pub fn new(width: u32, height: u32, data: Vec<T>) -> Self {
        assert_eq!(
            data.len(),
            width as usize * height as usize,
            "pixel count of a {width}x{height} image"
        );
        Self {
            width,
            height,
            data,
        }
    }

    pub fn filled(width: u32, height: u32, value: T) -> Self {
        Self {
            width,
            height,
            data: vec![value; width as usize * height as usize],
        }
    }

    /// Computes each pixel from (column, row).
    pub fn from_fn(width: u32, height: u32, mut pixel: impl FnMut(u32, u32) -> T) -> Self {
        // The iterator has no exact length.
        let mut data = Vec::with_capacity(width as usize * height as usize);
        data.extend(
            (0..height)
                .flat_map(|y| (0..width).map(move |x| (x, y)))
                .map(|(x, y)| pixel(x, y)),
        );
        Self {
            width,
            height,
            data,
        }
    }

    pub fn get(&self, x: u32, y: u32) -> T {
        self.data[y as usize * self.width as usize + x as usize]
    }

    pub fn map<U>(&self, f: impl FnMut(T) -> U) -> Pixels<U> {
        Pixels {
            width: self.width,
            height: self.height,
            data: self.data.iter().copied().map(f).collect(),
        }
    }
}
