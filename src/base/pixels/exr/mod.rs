//! OpenEXR: linear f32 images with layers.

mod color_label;
mod envmap;
mod frame;
mod layers;
mod read;
mod write;

pub use read::{read, read_bytes, read_layer};
pub use write::{write_channels, write_rgba};

pub const IS_BUILT: bool = true;
