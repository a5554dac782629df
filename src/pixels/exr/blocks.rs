//! The pixel blocks of one part: found, bounds-checked and collected here, unpacked by the codecs of the crate `exr`.
//!
//! The crate's own readers are not used because they refuse subsampled channels, allocate what a block's header claims, and leave
//! blocks that are missing from the file at 0 without a word.

use crate::pixels::file::{Fault, check_claim, filled};
use ::exr::meta::BlockDescription;
use ::exr::meta::header::Header;
use ::exr::prelude::{Compression, IntegerBounds, SampleType, Vec2, f16};
use rayon::prelude::*;

/// Bytes of pixels that are unpacked at a time, or one block if it has more. A block holds all channels of its lines, also those that
/// nobody wants, and the codecs need its size two or three times.
const BATCH_BYTES: usize = 1 << 26;
/// Largest block that is unpacked: one tile of 8192 x 4096 pixels of four halves.
const BLOCK_BYTES_MAX: usize = 1 << 28;
/// Most bytes of pixels that are unpacked for an image: some ten seconds. Two channels of 8192 x 4096 floats take 1/16 of it.
const PART_BYTES_MAX: usize = 1 << 32;

/// One channel of the largest level; `width * sampling.0` columns.
pub(super) struct Plane {
    pub width: usize,
    pub height: usize,
    /// Texels of the image from sample to sample, x and y.
    pub sampling: (usize, usize),
    pub samples: Vec<f32>,
}

/// A file in memory whose headers are read.
pub(super) struct Parts<'a> {
    pub bytes: &'a [u8],
    pub headers: &'a [Header],
    /// Where the offset tables begin.
    pub tables_start: usize,
    /// Blocks of multi-part files name their part.
    pub multi_part: bool,
}

struct Block<'a> {
    /// Relative to the data window.
    bounds: IntegerBounds,
    packed: &'a [u8],
    /// Bytes of its pixels.
    unpacked: usize,
}

/// Reads the channels `wanted` (indices of the header's list) of the part `index`, an image of at most `most_texels`.
pub(super) fn read_planes(
    parts: &Parts,
    index: usize,
    wanted: &[usize],
    most_texels: u64,
) -> Result<Vec<Plane>, Fault> {
    let header = &parts.headers[index];
    let Vec2(width, height) = header.layer_size;
    check_claim(width as u64, height as u64, most_texels, parts.bytes.len(), max_expansion(header.compression))?;
    check_sampling(header)?;
    let blocks = find_blocks(parts, index)?;
    check_unpacked(header, &blocks)?;
    let mut planes: Vec<Plane> = wanted
        .iter()
        .map(|&channel| {
            let Vec2(sx, sy) = header.channels.list[channel].sampling;
            let (width, height) = (width / sx, height / sy);
            Ok(Plane { width, height, sampling: (sx, sy), samples: filled(width * height, 0.0)? })
        })
        .collect::<Result<_, Fault>>()?;
    let mut blocks = blocks.as_slice();
    while let Some(largest) = blocks.iter().map(|block| block.unpacked).max() {
        let (batch, rest) = blocks.split_at((BATCH_BYTES / largest.max(1)).clamp(1, blocks.len()));
        blocks = rest;
        let unpacked: Vec<Vec<u8>> = batch.par_iter().map(|block| unpack(header, block)).collect::<Result<_, _>>()?;
        for (block, bytes) in batch.iter().zip(unpacked) {
            scatter(header, block.bounds, &bytes, wanted, &mut planes);
        }
    }
    Ok(planes)
}

/// Refuses what would take too much memory or time to unpack, mostly because of channels that are not wanted.
fn check_unpacked(header: &Header, blocks: &[Block]) -> Result<(), Fault> {
    let (largest, all) =
        blocks.iter().fold((0, 0usize), |(most, sum), b| (b.unpacked.max(most), sum.saturating_add(b.unpacked)));
    let channels = header.channels.list.len();
    for (what, bytes, most) in [("a block has", largest, BLOCK_BYTES_MAX), ("its blocks have", all, PART_BYTES_MAX)] {
        if bytes > most {
            let what = format!("{what} {} MiB of pixels in {channels} channels", bytes >> 20);
            let expected = format!("at most {} MiB; keep the channels of the colour only", most >> 20);
            return Err(Fault::new(what, expected));
        }
    }
    Ok(())
}

/// Bytes of an unpacked block for each packed byte, at most; bounds what a small file can make us allocate.
fn max_expansion(compression: Compression) -> u64 {
    match compression {
        Compression::Uncompressed => 1,
        // Two bytes for a run of 128.
        Compression::RLE => 64,
        // Deflate reaches 1032; PXR24 drops a quarter before it.
        Compression::ZIP1 | Compression::ZIP16 | Compression::PXR24 => 1400,
        // 3 bytes for a flat block of 4 x 4 halves.
        Compression::B44 | Compression::B44A => 11,
        // Run-length coding inside an entropy coder: no useful bound; these catch only absurd claims.
        _ => 1 << 16,
    }
}

