//! DDS: face by face, each with all of its levels [Microsoft, "Programming Guide for DDS"].
//!
//! A magic word, a header of 31 words, and in `DX10` files a second header of 5 words; all
//! little-endian.

use super::interpretation::Interpretation;
use super::pixel_format::PixelFormat;
use super::{Claim, Encoding, FACE_COUNT, LEVELS_MAX, Texture, left_over, truncated};
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
const PREMULTIPLIED: u32 = 2;
const ALPHA_MODE: u32 = 7;

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
    format: PixelFormat,
    interpretation: Interpretation,
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
            levels: levels.max(1),
        };
        let format = if has_second {
            PixelFormat::of_dxgi(Some(second[0]), || format!("DXGI format {}", second[0]))
        } else {
            format_of_direct3d_9(fourcc)
        };
        let mut interpretation = Interpretation::default();
        if has_second && second[4] & ALPHA_MODE == PREMULTIPLIED {
            interpretation.take_premultiplied();
        }
        let data_bytes = bytes.len() - length;
        let claim = match &format {
            Ok(format) if claim.layers == FACE_COUNT as u32 => {
                as_one_cube(claim, *format, data_bytes, &mut interpretation)
            }
            _ => claim,
        };
        let one_level = Claim { levels: 1, ..claim };
        one_level.check()?;
        let format = format?;
        // Some writers count levels without the flag that says so, others leave any number in the
        // field: without the flag the length of the data decides.
        let has_one = flags & HAS_MIPS == 0
            && (claim.check().is_err() || one_level.data_bytes(format) == data_bytes);
        let claim = if has_one { one_level } else { claim };
        claim.check()?;
        Ok(Self {
            claim,
            format,
            interpretation,
            length,
        })
    }
}

/// Returns the format that a header without a second one names by its `fourCC`, which holds four
/// letters or a number of Direct3D 9's D3DFORMAT.
fn format_of_direct3d_9(fourcc: u32) -> Result<PixelFormat, Fault> {
    let old = OLD.iter().find(|old| old.d3d == fourcc);
    PixelFormat::of_dxgi(old.map(|old| old.dxgi), || format!("code {fourcc:#010x}"))
}

/// Takes an array of six elements as one cube, if the data hold no more: NVIDIA's texture tools, old
/// versions of Compressonator and others count faces where the format counts cubes, and some leave
/// the flag of a cube out.
fn as_one_cube(
    claim: Claim,
    format: PixelFormat,
    data_bytes: usize,
    interpretation: &mut Interpretation,
) -> Claim {
    let cube = Claim {
        layers: 1,
        faces: FACE_COUNT as u32,
        ..claim
    };
    let is_array_of_cubes =
        claim.faces == cube.faces && data_bytes >= claim.layers as usize * cube.data_bytes(format);
    if is_array_of_cubes || cube.check_images().is_err() {
        return claim;
    }
    interpretation.warn_of(if claim.faces == cube.faces {
        "its header counts six cubes (arraySize 6), but it holds the faces of one; read as one cube"
    } else {
        "it is an array of six squares, not marked as a cube; read as the faces +x -x +y -y +z -z"
    });
    cube
}

/// Says which numbers of faces and levels these bytes would be.
fn fitting(claim: &Claim, format: PixelFormat, length: usize) -> Option<Claim> {
    let levels = 1..=LEVELS_MAX;
    let claims = levels.flat_map(|levels| {
        [1, FACE_COUNT as u32].map(|faces| Claim {
            levels,
            faces,
            ..*claim
        })
    });
    claims
        .filter(|claim| claim.check().is_ok())
        .find(|claim| claim.data_bytes(format) == length)
}

/// Reads a file of 1 or 6 faces.
pub fn read(bytes: &[u8]) -> Result<Texture, Fault> {
    let Header {
        claim,
        format,
        interpretation,
        length,
    } = Header::read(bytes)?;
    let mut rest = &bytes[length..];
    let stated_bytes = claim.data_bytes(format);
    if rest.len() > stated_bytes {
        let hint = match fitting(&claim, format, rest.len()) {
            Some(Claim { faces, levels, .. }) => {
                format!("; its bytes are {levels} levels of {faces} faces")
            }
            None => String::new(),
        };
        return Err(left_over(rest.len() - stated_bytes, &claim, &hint));
    }
    let mut levels = vec![Vec::new(); claim.levels as usize];
    for _ in 0..claim.faces {
        for level in 0..claim.levels {
            let needed = claim.face_bytes(level, format);
            let (face, after) = rest
                .split_at_checked(needed)
                .ok_or_else(|| truncated(level, needed, rest.len()))?;
            let [width, height] = claim.size(level);
            levels[level as usize].push(format.image(width, height, face, &interpretation)?);
            rest = after;
        }
    }
    Ok(interpretation.warn(Texture {
        levels,
        texel: format.name(),
        keys: Vec::new(),
        warnings: Vec::new(),
    }))
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
