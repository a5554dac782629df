//! Texture files: their levels and faces as stored, without a convention.
//!
//! Headers are checked before anything is allocated: at most [`TEXELS_MAX`] texels, square faces,
//! levels that halve.

mod byte_color;
mod dds;
mod interpretation;
mod ktx1;
mod ktx2;
mod pixel_format;
mod texel;

pub use byte_color::{BYTES_KEY, ByteColor};
pub(super) use interpretation::Interpretation;
pub use ktx2::write_table;
pub use texel::{RGBD, RGBP, SRGB8, TEXELS, Texel};

use crate::base::pixels::{Decoded, Fault, PixelsError, RgbImage, png, read_bounded};
use crate::instrument::environment::FORMATS as IMAGES;
use pixel_format::PixelFormat;
use std::path::Path;

/// Most texels of all levels and faces: 128 MiB as radiance, seven times as much while scored.
pub const TEXELS_MAX: u64 = (1 << 25) / 3;
const LEVELS_MAX: u32 = 16;

/// The contents of a texture file.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Largest level first, each with one image or the faces +x, -x, +y, -y, +z, -z.
    pub levels: Vec<Vec<RgbImage>>,
    /// Name of the pixel format.
    pub texel: &'static str,
    /// Metadata: keys and values.
    pub keys: Vec<(String, String)>,
    /// One sentence each.
    pub warnings: Vec<String>,
}

impl Texture {
    pub fn is_cube(&self) -> bool {
        self.levels[0].len() == FACE_COUNT
    }
}

/// Faces of a cube.
pub const FACE_COUNT: usize = 6;

/// A container of textures.
#[derive(Debug)]
pub struct Format {
    pub name: &'static str,
    pub extension: &'static str,
    read: fn(&[u8], Option<ByteColor>) -> Result<Texture, Fault>,
    /// Whether its pixel formats are DXGI codes.
    pub needs_dxgi: bool,
    /// Encodes a file; DDS ignores the keys.
    pub write: fn(&Encoding) -> Vec<u8>,
}

/// What a container writes.
#[derive(Clone, Copy, Debug)]
pub struct Encoding<'a> {
    pub texel: &'static Texel,
    /// Largest level first, each with one image or six faces.
    pub levels: &'a [Vec<RgbImage>],
    pub keys: &'a [(String, String)],
    /// Whether to compress levels by zstd, if the container can.
    pub is_packed: bool,
}

/// Every container. Other images are environment formats ([`IMAGES`]) and PNG.
pub static FORMATS: &[Format] = &[
    Format {
        name: "ktx2",
        extension: "ktx2",
        read: ktx2::read,
        needs_dxgi: false,
        write: ktx2::write,
    },
    Format {
        name: "ktx",
        extension: "ktx",
        read: ktx1::read,
        needs_dxgi: false,
        write: ktx1::write,
    },
    Format {
        name: "dds",
        extension: "dds",
        // No program is known that writes codes of bytes into it.
        read: |bytes, _| dds::read(bytes),
        needs_dxgi: true,
        write: dds::write,
    },
];

/// Lists the extensions of every texture file.
pub fn extensions() -> Vec<&'static str> {
    let images = IMAGES.iter().map(|format| format.extension);
    FORMATS
        .iter()
        .map(|format| format.extension)
        .chain(images)
        .chain([PNG])
        .collect()
}

const PNG: &str = "png";

/// Reads the texture at `path`; its extension selects the format. Texels of four bytes are refused
/// unless the file says what they hold.
pub fn read_texture(path: &Path) -> Result<Texture, PixelsError> {
    read_texture_of(path, None)
}

/// Reads the texture at `path` of a program that decodes bytes in this way.
pub fn read_texture_of(path: &Path, byte_color: Option<ByteColor>) -> Result<Texture, PixelsError> {
    // Refuses unknown extensions before opening the file.
    if path.exists() {
        extension(path)?;
    }
    decoded(path, &read_bounded(path)?, byte_color)
}