fn check_sampling(header: &Header) -> Result<(), Fault> {
    let Vec2(width, height) = header.layer_size;
    let Vec2(left, top) = header.own_attributes.layer_position;
    for channel in &header.channels.list {
        let Vec2(sx, sy) = channel.sampling;
        if (sx, sy) == (1, 1) {
            continue;
        }
        let whole = |start: i32, size: usize, step: usize| {
            step > 0 && size.is_multiple_of(step) && i64::from(start).rem_euclid(step as i64) == 0
        };
        if !whole(left, width, sx) || !whole(top, height, sy) || header.blocks != BlockDescription::ScanLines {
            let what = format!("channel {} is subsampled by {sx}x{sy}", channel.name);
            return Err(Fault::new(what, "scan lines and a data window in whole steps of the subsampling"));
        }
        let supported = matches!(
            header.compression,
            Compression::Uncompressed
                | Compression::RLE
                | Compression::ZIP1
                | Compression::ZIP16
                | Compression::PIZ
                | Compression::PXR24
        );
        if !supported {
            let what = format!("channel {} is subsampled under {}", channel.name, header.compression);
            return Err(Fault::new(what, "subsampling only under none, RLE, ZIP, PIZ or PXR24"));
        }
    }
    Ok(())
}

/// Bytes of an unpacked block: for each line all channels, subsampled ones only on their lines.
fn block_bytes(header: &Header, bounds: IntegerBounds) -> usize {
    let first = bounds.position.y() as usize;
    let channels = header.channels.list.iter();
    channels
        .map(|channel| {
            let lines =
                (first..first + bounds.size.height()).filter(|y| y.is_multiple_of(channel.sampling.y())).count();
            lines * (bounds.size.width() / channel.sampling.x()) * channel.sample_type.bytes_per_sample()
        })
        .sum()
}

/// Fails when a block of the part `index` is missing from the file or cut off; nothing is unpacked.
pub(super) fn check_blocks(parts: &Parts, index: usize) -> Result<(), Fault> {
    find_blocks(parts, index).map(|_| ())
}

/// Every block of the largest level, each exactly once.
fn find_blocks<'a>(parts: &Parts<'a>, index: usize) -> Result<Vec<Block<'a>>, Fault> {
    let header = &parts.headers[index];
    let Vec2(width, height) = header.layer_size;
    let (tiled, Vec2(block_width, block_height)) = match header.blocks {
        BlockDescription::ScanLines => (false, Vec2(width, header.compression.scan_lines_per_block())),
        BlockDescription::Tiles(tiles) => (true, tiles.tile_size),
    };
    if block_width == 0 || block_height == 0 {
        return Err(Fault::new(format!("tiles of {block_width}x{block_height} pixels"), "tiles of at least one pixel"));
    }
    let (columns, rows) = (width.div_ceil(block_width), height.div_ceil(block_height));
    let count = columns * rows;
    // The entries of smaller levels follow those of the largest.
    if header.chunk_count < count {
        let what = format!("the header announces {} blocks", header.chunk_count);
        return Err(Fault::new(what, format!("{count} blocks for {width}x{height} pixels")));
    }
    let before: usize = parts.headers[..index].iter().fold(0, |sum, header| sum.saturating_add(header.chunk_count));
    let table = before
        .checked_mul(8)
        .and_then(|skipped| parts.bytes.get(parts.tables_start.checked_add(skipped)?..)?.get(..count.checked_mul(8)?))
        .ok_or_else(|| Fault::new("the file ends within the table of blocks", format!("{count} entries")))?;

    let mut seen = vec![false; count];
    let mut blocks = Vec::with_capacity(count);
    for (entry, offset) in table.as_chunks::<8>().0.iter().enumerate() {
        let place = || format!("block {entry} of {count}");
        let cut = || Fault::new(format!("{} is missing or cut off", place()), "a finished file");
        let mut rest = usize::try_from(u64::from_le_bytes(*offset))
            .ok()
            // Unfinished files have offsets of 0.
            .filter(|&offset| offset >= parts.tables_start)
            .and_then(|offset| parts.bytes.get(offset..))
            .ok_or_else(cut)?;
        let mut next = || -> Result<i32, Fault> {
            let (&bytes, tail) = rest.split_first_chunk().ok_or_else(cut)?;
            rest = tail;
            Ok(i32::from_le_bytes(bytes))
        };
        let wrong = |what: String| Fault::new(format!("{}: {what}", place()), "blocks that tile the data window");
        if parts.multi_part {
            let part = next()?;
            if usize::try_from(part) != Ok(index) {
                return Err(wrong(format!("it belongs to part {part}, not {index}")));
            }
        }
        let (column, row) = if tiled {
            let (column, row, level) = (next()?, next()?, (next()?, next()?));
            if level != (0, 0) {
                return Err(wrong(format!("it belongs to level {level:?}")));
            }
            (i64::from(column), i64::from(row))
        } else {
            let line = i64::from(next()?) - i64::from(header.own_attributes.layer_position.y());
            let lines = block_height as i64;
            // A line between blocks is no row of blocks.
            (0, if line.rem_euclid(lines) == 0 { line.div_euclid(lines) } else { -1 })
        };
        if !(0..columns as i64).contains(&column) || !(0..rows as i64).contains(&row) {
            return Err(wrong("its position is outside".to_owned()));
        }
        let (column, row) = (column as usize, row as usize);
        if std::mem::replace(&mut seen[row * columns + column], true) {
            return Err(wrong("its position comes twice".to_owned()));
        }
        let size = next()?;
        let packed = usize::try_from(size).ok().and_then(|size| rest.get(..size)).ok_or_else(cut)?;
        let (x, y) = (column * block_width, row * block_height);
        let bounds = IntegerBounds {
            position: Vec2(x as i32, y as i32),
            size: Vec2(block_width.min(width - x), block_height.min(height - y)),
        };
        let unpacked = block_bytes(header, bounds);
        if unpacked as u64 > max_expansion(header.compression) * packed.len() as u64 {
            return Err(wrong(format!("{} bytes for {unpacked} bytes of pixels", packed.len())));
        }
        blocks.push(Block { bounds, packed, unpacked });
    }
    Ok(blocks)
}

