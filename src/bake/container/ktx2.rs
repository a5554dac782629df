//! KTX 2: levels anywhere in the file, plain or compressed by zstd or zlib.

use super::byte_color::ByteColor;
use super::interpretation::Interpretation;
use super::pixel_format::PixelFormat;
use super::texel::Texel;
use super::{Claim, Encoding, Texture, left_over, pairs, truncated, unjoined};
use crate::base::names::Listed;
use crate::base::pixels::{Fault, Pixels, reserved};
use flate2::read::ZlibDecoder;
use half::f16;
use ktx2::dfd::{Basic, Block};
use ktx2::{Header, Index, LevelIndex, ParseError, SupercompressionScheme};
use ruzstd::decoding::StreamingDecoder;
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use std::borrow::Cow;
use std::io::Read;

/// First bytes of a file.
pub const IDENTIFIER: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";

/// Reads a file of 1 or 6 faces.
pub fn read(bytes: &[u8], byte_color: Option<ByteColor>) -> Result<Texture, Fault> {
    // The crate's own reader panics at unexpected data format descriptors.
    let header = bytes
        .first_chunk()
        .ok_or(ParseError::UnexpectedEnd)
        .and_then(Header::from_bytes)
        .map_err(unreadable)?;
    let claim = Claim {
        width: header.pixel_width,
        height: header.pixel_height,
        depth: header.pixel_depth,
        layers: header.layer_count,
        faces: header.face_count,
        levels: header.level_count.max(1),
    };
    let face_count = claim.check()?;
    let descriptor = descriptor(bytes, &header);
    if let Some([model, ..]) = descriptor {
        check_model(model)?;
    }
    let keys = keys(bytes, &header);
    let byte_color = ByteColor::of_keys(&keys, byte_color);
    let format = PixelFormat::of_vulkan(header.format, byte_color)?;
    let mut interpretation = Interpretation::of_keys(&keys);
    if let Some(descriptor) = descriptor {
        interpretation.take_descriptor(descriptor)?;
    }
    let packing = Packing::of(&header)?;
    let stored = stored_levels(bytes, claim.levels)?;
    check_apart(bytes, &stored)?;
    check_end(bytes, &header, &claim, &stored)?;
    let mut levels = Vec::new();
    for (level, stored) in (0..).zip(stored) {
        let needed = claim.face_bytes(level, format) * face_count;
        let data = match packing {
            Packing::Plain => Cow::Borrowed(stored),
            Packing::Zstd => Cow::Owned(unpacked_zstd(stored, needed, level)?),
            Packing::Zlib => Cow::Owned(unpacked(ZlibDecoder::new(stored), needed, level)?),
        };
        if data.len() != needed {
            return Err(truncated(level, needed, data.len()));
        }
        levels.push(claim.faces_of(level, format, &data, &interpretation)?);
    }
    Ok(interpretation.warn(Texture {
        levels,
        texel: format.name(),
        keys,
        warnings: Vec::new(),
    }))
}

fn unreadable(error: ParseError) -> Fault {
    Fault::new(format!("cannot be read ({error})"), "a complete KTX 2 file")
}

/// How levels are compressed.
#[derive(Clone, Copy)]
enum Packing {
    Plain,
    Zstd,
    Zlib,
}

impl Packing {
    fn of(header: &Header) -> Result<Self, Fault> {
        match header.supercompression_scheme {
            None => Ok(Self::Plain),
            Some(SupercompressionScheme::Zstandard) => Ok(Self::Zstd),
            Some(SupercompressionScheme::ZLIB) => Ok(Self::Zlib),
            Some(other) => Err(Fault::new(
                format!("its supercompression is {other:?}"),
                "none, zstd or zlib",
            )),
        }
    }
}

/// A form of texels that a program transcodes before it is drawn.
struct UniversalModel {
    /// Code of the colour model in the data format descriptor.
    code: u8,
    name: &'static str,
}

const UNIVERSAL: [UniversalModel; 4] = [
    UniversalModel {
        code: 163,
        name: "ETC1S (BasisLZ), 8 bits without light above white",
    },
    UniversalModel {
        code: 166,
        name: "UASTC, 8 bits without light above white",
    },
    UniversalModel {
        code: 167,
        name: "UASTC HDR of 4x4 texels",
    },
    UniversalModel {
        code: 168,
        name: "UASTC HDR of 6x6 texels",
    },
];

/// Refuses texels that must be transcoded, by their name.
fn check_model(code: u8) -> Result<(), Fault> {
    match UNIVERSAL.iter().find(|model| model.code == code) {
        None => Ok(()),
        Some(model) => Err(Fault::new(
            format!("its texels are {}", model.name),
            "floats (`ktx create --format R16G16B16A16_SFLOAT`)",
        )),
    }
}

