//! Files that hold a texture: its levels and faces as they stand, without a convention.
//!
//! What a header claims is checked before anything is allocated: at most [`TEXELS_MAX`] texels in all, square faces, levels that halve, and
//! bytes that are there and that no two levels share.

mod dds;
mod ktx1;
mod ktx2;
mod texel;

pub use texel::{TEXELS, Texel};

use crate::environment::{FORMATS as IMAGES, Format as Image};
use crate::pixels::{Decoded, Fault, PixelsError, RgbImage, png, read_bounded};
use std::path::Path;

/// Most texels of all levels and faces, 128 MiB as radiance: a cube of 1024 with its levels has 8.4 million. A score takes seven times
/// as much.
pub const TEXELS_MAX: u64 = (1 << 25) / 3;
/// Longest chain of levels: those of the longest side.
const LEVELS_MAX: u32 = 16;

/// A texture as its file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Levels, largest first, each with one image or with the six of a cube in the order +x, -x, +y, -y, +z, -z.
    pub levels: Vec<Vec<RgbImage>>,
    /// Name of the pixel format.
    pub texel: &'static str,
}

impl Texture {
    /// Whether it has faces.
    pub fn is_cube(&self) -> bool {
        self.levels[0].len() == FACE_COUNT
    }
}

/// Faces of a cube.
pub const FACE_COUNT: usize = 6;

/// A container by the extension of its files.
#[derive(Debug)]
pub struct Format {
    pub name: &'static str,
    /// Lower-case file name extension.
    pub extension: &'static str,
    /// One sentence for help and docs.
    pub about: &'static str,
    read: fn(&[u8]) -> Result<Texture, Fault>,
    /// Whether it knows pixel formats by DXGI's codes only.
    pub needs_dxgi: bool,
    /// The bytes of a file; DDS has no room for keys.
    pub write: fn(&Encoding) -> Vec<u8>,
}

/// A texture to write.
#[derive(Clone, Copy, Debug)]
pub struct Encoding<'a> {
    pub texel: &'static Texel,
    /// Levels, largest first, each with one image or with six faces.
    pub levels: &'a [Vec<RgbImage>],
    /// What the file says of itself.
    pub keys: &'a [(String, String)],
    /// Whether levels are packed by zstd, where the container can.
    pub is_packed: bool,
}

/// Every container; images are those of an environment ([`IMAGES`]) and PNG.
pub static FORMATS: &[Format] = &[
    Format {
        name: "ktx2",
        extension: "ktx2",
        about: "KTX 2: one image or a cube with its levels, plain or zstd",
        read: ktx2::read,
        needs_dxgi: false,
        write: ktx2::write,
    },
    Format {
        name: "ktx",
        extension: "ktx",
        about: "KTX 1, as cmgen writes it: a cube with its levels",
        read: ktx1::read,
        needs_dxgi: false,
        write: ktx1::write,
    },
    Format {
        name: "dds",
        extension: "dds",
        about: "DDS: one image, a face of a cube, or a cube with its levels",
        read: dds::read,
        needs_dxgi: true,
        write: dds::write,
    },
];

/// Extensions of every file that [`read_texture`] reads.
pub fn extensions() -> Vec<&'static str> {
    let containers = FORMATS.iter().map(|format| format.extension);
    containers.chain(IMAGES.iter().map(|format| format.extension)).chain([PNG]).collect()
}

const PNG: &str = "png";

/// Reads the texture at `path`, whose extension names the format.
pub fn read_texture(path: &Path) -> Result<Texture, PixelsError> {
    // Before the file is opened: a folder of other things is refused by its names.
    let reader = reader(path);
    if reader.is_err() && !path.exists() {
        read_bounded(path)?;
    }
    read_with(&reader?, path, &read_bounded(path)?)
}

/// The texture in the bytes of the file at `path`, whose extension names the format. Nothing is read from disk.
pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Texture, PixelsError> {
    read_with(&reader(path)?, path, bytes)
}