/// The bytes of a block in native byte order.
fn unpack(header: &Header, block: &Block) -> Result<Vec<u8>, Fault> {
    let refuse = |why: String| {
        let Vec2(x, y) = block.bounds.position;
        Fault::new(format!("the block at column {x}, line {y} is damaged ({why})"), "pixels that unpack")
    };
    let area = block.bounds.size.area();
    let bytes = block.unpacked;
    if bytes == 0 {
        return Ok(Vec::new());
    }
    if block.packed.len() != bytes && matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_)) {
        check_dwa_counters(header, block).map_err(|counter| refuse(format!("a DWA counter of {counter}")))?;
    }
    // The crate expects `area * bytes_per_pixel` bytes whatever the subsampling. The mean over this block makes that right.
    let mut adjusted;
    let header = if bytes == area * header.channels.bytes_per_pixel {
        header
    } else {
        if !bytes.is_multiple_of(area) {
            return Err(refuse("its channels take no whole number of bytes a pixel".to_owned()));
        }
        adjusted = header.clone();
        adjusted.channels.bytes_per_pixel = bytes / area;
        &adjusted
    };
    let unpacked = header
        .compression
        .decompress_image_section_from_le(header, block.packed.to_vec(), block.bounds, false)
        .map_err(|error| refuse(error.to_string()))?;
    if unpacked.len() == bytes { Ok(unpacked) } else { Err(refuse(format!("{} bytes, not {bytes}", unpacked.len()))) }
}

/// Checks the sizes of unpacked sections that a DWA block claims, because the codec allocates them before it reads; the error is the
/// first that the block's pixels cannot need.
fn check_dwa_counters(header: &Header, block: &Block) -> Result<(), u64> {
    /// Of the eleven leading counters: bytes of other channels, run-length codes and their bytes, AC and DC coefficients.
    const UNPACKED_SIZES: [usize; 5] = [1, 6, 7, 8, 9];
    let Vec2(width, height) = block.bounds.size;
    // The transform pads to 8 x 8; a factor of 2 covers run-length codes that grow their input.
    let padded = width.next_multiple_of(8) * height.next_multiple_of(8);
    let limit = 2 * padded as u64 * header.channels.bytes_per_pixel as u64;
    let (counters, _) = block.packed.as_chunks::<8>();
    let sizes = UNPACKED_SIZES.iter().filter_map(|&index| counters.get(index)).map(|&bytes| u64::from_le_bytes(bytes));
    sizes.filter(|&size| size > limit).map(Err).next().unwrap_or(Ok(()))
}

/// Copies the wanted channels of an unpacked block to their planes.
fn scatter(header: &Header, bounds: IntegerBounds, mut bytes: &[u8], wanted: &[usize], planes: &mut [Plane]) {
    let (left, top) = (bounds.position.x() as usize, bounds.position.y() as usize);
    for y in top..top + bounds.size.height() {
        for (index, channel) in header.channels.list.iter().enumerate() {
            let Vec2(sx, sy) = channel.sampling;
            if !y.is_multiple_of(sy) {
                continue;
            }
            let count = bounds.size.width() / sx;
            let (line, rest) = bytes.split_at(count * channel.sample_type.bytes_per_sample());
            bytes = rest;
            for (plane, _) in planes.iter_mut().zip(wanted).filter(|(_, wanted)| **wanted == index) {
                let start = y / sy * plane.width + left / sx;
                let target = &mut plane.samples[start..start + count];
                match channel.sample_type {
                    SampleType::F16 => put(target, line, |bytes| f16::from_ne_bytes(bytes).to_f32()),
                    SampleType::F32 => put(target, line, f32::from_ne_bytes),
                    SampleType::U32 => put(target, line, |bytes| u32::from_ne_bytes(bytes) as f32),
                }
            }
        }
    }
}

/// Fills `target` with the numbers in `bytes`, `N` each.
fn put<const N: usize>(target: &mut [f32], bytes: &[u8], number: impl Fn([u8; N]) -> f32) {
    target.iter_mut().zip(bytes.as_chunks().0).for_each(|(to, from)| *to = number(*from));
}
