//! KTX 1, as Filament's cmgen writes it. No maintained crate reads it.
//!
//! A header of 64 bytes, keys and values, then the levels, largest first [KTX 1 file format,
//! section 2].

use super::byte_color::ByteColor;
use super::interpretation::Interpretation;
use super::pixel_format::PixelFormat;
use super::{Claim, Encoding, Texture, left_over, pairs, truncated, unjoined};
use crate::base::pixels::Fault;

const IDENTIFIER: [u8; 12] = *b"\xabKTX 11\xbb\r\n\x1a\n";
/// The byte order of a little-endian file.
const LITTLE_ENDIAN: u32 = 0x0403_0201;
/// Words of the header after the identifier.
const WORDS: usize = 13;
const HEADER: usize = IDENTIFIER.len() + 4 * WORDS;

/// The words of a header that are read.
struct Header {
    internal_format: u32,
    claim: Claim,
    /// Bytes of keys and values.
    key_bytes: usize,
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let incomplete = || Fault::new("has no complete KTX 1 header", "a KTX 1 file");
        let header = bytes
            .get(..HEADER)
            .filter(|header| header.starts_with(&IDENTIFIER))
            .ok_or_else(incomplete)?;
        let words: Vec<u32> = header[IDENTIFIER.len()..]
            .as_chunks()
            .0
            .iter()
            .map(|word| u32::from_le_bytes(*word))
            .collect();
        let [
            order,
            ..,
            internal_format,
            _,
            width,
            height,
            depth,
            layers,
            faces,
            levels,
            key_bytes,
        ] = words[..]
        else {
            return Err(incomplete());
        };
        if order != LITTLE_ENDIAN {
            return Err(Fault::new(
                format!("its byte order is {order:#010x}"),
                "a little-endian file, 0x04030201",
            ));
        }
        Ok(Self {
            internal_format,
            claim: Claim {
                width,
                height,
                depth,
                layers,
                faces,
                levels: levels.max(1),
            },
            key_bytes: key_bytes as usize,
        })
    }
}

/// Reads a file of 1 or 6 faces.
pub fn read(bytes: &[u8], byte_color: Option<ByteColor>) -> Result<Texture, Fault> {
    let Header {
        internal_format,
        claim,
        key_bytes,
    } = Header::read(bytes)?;
    let face_count = claim.check()?;
    let mut position = HEADER.saturating_add(key_bytes);
    let keys = unjoined(bytes.get(HEADER..position).unwrap_or_default());
    let byte_color = ByteColor::of_keys(&keys, byte_color);
    let format = PixelFormat::of_gl(internal_format, byte_color)?;
    let interpretation = Interpretation::of_keys(&keys);
    let mut levels = Vec::new();
    for level in 0..claim.levels {
        let [width, height] = claim.size(level);
        let row = format.row_bytes(width);
        let face_bytes = row.next_multiple_of(4) * format.row_count(height);
        let rest = bytes.get(position..).unwrap_or_default();
        let Some((length, data)) = rest.split_first_chunk() else {
            return Err(truncated(level, 4, rest.len()));
        };
        // The stated length is one face's.
        let length = u32::from_le_bytes(*length) as usize;
        if length != face_bytes {
            return Err(Fault::new(
                format!("level {level} claims {length} bytes a face"),
                format!("{face_bytes}, of its size in {}", format.name()),
            ));
        }
        let needed = face_bytes * face_count;
        let data = data
            .get(..needed)
            .ok_or_else(|| truncated(level, needed, data.len()))?;
        // Rows are padded to 4 bytes.
        let rows = data
            .chunks(row.next_multiple_of(4))
            .flat_map(|padded| &padded[..row]);
        let rows: Vec<u8> = rows.copied().collect();
        levels.push(claim.faces_of(level, format, &rows, &interpretation)?);
        position += 4 + needed;
    }
    let rest = bytes.len() - position;
    if rest > 0 {
        return Err(left_over(rest, &claim, ""));
    }
    Ok(interpretation.warn(Texture {
        levels,
        texel: format.name(),
        keys,
        warnings: Vec::new(),
    }))
}

/// Writes header, keys, and the levels, largest first.
pub fn write(encoding: &Encoding) -> Vec<u8> {
    let Encoding {
        texel,
        levels,
        keys,
        ..
    } = encoding;
    let pairs = pairs(*keys);
    let first = &levels[0][0];
    // Depth and layers are 0 without an array or a volume.
    let words: [u32; WORDS] = [
        LITTLE_ENDIAN,
        texel.gl_type.code,
        texel.gl_type.size,
        texel.gl_format(),
        texel.gl,
        texel.gl_format(),
        first.width,
        first.height,
        0,
        0,
        levels[0].len() as u32,
        levels.len() as u32,
        pairs.len() as u32,
    ];
    let words = words.iter().flat_map(|word| word.to_le_bytes());
    let mut file: Vec<u8> = IDENTIFIER.into_iter().chain(words).collect();
    file.extend(pairs);
    for level in *levels {
        let row = level[0].width as usize * texel.bytes;
        file.extend((row.next_multiple_of(4) as u32 * level[0].height).to_le_bytes());
        for face in level {
            for texels in texel.bytes_of(face).chunks(row) {
                file.extend(texels);
                file.resize(file.len().next_multiple_of(4), 0);
            }
        }
    }
    file
}
