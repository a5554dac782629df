//! Radiance by direction: environments from files and formulas.

mod builtin;
mod error;
mod faces;
mod load;
mod luminance;
mod placement;
mod resample;

pub use builtin::{BUILTIN_PREFIX, BUILTINS, Builtin, Parameter};
pub use error::{EnvironmentError, GUIDE};
pub use load::{FORMATS, Format, LoadOptions, checked};
pub use luminance::Luminance;
pub use placement::{Placement, orientation};

use crate::base::math::equirect;
use crate::base::pixels::RgbImage;
use crate::base::pixels::lookup::{Wrap, bilinear};
use glam::DVec3;
use std::ffi::OsStr;
use std::path::Path;

pub mod distribution;
pub mod layout;

/// A distant environment: an equirectangular map of linear radiance (see `math::equirect`), looked
/// up bilinearly.
#[derive(Clone, Debug)]
pub struct Environment {
    /// As the user wrote it: `builtin:sky` or the file's path.
    pub name: String,
    pub image: RgbImage,
    /// BLAKE3 (hex) of size and pixels.
    pub hash: String,
    pub luminance: Luminance,
    /// Warnings about unusual but usable input (aspect ratio not 2:1, clamped texels ...), one
    /// sentence each.
    pub warnings: Vec<String>,
}

impl Environment {
    /// Makes an environment from an image in memory, which must not be empty. Texels are not
    /// checked.
    pub fn from_image(name: impl Into<String>, image: RgbImage) -> Self {
        assert!(!image.data.is_empty(), "an environment has texels");
        let mut hasher = blake3::Hasher::new();
        hasher
            .update(&image.width.to_le_bytes())
            .update(&image.height.to_le_bytes());
        hasher.update(bytemuck::cast_slice(&image.data));
        let hash = hasher.finalize().to_hex().to_string();
        let luminance = Luminance::from_image(&image);
        Self {
            name: name.into(),
            image,
            hash,
            luminance,
            warnings: Vec::new(),
        }
    }

    /// Returns the name without folders, for files that others get.
    pub fn file_name(&self) -> &str {
        let name = Path::new(&self.name).file_name();
        name.and_then(OsStr::to_str).unwrap_or(&self.name)
    }

    /// Looks up the radiance from `direction` (any length but 0), bilinearly; u wraps, v clamps at
    /// the poles.
    pub fn radiance(&self, direction: DVec3) -> DVec3 {
        let value = |texel: [f32; 3]| DVec3::from_array(texel.map(f64::from));
        bilinear(
            &self.image,
            equirect::uv_from_direction(direction),
            Wrap::EQUIRECT,
            value,
        )
    }
}