/// Position of colour model, primaries, transfer function and flags in the descriptor: after the
/// descriptor's length and two words.
const DESCRIPTOR_COLORS: usize = 12;

/// Reads colour model, primaries, transfer function and flags; `None` without a basic descriptor.
fn descriptor(bytes: &[u8], header: &Header) -> Option<[u8; 4]> {
    let Index {
        dfd_byte_offset,
        dfd_byte_length,
        ..
    } = header.index;
    bytes
        .get(dfd_byte_offset as usize..)?
        .get(..dfd_byte_length as usize)?
        .get(DESCRIPTOR_COLORS..)?
        .first_chunk()
        .copied()
}

/// Refuses bytes behind everything that the header states.
fn check_end(bytes: &[u8], header: &Header, claim: &Claim, stored: &[&[u8]]) -> Result<(), Fault> {
    let Index {
        dfd_byte_offset,
        dfd_byte_length,
        kvd_byte_offset,
        kvd_byte_length,
        sgd_byte_offset,
        sgd_byte_length,
    } = header.index;
    let sections = [
        u64::from(dfd_byte_offset) + u64::from(dfd_byte_length),
        u64::from(kvd_byte_offset) + u64::from(kvd_byte_length),
        sgd_byte_offset.saturating_add(sgd_byte_length),
    ];
    let levels = stored
        .iter()
        .map(|level| (level.as_ptr() as usize - bytes.as_ptr() as usize + level.len()) as u64);
    let end = levels.chain(sections).max().unwrap_or_default();
    match bytes.len() as u64 - end.min(bytes.len() as u64) {
        0 => Ok(()),
        count => Err(left_over(count as usize, claim, "")),
    }
}

/// Finds the bytes of each level.
fn stored_levels(bytes: &[u8], level_count: u32) -> Result<Vec<&[u8]>, Fault> {
    let truncated = || unreadable(ParseError::UnexpectedEnd);
    let end = Header::LENGTH + LevelIndex::LENGTH * level_count as usize;
    let index = bytes.get(Header::LENGTH..end).ok_or_else(truncated)?;
    index
        .as_chunks()
        .0
        .iter()
        .map(|entry| stored_level(bytes, entry).ok_or_else(truncated))
        .collect()
}

fn stored_level<'b>(bytes: &'b [u8], entry: &[u8; LevelIndex::LENGTH]) -> Option<&'b [u8]> {
    let LevelIndex {
        byte_offset,
        byte_length,
        ..
    } = LevelIndex::from_bytes(entry);
    let end = byte_offset.checked_add(byte_length)?;
    bytes.get(byte_offset as usize..usize::try_from(end).ok()?)
}

/// Reads the metadata; empty if its place is outside the file.
fn keys(bytes: &[u8], header: &Header) -> Vec<(String, String)> {
    let Index {
        kvd_byte_offset,
        kvd_byte_length,
        ..
    } = header.index;
    bytes
        .get(kvd_byte_offset as usize..)
        .and_then(|keys| keys.get(..kvd_byte_length as usize))
        .map(unjoined)
        .unwrap_or_default()
}

/// Writes header, level index, format descriptor, keys, and the levels, smallest first [KTX 2.0,
/// section 3].
pub fn write(encoding: &Encoding) -> Vec<u8> {
    let Encoding {
        texel,
        levels,
        keys,
        is_packed,
    } = encoding;
    let first = &levels[0][0];
    let bytes: Vec<Vec<u8>> = levels
        .iter()
        .map(|faces| faces.iter().flat_map(|face| texel.bytes_of(face)).collect())
        .collect();
    let size = Size {
        width: first.width,
        height: first.height,
        face_count: levels[0].len() as u32,
    };
    file(texel, size, &bytes, keys, *is_packed)
}

/// Writes a table of four channels as a KTX 2 file in half floats.
pub fn write_table(table: &Pixels<[f32; 4]>) -> Vec<u8> {
    let bytes = table
        .data
        .iter()
        .flatten()
        .flat_map(|value| f16::from_f32(*value).to_le_bytes())
        .collect();
    let size = Size {
        width: table.width,
        height: table.height,
        face_count: 1,
    };
    file(Texel::listed("rgba16f"), size, &[bytes], &[], false)
}

/// Size of a texture, texels and faces.
struct Size {
    width: u32,
    height: u32,
    face_count: u32,
}

