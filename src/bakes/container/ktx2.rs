//! KTX 2: levels anywhere in the file, smallest first by custom, each plain or compressed by zstd.

use super::texel::{self, TEXELS};
use super::{Claim, Texture, truncated};
use crate::pixels::{Fault, reserved};
use ktx2::{Reader, SupercompressionScheme};
use ruzstd::decoding::StreamingDecoder;
use std::borrow::Cow;
use std::io::Read;

pub fn read(bytes: &[u8]) -> Result<Texture, Fault> {
    let reader = Reader::new(bytes)
        .map_err(|error| Fault::new(format!("is no whole KTX 2 file ({error})"), "a whole KTX 2 file"))?;
    let header = reader.header();
    let claim = Claim {
        width: header.pixel_width,
        height: header.pixel_height,
        depth: header.pixel_depth,
        layers: header.layer_count,
        faces: header.face_count,
        levels: header.level_count.max(1),
    };
    let faces = claim.check()?;
    let texel = TEXELS.iter().find(|texel| Some(texel.vulkan) == header.format).ok_or_else(|| {
        let found = header.format.map_or("undefined".to_owned(), |format| format!("{format:?}"));
        Fault::new(format!("its pixel format is {found}"), format!("one of {}", texel::names()))
    })?;
    let is_zstd = match header.supercompression_scheme {
        None => false,
        Some(SupercompressionScheme::Zstandard) => true,
        Some(other) => return Err(Fault::new(format!("its supercompression is {other:?}"), "none, or zstd")),
    };
    let levels: Vec<_> = reader.levels().collect();
    check_apart(bytes, &levels.iter().map(|level| level.data).collect::<Vec<_>>())?;
    let mut read = Vec::new();
    for (level, found) in (0..).zip(levels) {
        let face_bytes = claim.face_bytes(level, texel);
        let needed = face_bytes * faces;
        let data = if is_zstd { Cow::Owned(unpacked(found.data, needed, level)?) } else { Cow::Borrowed(found.data) };
        if data.len() != needed {
            return Err(truncated(level, needed, data.len()));
        }
        let [width, height] = claim.size(level);
        read.push(
            data.chunks_exact(face_bytes).map(|face| texel.image(width, height, face)).collect::<Result<_, _>>()?,
        );
    }
    Ok(Texture { levels: read, texel: texel.name })
}

/// Levels that share bytes: a file of a kilobyte could stand for gigabytes.
fn check_apart(bytes: &[u8], levels: &[&[u8]]) -> Result<(), Fault> {
    let start = |data: &[u8]| data.as_ptr() as usize - bytes.as_ptr() as usize;
    let mut ranges: Vec<_> = levels.iter().enumerate().map(|(level, data)| (start(data), data.len(), level)).collect();
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

/// The `needed` bytes of a level. What it claims to unpack to is not asked: nothing beyond `needed` is unpacked, and its window, which
/// the decoder allocates, is no larger than a level needs.
fn unpacked(packed: &[u8], needed: usize, level: u32) -> Result<Vec<u8>, Fault> {
    let refuse = |error: &dyn std::fmt::Display| {
        Fault::new(format!("level {level} cannot be unpacked ({error})"), "zstd data of its size")
    };
    let window = (needed as u64).next_power_of_two().max(WINDOW_MIN);
    let decoder = StreamingDecoder::new_with_max_window_size(packed, window).map_err(|error| refuse(&error))?;
    let mut data = reserved(needed + 1)?;
    // One byte more tells a level that is too long.
    decoder.take(needed as u64 + 1).read_to_end(&mut data).map_err(|error| refuse(&error))?;
    if data.len() > needed {
        return Err(Fault::new(
            format!("level {level} unpacks to more than its {needed} bytes"),
            "zstd data of its size",
        ));
    }
    Ok(data)
}

/// Encoders take no smaller windows for their higher levels.
const WINDOW_MIN: u64 = 1 << 23;
