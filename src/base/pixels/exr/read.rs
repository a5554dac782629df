//! Reads one layer: R, G, B channels and, if present, A.
//!
//! The crate `exr` parses and unpacks. The checks here are those that it lacks: claims of memory
//! and time, and repeated blocks, which would leave others at 0.

use super::color_label;
use super::envmap;
use super::frame::Frame;
use super::layers::{Choice, Layer, choose};
use crate::base::color::out_of_gamut;
use crate::base::pixels::file::{ENVIRONMENT_TEXELS_MAX, Fault, check_claim, filled, read_bounded};
use crate::base::pixels::{Decoded, GrayImage, PixelsError, RgbImage};
use ::exr::block::UncompressedBlock;
use ::exr::block::chunk::{Chunk, CompressedBlock};
use ::exr::block::lines::LineRef;
use ::exr::block::reader::{FilteredChunksReader, Reader};
use ::exr::meta::header::Header;
use ::exr::meta::{BlockDescription, MetaData};
use ::exr::prelude::{Compression, Error, SampleType, Vec2, f16};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::collections::HashSet;
use std::io::Cursor;
use std::path::Path;

/// Most pixels of an image that is not an environment (4096 x 4096).
const FRAME_TEXELS_MAX: u64 = 1 << 24;
/// Bytes of pixels per batch, or one block if it is larger; codecs need two or three times this.
const BATCH_BYTES: usize = 1 << 26;
/// Largest block: one tile of 8192 x 4096 pixels of four halves.
const BLOCK_BYTES_MAX: usize = 1 << 28;
/// Most bytes of pixels in an image: about ten seconds of unpacking.
const PART_BYTES_MAX: usize = 1 << 32;
/// Where the compression of the first part stands, at the latest.
const HEADER_BYTES_SEARCHED: usize = 1 << 16;
/// Compressions since OpenEXR 3.4 (`ImfCompression.h` of 3.5), by number.
const NEW_COMPRESSIONS: [(u8, &str); 4] = [
    (10, "HTJ2K256"),
    (11, "HTJ2K32"),
    (12, "LJ2K"),
    (13, "ZSTD"),
];
/// Most pixels per byte of a file; only absurd claims exceed it.
const TEXELS_PER_BYTE: u64 = 1 << 16;

/// Reads the data window of the first colour layer as linear Rec.709: half, float or uint; scan
/// lines or tiles.
pub fn read(path: &Path) -> Result<Decoded, PixelsError> {
    read_layer(path, None)
}

/// Reads the layer `layer`: the channels `layer.R` ..., or the part of that name.
pub fn read_layer(path: &Path, layer: Option<&str>) -> Result<Decoded, PixelsError> {
    guarded(path, &read_bounded(path)?, |bytes| {
        decode(bytes, layer, FRAME_TEXELS_MAX)
    })
}

/// Reads an environment from memory; errors name `path`.
pub fn read_bytes(path: &Path, bytes: &[u8], layer: Option<&str>) -> Result<Decoded, PixelsError> {
    guarded(path, bytes, |bytes| {
        decode(bytes, layer, ENVIRONMENT_TEXELS_MAX)
    })
}

/// Calls `read`. The crate's codecs may panic on bad input, which must not end a run.
fn guarded<T>(
    path: &Path,
    bytes: &[u8],
    read: impl Fn(&[u8]) -> Result<T, Fault>,
) -> Result<T, PixelsError> {
    // The bytes are only borrowed.
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| read(bytes)))
        .unwrap_or_else(|_| Err(Fault::new("is damaged", "a valid OpenEXR file")))
        .map_err(|fault| fault.in_file(path))
}

fn damaged(error: Error) -> Fault {
    let expected = "a complete OpenEXR file without deep data and subsampled channels";
    Fault::new(format!("cannot be decoded ({error})"), expected)
}

/// Iterates over the packed blocks of a part's largest level.
fn chunks(bytes: &[u8], part: usize) -> Result<FilteredChunksReader<Cursor<&[u8]>>, Error> {
    Reader::read_from_buffered(Cursor::new(bytes), false)?.filter_chunks(true, |_, tile, block| {
        block.layer == part && tile.is_largest_resolution_level()
    })
}

