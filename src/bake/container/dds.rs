//! DDS: face by face, each with all of its levels [Microsoft, "Programming Guide for DDS"].
//!
//! A magic word, a header of 31 words, and in `DX10` files a second header of 5 words; all
//! little-endian.

use super::texel::Texel;
use super::{Claim, Encoding, FACE_COUNT, Texture, truncated};
use crate::base::pixels::Fault;

const MAGIC: u32 = u32::from_le_bytes(*b"DDS ");
/// Pixel format code of files with the second header.
const DX10: u32 = u32::from_le_bytes(*b"DX10");
/// Words of the headers, magic word included.
const WORDS: usize = 32;
const WORDS_DX10: usize = WORDS + 5;

const HEADER_BYTES: u32 = 124;
const FORMAT_BYTES: u32 = 32;

// Header flags.
const HAS_MIPS: u32 = 0x2_0000;
const HAS_DEPTH: u32 = 0x80_0000;
/// Caps, height, width, pitch and pixel format.
const HAS_REQUIRED: u32 = 0x100f;
// Pixel format flags.
const HAS_FOURCC: u32 = 0x4;
const IS_RGB: u32 = 0x40;
// Caps.
const COMPLEX: u32 = 0x8;
const TEXTURE: u32 = 0x1000;
const MIPMAP: u32 = 0x40_0000;
const CUBE: u32 = 0x200;
const ALL_FACES: u32 = 0xfc00;
// Values of the second header.
const TEXTURE_2D: u32 = 3;
const CUBE_DX10: u32 = 0x4;
const OPAQUE: u32 = 3;
/// A format that needs no second header.
struct OldFormat {
    d3d: u32,
    dxgi: u32,
}

const fn old(d3d: u32, dxgi: u32) -> OldFormat {
    OldFormat { d3d, dxgi }
}

const OLD: [OldFormat; 4] = [old(112, 34), old(113, 10), old(115, 16), old(116, 2)];

fn words(bytes: &[u8]) -> Vec<u32> {
    bytes
        .as_chunks()
        .0
        .iter()
        .map(|word| u32::from_le_bytes(*word))
        .collect()
}

/// What the headers say.
struct Header {
    claim: Claim,
    texel: &'static Texel,
    /// Bytes of both headers.
    length: usize,
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let incomplete = || Fault::new("has no complete DDS header", "a DDS file");
        let first = words(bytes.get(..4 * WORDS).ok_or_else(incomplete)?);
        let [magic, size, flags, height, width, _, depth, levels, ..] = first[..] else {
            return Err(incomplete());
        };
        if magic != MAGIC || size != HEADER_BYTES {
            return Err(incomplete());
        }
        let fourcc = first[21];
        let caps2 = first[28];
        let has_second = fourcc == DX10;
        let length = 4 * if has_second { WORDS_DX10 } else { WORDS };
        let second = words(bytes.get(4 * WORDS..length).ok_or_else(incomplete)?);
        let is_dx10_cube = has_second && second[2] & CUBE_DX10 != 0;
        let is_cube = caps2 & CUBE != 0 || is_dx10_cube;
        if is_cube && !has_second && caps2 & ALL_FACES != ALL_FACES {
            return Err(Fault::new(
                "it is a cube without all of its faces",
                "all six faces",
            ));
        }
        let claim = Claim {
            width,
            height,
            depth: if flags & HAS_DEPTH == 0 { 1 } else { depth },
            layers: if has_second { second[3] } else { 1 },
            faces: if is_cube { FACE_COUNT as u32 } else { 1 },
            levels: if flags & HAS_MIPS == 0 {
                1
            } else {
                levels.max(1)
            },
        };
        claim.check()?;
        let texel = if has_second {
            texel_of(Some(second[0]), || format!("DXGI format {}", second[0]))?
        } else {
            let format = OLD.iter().find(|old| old.d3d == fourcc);
            texel_of(format.map(|old| old.dxgi), || {
                format!("code {fourcc:#010x}")
            })?
        };
        Ok(Self {
            claim,
            texel,
            length,
        })
    }
}

/// Finds the pixel format of a DXGI code; `name` describes what the file says.
fn texel_of(dxgi: Option<u32>, name: impl Fn() -> String) -> Result<&'static Texel, Fault> {
    Texel::with_code(
        |texel| texel.dxgi.is_some() && texel.dxgi == dxgi,
        || format!("its pixel format is {}", name()),
    )
}

/// Reads a file of 1 or 6 faces.
pub fn read(bytes: &[u8]) -> Result<Texture, Fault> {
    let Header {
        claim,
        texel,
        length,
    } = Header::read(bytes)?;
    let mut rest = &bytes[length..];
    let mut levels = vec![Vec::new(); claim.levels as usize];
    for _ in 0..claim.faces {
        for level in 0..claim.levels {
            let needed = claim.face_bytes(level, texel);
            let (face, after) = rest
                .split_at_checked(needed)
                .ok_or_else(|| truncated(level, needed, rest.len()))?;
            let [width, height] = claim.size(level);
            levels[level as usize].push(texel.image(width, height, face)?);
            rest = after;
        }
    }
    Ok(Texture {
        levels,
        texel: texel.name,
        keys: Vec::new(),
    })
}

/// Writes a texture whose format has a DXGI code. DDS has no keys.
pub fn write(encoding: &Encoding) -> Vec<u8> {
    let Encoding { texel, levels, .. } = encoding;
    let first = &levels[0][0];
    let face_count = levels[0].len();
    let level_count = levels.len() as u32;
    let is_cube = face_count == FACE_COUNT;
    let has_mips = level_count > 1;
    let with = |bits: u32, is_set: bool| if is_set { bits } else { 0 };
    let flags = HAS_REQUIRED | with(HAS_MIPS, has_mips);
    let size = [
        first.height,
        first.width,
        first.width * texel.bytes as u32,
        0,
        level_count,
    ];
    let caps = TEXTURE | with(COMPLEX, is_cube || has_mips) | with(MIPMAP, has_mips);
    let caps = [caps, with(CUBE | ALL_FACES, is_cube), 0, 0, 0];
    let code = texel.dxgi.expect("a format with a code");
    // Six faces are one array element here.
    let dx10 = [code, TEXTURE_2D, with(CUBE_DX10, is_cube), 1, OPAQUE];
    // Some engines do not read the second header.
    let (format, dx10) = match OLD.iter().find(|old| old.dxgi == code) {
        Some(old) => ([HAS_FOURCC, old.d3d, 0], &[][..]),
        None => (
            [HAS_FOURCC | IS_RGB, DX10, 8 * texel.bytes as u32],
            &dx10[..],
        ),
    };
    let words = [
        &[MAGIC, HEADER_BYTES, flags][..],
        &size,
        &[0; 11],
        &[FORMAT_BYTES],
        &format,
        &[0; 4],
        &caps,
        dx10,
    ]
    .concat();
    let mut file: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    file.extend((0..face_count).flat_map(|face| {
        levels
            .iter()
            .flat_map(move |level| texel.bytes_of(&level[face]))
    }));
    file
}
