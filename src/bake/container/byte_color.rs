//! What texels of four linear bytes mean. Their formats (`R8G8B8A8_UNORM`, `GL_RGBA8`) say nothing of
//! codes, so they are read only if a key of the file or the program that reads it says what they hold.

use super::texel::{SRGB8, Texel};
use crate::bake::parts::KEY;
use crate::base::names::{Listed, listed};

/// How the program of a file decodes bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ByteColor {
    /// sRGB codes, though the format says linear: SAPIEN.
    Srgb,
}

listed!(ByteColor, "code of bytes", { "srgb": Srgb });

/// Key of our files, after [`KEY`], whose value is a [`ByteColor`].
pub const BYTES_KEY: &str = "bytes";

impl ByteColor {
    /// Returns what a key of the file says, else `otherwise`.
    pub fn of_keys(keys: &[(String, String)], otherwise: Option<Self>) -> Option<Self> {
        let value = keys
            .iter()
            .find(|(key, _)| key.strip_prefix(KEY) == Some(BYTES_KEY));
        value
            .and_then(|(_, value)| Self::by_name(value))
            .copied()
            .or(otherwise)
    }

    /// Returns what the bytes of a pixel format hold; `None` if the format itself says it.
    pub fn of_texel(texel: &Texel) -> Option<Self> {
        Self::all()
            .find(|color| color.texel().name == texel.name)
            .copied()
    }

    /// Returns the pixel format of such bytes.
    pub fn texel(self) -> &'static Texel {
        match self {
            Self::Srgb => &SRGB8,
        }
    }
}