fn decode(bytes: &[u8], layer: Option<&str>, most_texels: u64) -> Result<Decoded, Fault> {
    check_compression(bytes)?;
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|error| {
        Fault::new(
            format!("has no usable header ({error})"),
            "a valid OpenEXR file",
        )
    })?;
    let Choice {
        layer,
        warning: other_layers,
    } = choose(&meta.headers, layer)?;
    let header = &meta.headers[layer.part];
    let Vec2(width, height) = header.layer_size;
    check_claim(
        width as u64,
        height as u64,
        most_texels,
        bytes.len(),
        TEXELS_PER_BYTE,
    )?;
    let mut warnings = Vec::new();
    let frame = Frame::of_header(header, &mut warnings)?;
    // A window may claim more than the file holds.
    check_claim(
        frame.width as u64,
        frame.height as u64,
        most_texels,
        bytes.len(),
        TEXELS_PER_BYTE,
    )?;
    let to_rec709 = color_label::conversion(header, &mut warnings)?;
    let block_bytes = check_unpacked(header)?;
    let chunks = chunks(bytes, layer.part).map_err(damaged)?;
    let mut planes = Planes::new(header, &layer)?;
    read_blocks(chunks, &meta, block_bytes, &mut planes)?;

    warnings.extend(oddities(header));
    warnings.extend(other_layers);
    warnings.extend(missing_channels(&layer));
    warnings.extend(whole_numbers(header, &layer));
    if let Some(to_rec709) = to_rec709 {
        convert(&mut planes.rgb, to_rec709, &mut warnings);
    }
    warnings.extend(white_luminance(header));
    let mut decoded = planes.decoded(&frame, warnings)?;
    decoded.content = color_label::content(header);
    decoded.projection = envmap::projection(header, &mut decoded.rgb)?;
    Ok(decoded)
}

/// The values of one layer, and where blocks of its part belong.
struct Planes<'h> {
    header: &'h Header,
    layer: &'h Layer,
    rgb: Vec<[f32; 3]>,
    alpha: Option<Vec<f32>>,
    /// Column and line of each block so far.
    known_blocks: HashSet<(usize, usize)>,
}

impl<'h> Planes<'h> {
    fn new(header: &'h Header, layer: &'h Layer) -> Result<Self, Fault> {
        let Vec2(width, height) = header.layer_size;
        Ok(Self {
            header,
            layer,
            rgb: filled(width * height, [0.0; 3])?,
            alpha: layer
                .alpha
                .map(|_| filled(width * height, 0.0))
                .transpose()?,
            known_blocks: HashSet::new(),
        })
    }

    /// Takes the values of a block. Refuses a second one at the same position, since another would
    /// be missing.
    fn put_block(&mut self, block: &UncompressedBlock) -> Result<(), Fault> {
        let Vec2(x, y) = block.index.pixel_position;
        let belongs = block.index.layer == self.layer.part && block.index.level == Vec2(0, 0);
        if !belongs || !self.known_blocks.insert((x, y)) {
            let what =
                format!("the block at column {x}, line {y} comes twice or belongs elsewhere");
            return Err(Fault::new(what, "every block once"));
        }
        for line in block.lines(&self.header.channels) {
            self.put_line(&line);
        }
        Ok(())
    }

    /// Takes a line of one channel.
    fn put_line(&mut self, line: &LineRef) {
        let Vec2(x, y) = line.location.position;
        let first = y * self.header.layer_size.width() + x;
        let texels = first..first + line.location.sample_count;
        let channel = line.location.channel;
        let sample_type = self.header.channels.list[channel].sample_type;
        // A channel of grey is all three colours.
        for (color, wanted) in self.layer.rgb.iter().enumerate() {
            if *wanted == Some(channel) {
                let targets = self.rgb[texels.clone()]
                    .iter_mut()
                    .map(|texel| &mut texel[color]);
                put_samples(targets, line.value, sample_type);
            }
        }
        if self.layer.alpha == Some(channel)
            && let Some(alpha) = &mut self.alpha
        {
            put_samples(alpha[texels].iter_mut(), line.value, sample_type);
        }
    }

    fn decoded(self, frame: &Frame, warnings: Vec<String>) -> Result<Decoded, Fault> {
        let [width, height] = frame.display_size().map(|side| side as u32);
        let rgb = frame.to_display_window(self.rgb, [0.0; 3])?;
        let alpha = self
            .alpha
            .map(|alpha| frame.to_display_window(alpha, 0.0))
            .transpose()?;
        Ok(Decoded {
            alpha: alpha.map(|alpha| GrayImage::new(width, height, alpha)),
            ..Decoded::new(RgbImage::new(width, height, rgb), warnings)
        })
    }
}

