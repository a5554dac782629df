//! Reading: any flat image whose channels make a colour.

use super::blocks::{Parts, check_blocks, read_planes};
use super::colour::{Layer, colour_layers, layer_called, to_rgb};
use crate::pixels::file::{ENVIRONMENT_TEXELS_MAX, Fault, read_bounded};
use crate::pixels::{Decoded, GrayImage, PixelsError};
use ::exr::meta::MetaData;
use ::exr::meta::attribute::EnvironmentMap;
use ::exr::meta::header::Header;
use ::exr::prelude::Vec2;
use std::io::Cursor;
use std::path::Path;

/// Most pixels of a linear image that is not an environment: a frame (4096 x 4096).
const FRAME_TEXELS_MAX: u64 = 1 << 24;

/// Reads the data window of the first part with colour as linear Rec.709: R, G, B or luminance with or without chroma; half, float or
/// uint; scan lines or the largest level of tiles. Subsampled chroma is interpolated linearly.
pub fn read(path: &Path) -> Result<Decoded, PixelsError> {
    read_layer(path, None)
}

/// As [`read`], but of the layer called `layer`: the channels `layer.R` ..., or the part of that name.
pub fn read_layer(path: &Path, layer: Option<&str>) -> Result<Decoded, PixelsError> {
    read_layer_bytes(path, &read_bounded(path)?, layer, FRAME_TEXELS_MAX)
}

/// As [`read`] or [`read_layer`], of the bytes of the environment at `path`, which only errors name.
pub fn read_bytes(path: &Path, bytes: &[u8], layer: Option<&str>) -> Result<Decoded, PixelsError> {
    read_layer_bytes(path, bytes, layer, ENVIRONMENT_TEXELS_MAX)
}

fn read_layer_bytes(path: &Path, bytes: &[u8], layer: Option<&str>, most_texels: u64) -> Result<Decoded, PixelsError> {
    // A last resort: the codecs of the crate `exr` index by what they read. No damaged file we have makes one panic, but if one does,
    // it is bad input and must not end a run. The bytes are only borrowed, so nothing half-changed can be seen afterwards.
    std::panic::catch_unwind(|| decode(bytes, layer, most_texels))
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

fn decode(bytes: &[u8], layer: Option<&str>, most_texels: u64) -> Result<Decoded, Fault> {
    let (meta, tables_start) = read_header(bytes)?;
    let parts =
        Parts { bytes, headers: &meta.headers, tables_start, multi_part: meta.requirements.has_multiple_layers };
    if !parts.multi_part && meta.requirements.is_single_layer_and_tiled != meta.headers[0].blocks.has_tiles() {
        let what = "the version field and the type attribute disagree on tiles";
        return Err(Fault::new(what, "both to name tiles, or neither"));
    }
    let (index, chosen, choice) = choose(&meta.headers, layer)?;
    let header = &meta.headers[index];
    let mut warnings = oddities(header);
    warnings.extend(choice);
    let mut planes = read_planes(&parts, index, &chosen.wanted(), most_texels)?;
    let rgb = to_rgb(header, &chosen, &planes, &mut warnings)?;
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

/// The part and layer to read, and a warning if nobody chose among several.
fn choose(headers: &[Header], layer: Option<&str>) -> Result<(usize, Layer, Option<String>), Fault> {
    if let Some(name) = layer {
        let found = flat_parts(headers).find_map(|(index, header)| Some((index, layer_called(header, name)?, None)));
        return found.ok_or_else(|| no_colour(headers, layer));
    }
    let mut all = all_layers(headers);
    if all.is_empty() {
        return Err(no_colour(headers, layer));
    }
    let first = all.iter().position(|(_, layer)| !layer.is_doubtful()).unwrap_or(0);
    let (index, chosen) = all.remove(first);
    // Plain channels are a part's image by convention, whatever other layers are beside them.
    let is_told = headers.len() > 1 || (chosen.name.is_some() && !all.is_empty());
    let warning = is_told.then(|| {
        let layer = chosen.name.as_ref().map(|name| format!("layer {name:?}"));
        let place = match (headers.len(), layer) {
            (1, layer) => format!("Of its layers, only {}", layer.unwrap_or_default()),
            (count, layer) => {
                let layer = layer.map(|layer| format!(", {layer}")).unwrap_or_default();
                format!("Of {count} parts, only part {}{layer}", index + 1)
            }
        };
        match callable(headers, &all) {
            others if others.is_empty() => format!("{place} is used."),
            others => format!("{place} is used; FILE#NAME reads another ({others})."),
        }
    });
    Ok((index, chosen, warning))
}

/// Parts without deep data, which is not read.
fn flat_parts(headers: &[Header]) -> impl Iterator<Item = (usize, &Header)> {
    headers.iter().enumerate().filter(|(_, header)| !header.deep)
}

/// Every layer with colour and the part that it is in.
fn all_layers(headers: &[Header]) -> Vec<(usize, Layer)> {
    let of_part = |(index, header)| colour_layers(header).into_iter().map(move |layer| (index, layer));
    flat_parts(headers).flat_map(of_part).collect()
}

/// The names under which layers can be asked for.
fn callable(headers: &[Header], layers: &[(usize, Layer)]) -> String {
    let name = |(index, layer): &(usize, Layer)| {
        let part = headers[*index].own_attributes.layer_name.as_ref().map(ToString::to_string);
        layer.name.clone().or(part)
    };
    layers.iter().filter_map(name).collect::<Vec<_>>().join(", ")
}

fn no_colour(headers: &[Header], layer: Option<&str>) -> Fault {
    let channels: Vec<String> =
        headers.iter().flat_map(|header| &header.channels.list).map(|channel| channel.name.to_string()).collect();
    let place = layer.map(|name| match callable(headers, &all_layers(headers)) {
        names if names.is_empty() => format!(" in layer {name:?}"),
        names => format!(" in layer {name:?} (layers with colour: {names})"),
    });
    let place = place.unwrap_or_default();
    let deep = if headers.iter().any(|header| header.deep) { " (deep parts are not read)" } else { "" };
    Fault::new(format!("has the channels {}{deep}", channels.join(", ")), format!("R, G, B or Y channels{place}"))
}

fn oddities(header: &Header) -> Vec<String> {
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
    if header.own_attributes.environment_map == Some(EnvironmentMap::Cube) {
        warnings.push("The header calls the image a cube map; it is taken as equirectangular.".to_owned());
    }
    warnings
}
