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
/// `D3DFORMAT` and DXGI code of the formats that need no second header.
const OLD: [(u32, u32); 4] = [(112, 34), (113, 10), (115, 16), (116, 2)];

pub fn read(bytes: &[u8]) -> Result<Texture, Fault> {
    let whole = || Fault::new("has no complete DDS header", "a DDS file");
    let words_of = |count: usize| -> Option<(Vec<u32>, &[u8])> {
        let (header, rest) = bytes.split_at_checked(4 * count)?;
        Some((
            header
                .as_chunks()
                .0
                .iter()
                .map(|word| u32::from_le_bytes(*word))
                .collect(),
            rest,
        ))
    };
    let (header, _) = words_of(WORDS).ok_or_else(whole)?;
    let [magic, size, flags, height, width, _, depth, levels, ..] = header[..] else {
        return Err(whole());
    };
    if magic != MAGIC || size != HEADER_BYTES {
        return Err(whole());
    }
    let (fourcc, caps2) = (header[21], header[28]);
    let is_dx10 = fourcc == DX10;
    let (header, mut rest) =
        words_of(if is_dx10 { WORDS_DX10 } else { WORDS }).ok_or_else(whole)?;
    let is_cube = caps2 & CUBE != 0 || (is_dx10 && header[WORDS + 2] & CUBE_DX10 != 0);
    if is_cube && !is_dx10 && caps2 & ALL_FACES != ALL_FACES {
        return Err(Fault::new(
            "it is a cube without all of its faces",
            "all six faces",
        ));
    }
    let claim = Claim {
        width,
        height,
        depth: if flags & HAS_DEPTH == 0 { 1 } else { depth },
        layers: if is_dx10 { header[WORDS + 3] } else { 1 },
        faces: if is_cube { FACE_COUNT as u32 } else { 1 },
        levels: if flags & HAS_MIPS == 0 {
            1
        } else {
            levels.max(1)
        },
    };
    let faces = claim.check()?;
    let format = if is_dx10 {
        Some(header[WORDS])
    } else {
        OLD.iter().find(|old| old.0 == fourcc).map(|old| old.1)
    };
    let found = if is_dx10 {
        format!("DXGI format {}", header[WORDS])
    } else {
        format!("code {fourcc:#010x}")
    };
    let is_found = |texel: &Texel| texel.dxgi.is_some() && texel.dxgi == format;
    let texel = Texel::of(is_found, || format!("its pixel format is {found}"))?;
    let mut read = vec![Vec::new(); claim.levels as usize];
    for _ in 0..faces {
        for level in 0..claim.levels {
            let needed = claim.face_bytes(level, texel);
            let (face, after) = rest
                .split_at_checked(needed)
                .ok_or_else(|| truncated(level, needed, rest.len()))?;
            let [width, height] = claim.size(level);
            read[level as usize].push(texel.image(width, height, face)?);
            rest = after;
        }
    }
    Ok(Texture {
        levels: read,
        texel: texel.name,
        keys: Vec::new(),
    })
}

/// Writes a texture whose format has a DXGI code. DDS has no keys.
pub fn write(encoding: &Encoding) -> Vec<u8> {
    let Encoding { texel, levels, .. } = encoding;
    let (first, faces, count) = (&levels[0][0], levels[0].len(), levels.len() as u32);
    let (is_cube, has_mips) = (faces == FACE_COUNT, count > 1);
    let with = |bits: u32, is_set: bool| if is_set { bits } else { 0 };
    let flags = HAS_REQUIRED | with(HAS_MIPS, has_mips);
    let size = [
        first.height,
        first.width,
        first.width * texel.bytes as u32,
        0,
        count,
    ];
    let caps = TEXTURE | with(COMPLEX, is_cube || has_mips) | with(MIPMAP, has_mips);
    let caps = [caps, with(CUBE | ALL_FACES, is_cube), 0, 0, 0];
    let code = texel.dxgi.expect("a format with a code");
    // Six faces are one array element here.
    let dx10 = [code, TEXTURE_2D, with(CUBE_DX10, is_cube), 1, OPAQUE];
    // Some engines do not read the second header.
    let (format, dx10) = match OLD.iter().find(|old| old.1 == code) {
        Some((fourcc, _)) => ([HAS_FOURCC, *fourcc, 0], &[][..]),
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
    file.extend((0..faces).flat_map(|face| {
        levels
            .iter()
            .flat_map(move |level| texel.bytes_of(&level[face]))
    }));
    file
}