fn extension(path: &Path) -> Result<String, PixelsError> {
    let extension = path
        .extension()
        .map(|extension| extension.to_string_lossy().to_lowercase())
        .unwrap_or_default();
    if extensions().contains(&&*extension) {
        return Ok(extension);
    }
    let known = extensions().join(", .");
    Err(Fault::new(
        format!("its extension is {extension:?}"),
        format!("one of .{known}"),
    )
    .in_file(path))
}

/// Reads a texture from memory; the extension of `path` selects the format.
pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Texture, PixelsError> {
    decoded(path, bytes, None)
}

fn decoded(
    path: &Path,
    bytes: &[u8],
    byte_color: Option<ByteColor>,
) -> Result<Texture, PixelsError> {
    let image = |decoded: Decoded, texel| Texture {
        levels: vec![vec![decoded.rgb]],
        texel,
        keys: Vec::new(),
        warnings: decoded.warnings,
    };
    let extension = match extension(path)? {
        // SAPIEN writes KTX 2 by either name, and reads `.ktx` alone.
        ktx if ktx == "ktx" && bytes.starts_with(&ktx2::IDENTIFIER) => "ktx2".to_owned(),
        extension => extension,
    };
    let container = FORMATS.iter().find(|format| format.extension == extension);
    let image_format = IMAGES.iter().find(|format| format.extension == extension);
    let texture = if let Some(format) = container {
        (format.read)(bytes, byte_color).map_err(|fault| fault.in_file(path))?
    } else if let Some(format) = image_format {
        image(format.read(path, bytes)?, format.name)
    } else {
        image(png::read_linear(path, bytes)?, PNG)
    };
    // Containers check their claims; other images may be as large as an environment.
    let texels: usize = texture
        .levels
        .iter()
        .flatten()
        .map(|face| face.data.len())
        .sum();
    if texels as u64 > TEXELS_MAX {
        let fault = Fault::new(
            format!("it has {texels} texels"),
            format!("at most {TEXELS_MAX}; bake a smaller map"),
        );
        return Err(fault.in_file(path));
    }
    match first_oddity(&texture) {
        Some(fault) => Err(fault.in_file(path)),
        None => Ok(texture),
    }
}

/// Describes the first texel that is not finite.
fn first_oddity(texture: &Texture) -> Option<Fault> {
    for (level, faces) in texture.levels.iter().enumerate() {
        for (face, image) in faces.iter().enumerate() {
            let is_odd = |texel: &[f32; 3]| texel.iter().any(|value| !value.is_finite());
            let Some(index) = image.data.iter().position(is_odd) else {
                continue;
            };
            let width = image.width as usize;
            return Some(Fault::new(
                format!(
                    "level {level}, face {face}, column {}, row {} is {:?}",
                    index % width,
                    index / width,
                    image.data[index]
                ),
                "finite values (a sun above 65504 overflows a half: clip the environment before \
                 the bake)",
            ));
        }
    }
    None
}

/// A texture's size as its header claims it.
#[derive(Clone, Copy, Debug)]
struct Claim {
    width: u32,
    height: u32,
    depth: u32,
    layers: u32,
    faces: u32,
    levels: u32,
}

impl Claim {
    /// Checks the claim and returns the number of faces.
    fn check(&self) -> Result<usize, Fault> {
        self.check_images()?;
        self.check_levels()?;
        Ok(self.faces as usize)
    }

    fn check_images(&self) -> Result<(), Fault> {
        let Self {
            width,
            height,
            depth,
            layers,
            faces,
            ..
        } = *self;
        if width == 0 || height == 0 {
            return Err(Fault::new(
                format!("the header claims {width}x{height} texels"),
                "at least one texel",
            ));
        }
        if depth > 1 || layers > 1 {
            let what = format!("the header claims a depth of {depth} and {layers} layers");
            return Err(Fault::new(what, "one image or one cube"));
        }
        if faces != 1 && faces != FACE_COUNT as u32 {
            return Err(Fault::new(
                format!("the header claims {faces} faces"),
                "1 or 6",
            ));
        }
        if faces > 1 && width != height {
            return Err(Fault::new(
                format!("its faces are {width}x{height}"),
                "square faces",
            ));
        }
        Ok(())
    }

