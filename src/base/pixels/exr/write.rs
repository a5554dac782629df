//! Writes one part of f32 scan lines, RLE, whose `colorInteropID` says what the numbers are: programs
//! take files without it for a space of their own (OpenImageIO 3.2 for ACEScg).

use super::color_label;
use crate::base::pixels::{Content, GrayImage, PixelsError, RgbImage, write_atomically};
use ::exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, LineOrder, SmallVec,
    WritableImage,
};
use std::io;
use std::path::Path;

/// Writes channels R, G, B, A, and `name.R`, `name.G`, `name.B` for each of `layers`, all of one
/// size. Values survive bit for bit.
pub fn write_rgba(
    path: &Path,
    rgb: &RgbImage,
    alpha: &GrayImage,
    layers: &[(&str, &RgbImage)],
) -> Result<(), PixelsError> {
    let plane = |image: &RgbImage, channel: usize| image.map(|texel| texel[channel]);
    let named = |prefix: &str, image: &RgbImage| -> Vec<(String, GrayImage)> {
        ["R", "G", "B"]
            .iter()
            .enumerate()
            .map(|(i, name)| (format!("{prefix}{name}"), plane(image, i)))
            .collect()
    };
    let mut channels = named("", rgb);
    channels.push(("A".to_owned(), alpha.clone()));
    for (name, image) in layers {
        channels.extend(named(&format!("{name}."), image));
    }
    write_channels(path, Content::Radiance, channels)
}

/// Writes named f32 channels of one size, at least one.
pub fn write_channels(
    path: &Path,
    content: Content,
    channels: Vec<(String, GrayImage)>,
) -> Result<(), PixelsError> {
    let (width, height) = channels
        .first()
        .map(|(_, image)| (image.width, image.height))
        .expect("at least one channel");
    let list: SmallVec<[AnyChannel<FlatSamples>; 4]> = channels
        .into_iter()
        .map(|(name, image)| {
            assert_eq!(
                (image.width, image.height),
                (width, height),
                "size of channel {name}"
            );
            AnyChannel::new(name.as_str(), FlatSamples::F32(image.data))
        })
        .collect();
    let encoding = Encoding {
        // ZIP files are a third smaller but take ten times as long.
        compression: Compression::RLE,
        blocks: ::exr::image::Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let mut image = Image::from_encoded_channels(
        (width as usize, height as usize),
        encoding,
        AnyChannels::sort(list),
    );
    let (name, value) = color_label::label(content);
    image.layer_data.attributes.other.insert(name, value);
    write_atomically(path, |writer| {
        // A thread pool per file would cost more than it saves.
        image
            .write()
            .non_parallel()
            .to_buffered(writer)
            .map_err(io::Error::other)
    })
}