/// Unpacks the blocks in batches, to bound the memory, and in parallel.
fn read_blocks(
    mut chunks: impl Iterator<Item = Result<Chunk, Error>>,
    meta: &MetaData,
    block_bytes: usize,
    planes: &mut Planes,
) -> Result<(), Fault> {
    let batch_length = (BATCH_BYTES / block_bytes).max(1);
    loop {
        let batch = chunks
            .by_ref()
            .take(batch_length)
            .collect::<Result<Vec<Chunk>, Error>>()
            .map_err(damaged)?;
        if batch.is_empty() {
            return Ok(());
        }
        let blocks = batch
            .into_par_iter()
            .map(|chunk| unpack(chunk, meta))
            .collect::<Result<Vec<_>, Fault>>()?;
        for block in &blocks {
            planes.put_block(block)?;
        }
    }
}

fn missing_channels(layer: &Layer) -> impl Iterator<Item = String> {
    ["R", "G", "B"]
        .iter()
        .zip(layer.rgb)
        .filter(|(_, channel)| channel.is_none())
        .map(|(name, _)| format!("Channel {name} is missing; it was set to 0."))
}

/// Warns of integers, which are numbers of objects more often than light.
fn whole_numbers(header: &Header, layer: &Layer) -> Option<String> {
    let is_whole = |channel: &usize| header.channels.list[*channel].sample_type == SampleType::U32;
    let mut channels = layer.rgb.iter().flatten();
    channels.any(is_whole).then(|| {
        "The channels hold whole numbers (uint), as of objects; they were read as radiance."
            .to_owned()
    })
}

/// Returns the bytes of a part's block, at least 1. Refuses parts that need too much memory or
/// time.
fn check_unpacked(header: &Header) -> Result<usize, Fault> {
    let block = match header.blocks {
        BlockDescription::ScanLines => Vec2(
            header.layer_size.width(),
            header.compression.scan_lines_per_block(),
        ),
        BlockDescription::Tiles(tiles) => tiles.tile_size,
    };
    let bytes_of = |Vec2(x, y): Vec2<usize>| {
        x.saturating_mul(y)
            .saturating_mul(header.channels.bytes_per_pixel)
            .max(1)
    };
    let check = |subject: &str, bytes: usize, most: usize| {
        if bytes <= most {
            return Ok(());
        }
        Err(Fault::new(
            format!(
                "{subject} {} MiB of pixels in {} channels",
                bytes >> 20,
                header.channels.list.len()
            ),
            format!(
                "at most {} MiB; keep the channels of the colour only",
                most >> 20
            ),
        ))
    };
    let block_bytes = bytes_of(block);
    check("a block has", block_bytes, BLOCK_BYTES_MAX)?;
    check(
        "its blocks have",
        bytes_of(header.layer_size),
        PART_BYTES_MAX,
    )?;
    Ok(block_bytes)
}

fn unpack(chunk: Chunk, meta: &MetaData) -> Result<UncompressedBlock, Fault> {
    check_dwa_counters(&chunk, &meta.headers[chunk.layer_index])?;
    UncompressedBlock::decompress_chunk(chunk, meta, false).map_err(damaged)
}

/// Checks unpacked sizes that a DWA block claims: the codec allocates them before it reads.
fn check_dwa_counters(chunk: &Chunk, header: &Header) -> Result<(), Fault> {
    /// Indices among eleven counters: other channels, run-length codes and bytes, AC and DC
    /// coefficients.
    const UNPACKED_SIZES: [usize; 5] = [1, 6, 7, 8, 9];
    let packed = match &chunk.compressed_block {
        CompressedBlock::ScanLine(block) => &block.compressed_pixels_le,
        CompressedBlock::Tile(block) => &block.compressed_pixels_le,
        _ => return Ok(()),
    };
    let tile = header
        .get_block_data_indices(&chunk.compressed_block)
        .map_err(damaged)?;
    let Vec2(width, height) = header
        .get_absolute_block_pixel_coordinates(tile)
        .map_err(damaged)?
        .size;
    let is_raw = packed.len() == width * height * header.channels.bytes_per_pixel;
    if is_raw
        || !matches!(
            header.compression,
            Compression::DWAA(_) | Compression::DWAB(_)
        )
    {
        return Ok(());
    }
    // The transform pads to 8 x 8; the factor 2 covers run-length codes that grow.
    let limit = 2
        * (width.next_multiple_of(8) * height.next_multiple_of(8) * header.channels.bytes_per_pixel)
            as u64;
    let (counters, _) = packed.as_chunks::<8>();
    let sizes = UNPACKED_SIZES
        .iter()
        .filter_map(|&index| counters.get(index))
        .map(|&bytes| u64::from_le_bytes(bytes));
    match sizes.max().filter(|&size| size > limit) {
        Some(size) => Err(Fault::new(
            format!("a block has a DWA counter of {size}"),
            format!("at most {limit}"),
        )),
        None => Ok(()),
    }
}