    fn check_levels(&self) -> Result<(), Fault> {
        let Self {
            width,
            height,
            faces,
            levels,
            ..
        } = *self;
        let most = LEVELS_MAX.min(u32::BITS - width.max(height).leading_zeros());
        if levels == 0 || levels > most {
            let what = format!("the header claims {levels} levels of {width}x{height} texels");
            return Err(Fault::new(
                what,
                format!("1 to {most}, each half as wide as the one before"),
            ));
        }
        // Level 0 has at least three quarters of all texels.
        let texels = u64::from(width)
            .saturating_mul(height.into())
            .saturating_mul(faces.into());
        if texels.saturating_add(texels / 3) > TEXELS_MAX {
            let what = format!(
                "the header claims {texels} texels in level 0, which take {} MiB",
                (texels * 12) >> 20
            );
            return Err(Fault::new(
                what,
                format!("at most {TEXELS_MAX} texels in all; bake a smaller map"),
            ));
        }
        Ok(())
    }

    fn size(&self, level: u32) -> [u32; 2] {
        [self.width, self.height].map(|side| (side >> level).max(1))
    }

    fn face_bytes(&self, level: u32, format: PixelFormat) -> usize {
        let [width, height] = self.size(level);
        format.image_bytes(width, height)
    }

    /// Returns the bytes of all levels of all faces, without padding.
    fn data_bytes(&self, format: PixelFormat) -> usize {
        let face: usize = (0..self.levels)
            .map(|level| self.face_bytes(level, format))
            .sum();
        face * self.faces as usize
    }

    fn faces_of(
        &self,
        level: u32,
        format: PixelFormat,
        data: &[u8],
        interpretation: &Interpretation,
    ) -> Result<Vec<RgbImage>, Fault> {
        let [width, height] = self.size(level);
        data.chunks_exact(self.face_bytes(level, format))
            .map(|face| format.image(width, height, face, interpretation))
            .collect()
    }
}

/// Joins metadata of a KTX file: the length of each pair, key and value, padded to 4 bytes.
fn pairs<'k>(keys: impl IntoIterator<Item = &'k (String, String)>) -> Vec<u8> {
    let mut pairs = Vec::new();
    for (key, value) in keys {
        let pair = [key.as_bytes(), b"\0", value.as_bytes(), b"\0"].concat();
        pairs.extend((pair.len() as u32).to_le_bytes());
        pairs.extend(pair);
        pairs.resize(pairs.len().next_multiple_of(4), 0);
    }
    pairs
}

/// Splits metadata of a KTX file, without pairs that are not text. Inverse: [`pairs`].
fn unjoined(mut bytes: &[u8]) -> Vec<(String, String)> {
    let mut keys = Vec::new();
    while let Some((length, rest)) = bytes.split_first_chunk() {
        let length = u32::from_le_bytes(*length) as usize;
        let Some(pair) = rest.get(..length) else {
            break;
        };
        let text = std::str::from_utf8(pair)
            .ok()
            .and_then(|pair| pair.split_once('\0'));
        keys.extend(
            text.map(|(key, value)| (key.to_owned(), value.trim_end_matches('\0').to_owned())),
        );
        bytes = rest.get(length.next_multiple_of(4)..).unwrap_or_default();
    }
    keys
}

/// Refuses bytes behind the last level: the header then states too little, and readers that trust
/// it mix up levels and faces.
fn left_over(count: usize, claim: &Claim, hint: &str) -> Fault {
    let Claim { faces, levels, .. } = claim;
    let what = format!("{count} bytes follow the {levels} levels of {faces} faces that it states");
    Fault::new(what, format!("a header that states all of its data{hint}"))
}

fn truncated(level: u32, needed: usize, found: usize) -> Fault {
    Fault::new(
        format!("level {level} needs {needed} bytes but has {found}"),
        "a complete file; it is probably truncated",
    )
}
