//! KTX 2: levels anywhere in the file, plain or compressed by zstd.

use super::texel::Texel;
use super::{Claim, Encoding, Texture, pairs, truncated, unjoined};
use crate::base::names::Listed;
use crate::base::pixels::{Fault, Pixels, RgbImage, reserved};
use half::f16;
use ktx2::dfd::{Basic, Block};
use ktx2::{Header, Index, LevelIndex, ParseError, SupercompressionScheme};
use ruzstd::decoding::StreamingDecoder;
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use std::borrow::Cow;
use std::io::Read;

pub fn read(bytes: &[u8]) -> Result<Texture, Fault> {
    let no_file = |error: ParseError| {
        Fault::new(format!("cannot be read ({error})"), "a complete KTX 2 file")
    };
    let whole = |found: Option<_>| found.ok_or(ParseError::UnexpectedEnd).map_err(no_file);
    // The crate's own reader panics at unexpected data format descriptors.
    let header = bytes
        .first_chunk()
        .ok_or(ParseError::UnexpectedEnd)
        .and_then(Header::from_bytes)
        .map_err(no_file)?;
    let claim = Claim {
        width: header.pixel_width,
        height: header.pixel_height,
        depth: header.pixel_depth,
        layers: header.layer_count,
        faces: header.face_count,
        levels: header.level_count.max(1),
    };
    let faces = claim.check()?;
    let found = || {
        header
            .format
            .map_or("undefined".to_owned(), |format| format!("{format:?}"))
    };
    let texel = Texel::of(
        |texel| Some(texel.vulkan) == header.format,
        || format!("its pixel format is {}", found()),
    )?;
    let is_zstd = match header.supercompression_scheme {
        None => false,
        Some(SupercompressionScheme::Zstandard) => true,
        Some(other) => {
            return Err(Fault::new(
                format!("its supercompression is {other:?}"),
                "none, or zstd",
            ));
        }
    };
    let index = whole(
        bytes.get(Header::LENGTH..Header::LENGTH + LevelIndex::LENGTH * claim.levels as usize),
    )?;
    let data = |entry: &[u8; LevelIndex::LENGTH]| {
        let LevelIndex {
            byte_offset,
            byte_length,
            ..
        } = LevelIndex::from_bytes(entry);
        let end = byte_offset
            .checked_add(byte_length)
            .and_then(|end| usize::try_from(end).ok())?;
        bytes.get(byte_offset as usize..end)
    };
    let mut levels = Vec::new();
    for entry in index.as_chunks().0 {
        levels.push(whole(data(entry))?);
    }
    check_apart(bytes, &levels)?;
    let mut read = Vec::new();
    for (level, found) in (0..).zip(levels) {
        let face_bytes = claim.face_bytes(level, texel);
        let needed = face_bytes * faces;
        let data = if is_zstd {
            Cow::Owned(unpacked(found, needed, level)?)
        } else {
            Cow::Borrowed(found)
        };
        if data.len() != needed {
            return Err(truncated(level, needed, data.len()));
        }
        read.push(claim.faces_of(level, texel, &data)?);
    }
    let Index {
        kvd_byte_offset,
        kvd_byte_length,
        ..
    } = header.index;
    let keys = bytes
        .get(kvd_byte_offset as usize..)
        .and_then(|keys| keys.get(..kvd_byte_length as usize));
    Ok(Texture {
        levels: read,
        texel: texel.name,
        keys: keys.map(unjoined).unwrap_or_default(),
    })
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
    let bytes =
        |faces: &Vec<RgbImage>| faces.iter().flat_map(|face| texel.bytes_of(face)).collect();
    let bytes: Vec<Vec<u8>> = levels.iter().map(bytes).collect();
    file(
        texel,
        [first.width, first.height, levels[0].len() as u32],
        &bytes,
        keys,
        *is_packed,
    )
}

/// Writes a table of four channels as a KTX 2 file in half floats.
pub fn write_table(table: &Pixels<[f32; 4]>) -> Vec<u8> {
    let bytes = table
        .data
        .iter()
        .flatten()
        .flat_map(|value| f16::from_f32(*value).to_le_bytes())
        .collect();
    file(
        Texel::listed("rgba16f"),
        [table.width, table.height, 1],
        &[bytes],
        &[],
        false,
    )
}

/// Lays out a file of the bytes of its levels; `size` is width, height and number of faces.
fn file(
    texel: &Texel,
    [width, height, face_count]: [u32; 3],
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
        pixel_width: width,
        pixel_height: height,
        pixel_depth: 0,
        layer_count: 0,
        face_count,
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
    // Levels are aligned to a texel's bytes and 4; packed ones are not (KTX 2, section 3.9.7).
    let alignment = if is_packed {
        1
    } else {
        texel.bytes << 2u32.saturating_sub(texel.bytes.trailing_zeros())
    };
    let mut end = kvd_start + kvd.len();
    let mut data = Vec::new();
    let mut index = vec![[0; LevelIndex::LENGTH]; levels.len()];
    for (level, plain) in levels.iter().enumerate().rev() {
        let stored = match is_packed {
            true => Cow::Owned(compress_to_vec(&plain[..], CompressionLevel::Fastest)),
            false => Cow::Borrowed(&plain[..]),
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
    [
        &header.as_bytes()[..],
        index.as_flattened(),
        &dfd,
        &kvd,
        &data,
    ]
    .concat()
}

/// Refuses levels that share bytes: a file of a kilobyte could claim gigabytes.
fn check_apart(bytes: &[u8], levels: &[&[u8]]) -> Result<(), Fault> {
    let start = |data: &[u8]| data.as_ptr() as usize - bytes.as_ptr() as usize;
    let mut ranges: Vec<_> = levels
        .iter()
        .enumerate()
        .map(|(level, data)| (start(data), data.len(), level))
        .collect();
    ranges.sort_unstable();
    for pair in ranges.windows(2) {
        let [(from, length, a), (next, _, b)] = [pair[0], pair[1]];
        if from + length > next {
            return Err(Fault::new(
                format!("levels {a} and {b} share bytes {next} to {}", from + length),
                "levels apart",
            ));
        }
    }
    Ok(())
}

/// Unpacks exactly `needed` bytes of a level, with a window no larger than a level needs.
fn unpacked(packed: &[u8], needed: usize, level: u32) -> Result<Vec<u8>, Fault> {
    let refuse = |error: &dyn std::fmt::Display| {
        Fault::new(
            format!("level {level} cannot be unpacked ({error})"),
            "zstd data of its size",
        )
    };
    let window = (needed as u64).next_power_of_two().max(WINDOW_MIN);
    let decoder = StreamingDecoder::new_with_max_window_size(packed, window)
        .map_err(|error| refuse(&error))?;
    let mut data = reserved(needed + 1)?;
    // One more byte detects a level that is too long.
    decoder
        .take(needed as u64 + 1)
        .read_to_end(&mut data)
        .map_err(|error| refuse(&error))?;
    if data.len() > needed {
        return Err(Fault::new(
            format!("level {level} unpacks to more than its {needed} bytes"),
            "zstd data of its size",
        ));
    }
    Ok(data)
}

/// Smallest window that encoders use at higher levels.
const WINDOW_MIN: u64 = 1 << 23;