/// Converts the samples of a line to f32.
fn put_samples<'t>(
    targets: impl Iterator<Item = &'t mut f32>,
    bytes: &[u8],
    sample_type: SampleType,
) {
    match sample_type {
        SampleType::F16 => put_numbers(targets, bytes, |b| f16::from_ne_bytes(b).to_f32()),
        SampleType::F32 => put_numbers(targets, bytes, f32::from_ne_bytes),
        SampleType::U32 => put_numbers(targets, bytes, |b| u32::from_ne_bytes(b) as f32),
    }
}

fn put_numbers<'t, const N: usize>(
    targets: impl Iterator<Item = &'t mut f32>,
    bytes: &[u8],
    number: impl Fn([u8; N]) -> f32,
) {
    for (target, sample) in targets.zip(bytes.as_chunks().0) {
        *target = number(*sample);
    }
}

/// Multiplies colours by a matrix. A colour outside Rec.709 gets negative channels, which no
/// radiance has: they become 0 with a warning, as in Radiance files. Channels that are negative in
/// the file stay, for the check of the caller.
fn convert(rgb: &mut [[f32; 3]], to_rec709: DMat3, warnings: &mut Vec<String>) {
    let mut out_of_gamut_count = 0u64;
    for texel in rgb {
        let stored = DVec3::from(texel.map(f64::from));
        let mut converted = to_rec709 * stored;
        if stored.min_element() >= 0.0 && converted.min_element() < 0.0 {
            out_of_gamut_count += 1;
            converted = converted.max(DVec3::ZERO);
        }
        *texel = converted.as_vec3().to_array();
    }
    warnings.extend(out_of_gamut(out_of_gamut_count));
}

/// Refuses a compression that the crate does not unpack, by its name and with a way out.
fn check_compression(bytes: &[u8]) -> Result<(), Fault> {
    let code = compression_code(bytes);
    match NEW_COMPRESSIONS.iter().find(|(new, _)| Some(*new) == code) {
        Some((_, name)) => Err(Fault::new(
            format!("is compressed by {name}"),
            "a compression that this program reads; `oiiotool in.exr --compression zip -o out.exr` \
             changes it",
        )),
        None => Ok(()),
    }
}

/// Finds the number of the compression of the first part.
fn compression_code(bytes: &[u8]) -> Option<u8> {
    // Name and type of the attribute, each with its NUL, then its size of one byte.
    const ATTRIBUTE: &[u8] = b"compression\0compression\0\x01\0\0\0";
    let header = &bytes[..bytes.len().min(HEADER_BYTES_SEARCHED)];
    let start = header
        .windows(ATTRIBUTE.len())
        .position(|window| window == ATTRIBUTE)?;
    header.get(start + ATTRIBUTE.len()).copied()
}

/// Warns of a map that may be scaled: pfstools divide maps above the range of halves by a factor,
/// which they store as the luminance of white.
fn white_luminance(header: &Header) -> Option<String> {
    let factor = header.own_attributes.white_luminance?;
    (factor != 1.0).then(|| {
        format!(
            "The header's whiteLuminance is {factor}: the program that wrote the file may have \
             divided the light by it, as pfstools do; environment_scale={factor} undoes that."
        )
    })
}

/// Returns warnings about header fields that are ignored.
fn oddities(header: &Header) -> Vec<String> {
    let mut warnings = Vec::new();
    if header.shared_attributes.pixel_aspect != 1.0 {
        let aspect = header.shared_attributes.pixel_aspect;
        warnings.push(format!(
            "The pixel aspect ratio {aspect} is ignored; pixels are taken as square."
        ));
    }
    warnings
}