/// Lays out a file of the bytes of its levels.
fn file(
    texel: &Texel,
    size: Size,
    levels: &[Vec<u8>],
    keys: &[(String, String)],
    is_packed: bool,
) -> Vec<u8> {
    let (basic, type_size) = Basic::from_format(texel.vulkan).expect("a format of the list");
    let block = Block::Basic(basic).to_vec();
    let dfd = [&(block.len() as u32 + 4).to_le_bytes()[..], &block].concat();
    let mut keys: Vec<_> = keys.iter().collect();
    keys.sort();
    let kvd = pairs(keys);
    let dfd_start = Header::LENGTH + LevelIndex::LENGTH * levels.len();
    let kvd_start = dfd_start + dfd.len();
    let header = Header {
        format: Some(texel.vulkan),
        type_size,
        pixel_width: size.width,
        pixel_height: size.height,
        pixel_depth: 0,
        layer_count: 0,
        face_count: size.face_count,
        level_count: levels.len() as u32,
        supercompression_scheme: is_packed.then_some(SupercompressionScheme::Zstandard),
        index: Index {
            dfd_byte_offset: dfd_start as u32,
            dfd_byte_length: dfd.len() as u32,
            kvd_byte_offset: if kvd.is_empty() { 0 } else { kvd_start as u32 },
            kvd_byte_length: kvd.len() as u32,
            sgd_byte_offset: 0,
            sgd_byte_length: 0,
        },
    };
    let data_start = kvd_start + kvd.len();
    let (index, data) = laid_out(texel, levels, data_start, is_packed);
    [
        &header.as_bytes()[..],
        index.as_flattened(),
        &dfd,
        &kvd,
        &data,
    ]
    .concat()
}

type IndexEntry = [u8; LevelIndex::LENGTH];

/// Lays out levels, smallest first, from a position of the file: their index and bytes.
fn laid_out(
    texel: &Texel,
    levels: &[Vec<u8>],
    start: usize,
    is_packed: bool,
) -> (Vec<IndexEntry>, Vec<u8>) {
    // Levels are aligned to a texel's bytes and 4; packed ones are not (KTX 2, section 3.9.7).
    let alignment = if is_packed {
        1
    } else {
        texel.bytes << 2u32.saturating_sub(texel.bytes.trailing_zeros())
    };
    let mut end = start;
    let mut data = Vec::new();
    let mut index = vec![[0; LevelIndex::LENGTH]; levels.len()];
    for (level, plain) in levels.iter().enumerate().rev() {
        let stored = if is_packed {
            Cow::Owned(compress_to_vec(&plain[..], CompressionLevel::Fastest))
        } else {
            Cow::Borrowed(&plain[..])
        };
        let start = end.next_multiple_of(alignment);
        data.resize(data.len() + start - end, 0);
        end = start + stored.len();
        index[level] = LevelIndex {
            byte_offset: start as u64,
            byte_length: stored.len() as u64,
            uncompressed_byte_length: plain.len() as u64,
        }
        .as_bytes();
        data.extend_from_slice(&stored);
    }
    (index, data)
}

/// The bytes of a level in a file.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct LevelRange {
    start: usize,
    end: usize,
    level: usize,
}

/// Refuses levels that share bytes: a file of a kilobyte could claim gigabytes.
fn check_apart(bytes: &[u8], levels: &[&[u8]]) -> Result<(), Fault> {
    let mut ranges: Vec<LevelRange> = levels
        .iter()
        .enumerate()
        .map(|(level, data)| {
            let start = data.as_ptr() as usize - bytes.as_ptr() as usize;
            LevelRange {
                start,
                end: start + data.len(),
                level,
            }
        })
        .collect();
    ranges.sort_unstable();
    for pair in ranges.windows(2) {
        let [before, next] = [&pair[0], &pair[1]];
        if before.end > next.start {
            return Err(Fault::new(
                format!(
                    "levels {} and {} share bytes {} to {}",
                    before.level, next.level, next.start, before.end
                ),
                "levels apart",
            ));
        }
    }
    Ok(())
}

fn not_unpacked(level: u32, error: &dyn std::fmt::Display) -> Fault {
    Fault::new(
        format!("level {level} cannot be unpacked ({error})"),
        "packed data of its size",
    )
}

/// Unpacks a level with a window no larger than it needs.
fn unpacked_zstd(packed: &[u8], needed: usize, level: u32) -> Result<Vec<u8>, Fault> {
    let window = (needed as u64).next_power_of_two().max(WINDOW_MIN);
    let decoder = StreamingDecoder::new_with_max_window_size(packed, window)
        .map_err(|error| not_unpacked(level, &error))?;
    unpacked(decoder, needed, level)
}

/// Unpacks exactly `needed` bytes of a level.
fn unpacked(decoder: impl Read, needed: usize, level: u32) -> Result<Vec<u8>, Fault> {
    let mut data = reserved(needed + 1)?;
    // One more byte detects a level that is too long.
    decoder
        .take(needed as u64 + 1)
        .read_to_end(&mut data)
        .map_err(|error| not_unpacked(level, &error))?;
    if data.len() > needed {
        return Err(Fault::new(
            format!("level {level} unpacks to more than its {needed} bytes"),
            "packed data of its size",
        ));
    }
    Ok(data)
}

/// Smallest window that encoders use at higher levels.
const WINDOW_MIN: u64 = 1 << 23;