enum Reader {
    Container(&'static Format),
    Image(&'static Image),
    Png,
}

fn reader(path: &Path) -> Result<Reader, PixelsError> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default();
    let container = FORMATS.iter().find(|format| format.extension == extension).map(Reader::Container);
    let image = || IMAGES.iter().find(|format| format.extension == extension).map(Reader::Image);
    container.or_else(image).or_else(|| (extension == PNG).then_some(Reader::Png)).ok_or_else(|| {
        let known: Vec<String> = extensions().iter().map(|extension| format!(".{extension}")).collect();
        Fault::new(format!("its extension is {extension:?}"), format!("one of {}", known.join(", "))).at(path)
    })
}

fn read_with(reader: &Reader, path: &Path, bytes: &[u8]) -> Result<Texture, PixelsError> {
    let image = |decoded: Decoded, texel| Texture { levels: vec![vec![decoded.rgb]], texel };
    let texture = match reader {
        Reader::Container(format) => (format.read)(bytes).map_err(|fault| fault.at(path))?,
        Reader::Image(format) => image(format.read(path, bytes)?, format.name),
        Reader::Png => image(png::read_linear(path, bytes)?, PNG),
    };
    // Containers are asked before they are read; images may be as large as an environment.
    let texels: usize = texture.levels.iter().flatten().map(|face| face.data.len()).sum();
    if texels as u64 > TEXELS_MAX {
        let fault = Fault::new(format!("it has {texels} texels"), format!("at most {TEXELS_MAX}; bake a smaller map"));
        return Err(fault.at(path));
    }
    first_oddity(&texture).map_or(Ok(()), |fault| Err(fault.at(path)))?;
    Ok(texture)
}

/// The first texel that is no number.
fn first_oddity(texture: &Texture) -> Option<Fault> {
    for (level, faces) in texture.levels.iter().enumerate() {
        for (face, image) in faces.iter().enumerate() {
            let Some(at) = image.data.iter().position(|texel| texel.iter().any(|value| !value.is_finite())) else {
                continue;
            };
            let (x, y) = (at % image.width as usize, at / image.width as usize);
            return Some(Fault::new(
                format!("level {level}, face {face}, column {x}, row {y} is {:?}", image.data[at]),
                "finite values (a sun above 65504 overflows a half: clip the environment before the bake)",
            ));
        }
    }
    None
}

/// What a header claims of its texture.
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
    /// Faces that are read, or what is wrong.
    fn check(&self) -> Result<usize, Fault> {
        let Self { width, height, depth, layers, faces, levels } = *self;
        if width == 0 || height == 0 {
            return Err(Fault::new(format!("the header claims {width}x{height} texels"), "at least one texel"));
        }
        if depth > 1 || layers > 1 {
            let what = format!("the header claims a depth of {depth} and {layers} layers");
            return Err(Fault::new(what, "one image or one cube"));
        }
        if faces != 1 && faces != FACE_COUNT as u32 {
            return Err(Fault::new(format!("the header claims {faces} faces"), "1 or 6"));
        }
        if faces > 1 && width != height {
            return Err(Fault::new(format!("its faces are {width}x{height}"), "square faces"));
        }
        let most = LEVELS_MAX.min(u32::BITS - width.max(height).leading_zeros());
        if levels == 0 || levels > most {
            let what = format!("the header claims {levels} levels of {width}x{height} texels");
            return Err(Fault::new(what, format!("1 to {most}, each half as wide as the one before")));
        }
        // The first level is three quarters of them or more.
        let texels = u64::from(width).saturating_mul(height.into()).saturating_mul(faces.into());
        if texels.saturating_add(texels / 3) > TEXELS_MAX {
            let what = format!("the header claims {texels} texels in level 0, which take {} MiB", (texels * 12) >> 20);
            return Err(Fault::new(what, format!("at most {TEXELS_MAX} texels in all; bake a smaller map")));
        }
        Ok(faces as usize)
    }

    /// Width and height of a level.
    fn size(&self, level: u32) -> [u32; 2] {
        [self.width, self.height].map(|side| (side >> level).max(1))
    }

    /// Bytes of one face of a level.
    fn face_bytes(&self, level: u32, texel: &Texel) -> usize {
        let [width, height] = self.size(level);
        width as usize * height as usize * texel.bytes
    }
}

/// A file that ends before its texels do.
fn truncated(level: u32, needed: usize, found: usize) -> Fault {
    Fault::new(
        format!("level {level} needs {needed} bytes, and {found} are there"),
        "a whole file; it is probably truncated",
    )
}
