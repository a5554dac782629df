//! Reading: any flat image whose channels make a colour.

use super::blocks::{Parts, check_blocks, read_planes};
use super::colour::{choose_layer, to_rgb};
use crate::pixels::file::{Fault, read_bounded};
use crate::pixels::{Decoded, GrayImage, PixelsError};
use ::exr::meta::MetaData;
use ::exr::meta::attribute::EnvironmentMap;
use ::exr::meta::header::Header;
use ::exr::prelude::Vec2;
use std::io::Cursor;
use std::path::Path;

/// Reads the data window of the first part with colour as linear Rec.709: R, G, B or luminance with or without chroma; half, float or
/// uint; scan lines or the largest level of tiles. Subsampled chroma is interpolated linearly.
pub fn read(path: &Path) -> Result<Decoded, PixelsError> {
    read_layer(path, None)
}

/// As [`read`], but of the layer called `layer`: the channels `layer.R` ..., or the part of that name.
pub fn read_layer(path: &Path, layer: Option<&str>) -> Result<Decoded, PixelsError> {
    read_layer_bytes(path, &read_bounded(path)?, layer)
}

/// As [`read`], of the bytes of the file at `path`, which only errors name.
pub fn read_bytes(path: &Path, bytes: &[u8]) -> Result<Decoded, PixelsError> {
    read_layer_bytes(path, bytes, None)
}

fn read_layer_bytes(path: &Path, bytes: &[u8], layer: Option<&str>) -> Result<Decoded, PixelsError> {
    // A last resort: the codecs of the crate `exr` index by what they read. No damaged file we have makes one panic, but if one does,
    // it is bad input and must not end a run. The bytes are only borrowed, so nothing half-changed can be seen afterwards.
    std::panic::catch_unwind(|| decode(bytes, layer))
        .unwrap_or_else(|_| Err(Fault::new("is damaged in a way that its decoder cannot name", "a valid OpenEXR file")))
        .map_err(|fault| fault.at(path))
}

/// Fails when a file that this program wrote is not whole: a block is missing or cut off. Nothing is unpacked.
pub fn check_whole(path: &Path) -> Result<(), PixelsError> {
    let bytes = read_bounded(path)?;
    let check = || {
        let (meta, tables_start) = read_header(&bytes)?;
        let multi_part = meta.requirements.has_multiple_layers;
        check_blocks(&Parts { bytes: &bytes, headers: &meta.headers, tables_start, multi_part }, 0)
    };
    check().map_err(|fault| fault.at(path))
}

/// The headers, and where the offset tables begin.
fn read_header(bytes: &[u8]) -> Result<(MetaData, usize), Fault> {
    let mut cursor = Cursor::new(bytes);
    let meta = MetaData::read_from_buffered(&mut cursor, false).map_err(|error| {
        Fault::new(format!("has no usable header ({error})"), "a valid OpenEXR file without deep data")
    })?;
    Ok((meta, cursor.position() as usize))
}

fn decode(bytes: &[u8], layer: Option<&str>) -> Result<Decoded, Fault> {
    let (meta, tables_start) = read_header(bytes)?;
    let parts =
        Parts { bytes, headers: &meta.headers, tables_start, multi_part: meta.requirements.has_multiple_layers };
    if !parts.multi_part && meta.requirements.is_single_layer_and_tiled != meta.headers[0].blocks.has_tiles() {
        let what = "the version field and the type attribute disagree on tiles";
        return Err(Fault::new(what, "both to name tiles, or neither"));
    }
    let flat = meta.headers.iter().enumerate().filter(|(_, header)| !header.deep);
    let (index, header, chosen) = flat
        .filter_map(|(index, header)| choose_layer(header, layer).map(|chosen| (index, header, chosen)))
        .next()
        .ok_or_else(|| no_colour(&meta.headers, layer))?;
    let mut warnings = oddities(header, index, meta.headers.len());
    let mut planes = read_planes(&parts, index, &chosen.wanted())?;
    let rgb = to_rgb(header, &chosen, &planes, &mut warnings);
    let alpha = match chosen.alpha {
        // A subsampled alpha is legal but fits no use of it here.
        Some(_) => planes
            .pop()
            .filter(|plane| plane.sampling == (1, 1))
            .map(|plane| GrayImage::new(rgb.width, rgb.height, plane.samples)),
        None => None,
    };
    Ok(Decoded { rgb, alpha, warnings })
}

fn no_colour(headers: &[Header], layer: Option<&str>) -> Fault {
    let channels: Vec<String> =
        headers.iter().flat_map(|header| &header.channels.list).map(|channel| channel.name.to_string()).collect();
    let place = layer.map(|name| format!(" in layer {name:?}")).unwrap_or_default();
    let deep = if headers.iter().any(|header| header.deep) { " (deep parts are not read)" } else { "" };
    Fault::new(format!("has the channels {}{deep}", channels.join(", ")), format!("R, G, B or Y channels{place}"))
}

fn oddities(header: &Header, index: usize, parts: usize) -> Vec<String> {
    let mut warnings = Vec::new();
    let (Vec2(x, y), Vec2(width, height)) = (header.own_attributes.layer_position, header.layer_size);
    let display = header.shared_attributes.display_window;
    if (display.position, display.size) != (Vec2(x, y), Vec2(width, height)) {
        warnings.push(format!(
            "The data window ({width}x{height} at {x}, {y}) differs from the display window ({}x{} at {}, {}); the data window is used.",
            display.size.0, display.size.1, display.position.0, display.position.1
        ));
    }
    if header.shared_attributes.pixel_aspect != 1.0 {
        let aspect = header.shared_attributes.pixel_aspect;
        warnings.push(format!("The pixel aspect ratio {aspect} is ignored; pixels are taken as square."));
    }
    if parts > 1 {
        warnings.push(format!("Of {parts} parts, only part {} is used.", index + 1));
    }
    if header.own_attributes.environment_map == Some(EnvironmentMap::Cube) {
        warnings.push("The header calls the image a cube map; it is taken as equirectangular.".to_owned());
    }
    warnings
}
