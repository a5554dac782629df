//! The 8-bit texels of a half, in the memory that the window is painted from.

use crate::base::pixels::Rgb8Image;
use crate::instrument::gpu::{Buffer, Gpu, GpuError};
use crate::instrument::tonemap;
use std::borrow::Cow;
use std::sync::Arc;

#[derive(Clone)]
pub enum Texels {
    Host(Arc<Rgb8Image>),
    Device(DeviceTexels),
}

/// Texels that stay on the device: a word each, R in the lowest byte.
#[derive(Clone)]
pub struct DeviceTexels {
    pub words: Buffer,
    pub size: [u32; 2],
    pub gpu: Gpu,
}

impl DeviceTexels {
    /// Copies an image that the host made.
    pub fn copied(gpu: &Gpu, image: &Rgb8Image) -> Result<Self, GpuError> {
        let word = |&[r, g, b]: &[u8; 3]| u32::from_le_bytes([r, g, b, u8::MAX]);
        let words: Vec<u32> = image.data.iter().map(word).collect();
        Ok(Self {
            words: gpu.buffer_from("picture", &words)?,
            size: [image.width, image.height],
            gpu: gpu.clone(),
        })
    }
}

impl Texels {
    pub fn size(&self) -> [u32; 2] {
        match self {
            Self::Host(image) => [image.width, image.height],
            Self::Device(texels) => texels.size,
        }
    }

    /// Returns them as an image; of a device it is read.
    pub fn on_host(&self) -> Result<Cow<'_, Rgb8Image>, GpuError> {
        match self {
            Self::Host(image) => Ok(Cow::Borrowed(image.as_ref())),
            Self::Device(DeviceTexels { words, size, gpu }) => {
                Ok(Cow::Owned(tonemap::pass::read(gpu, words, *size)?))
            }
        }
    }
}
