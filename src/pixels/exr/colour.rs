//! Which channels hold a colour, and how they become Rec.709.

use super::blocks::Plane;
use crate::color::{Chromaticities, REC709, REC709_LUMINANCE};
use crate::pixels::RgbImage;
use ::exr::meta::header::Header;
use ::exr::prelude::Vec2;
use glam::{DMat3, DVec2, DVec3};

/// The colour channels of one layer of a part, as indices of the header's list.
pub(super) enum Channels {
    /// Red, green, blue; at least one is there.
    Rgb([Option<usize>; 3]),
    /// Luminance, and the chroma `(R - Y) / Y`, `(B - Y) / Y`; without them the image is grey.
    Luminance { y: usize, chroma: Option<[usize; 2]> },
}

/// A layer that can be read as colour.
pub(super) struct Layer {
    pub channels: Channels,
    pub alpha: Option<usize>,
}

/// The colour channels with that prefix (`""` or `"name."`).
fn layer_with_prefix(header: &Header, prefix: &str) -> Option<Layer> {
    let find = |name: &str| {
        header.channels.list.iter().position(|channel| channel.name.to_string() == format!("{prefix}{name}"))
    };
    let rgb = [find("R"), find("G"), find("B")];
    let channels = if rgb.iter().any(Option::is_some) {
        Channels::Rgb(rgb)
    } else {
        Channels::Luminance { y: find("Y")?, chroma: find("RY").zip(find("BY")).map(|(ry, by)| [ry, by]) }
    };
    Some(Layer { channels, alpha: find("A") })
}

/// The layer called `name` in this part: channels with that prefix, or the plain channels of a part of that name. Without a name the
/// plain channels, or else the first prefix that holds a colour.
pub(super) fn choose_layer(header: &Header, name: Option<&str>) -> Option<Layer> {
    if let Some(name) = name {
        let is_part = header.own_attributes.layer_name.as_ref().is_some_and(|part| *part == *name);
        return layer_with_prefix(header, &format!("{name}."))
            .or_else(|| is_part.then(|| layer_with_prefix(header, "")).flatten());
    }
    let names: Vec<String> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
    let prefixes = names.iter().filter_map(|name| name.rsplit_once('.')).map(|(prefix, _)| format!("{prefix}."));
    std::iter::once(String::new()).chain(prefixes).find_map(|prefix| layer_with_prefix(header, &prefix))
}

impl Layer {
    /// Indices of the channels to read: those of the colour in order, then alpha.
    pub fn wanted(&self) -> Vec<usize> {
        let colour = match &self.channels {
            Channels::Rgb(rgb) => rgb.iter().flatten().copied().collect(),
            Channels::Luminance { y, chroma } => {
                std::iter::once(*y).chain(chroma.iter().flatten().copied()).collect::<Vec<_>>()
            }
        };
        colour.into_iter().chain(self.alpha).collect()
    }
}

/// Value of a plane at a texel of the image; subsampled planes (whose samples sit on the first texel of each cell) linearly between.
fn sample(plane: &Plane, x: usize, y: usize) -> f64 {
    let at =
        |i: usize, j: usize| f64::from(plane.samples[j.min(plane.height - 1) * plane.width + i.min(plane.width - 1)]);
    if plane.sampling == (1, 1) {
        return at(x, y);
    }
    let (sx, sy) = plane.sampling;
    let (i, j) = (x / sx, y / sy);
    let (tx, ty) = ((x % sx) as f64 / sx as f64, (y % sy) as f64 / sy as f64);
    let row = |j: usize| at(i, j) + (at(i + 1, j) - at(i, j)) * tx;
    row(j) + (row(j + 1) - row(j)) * ty
}

/// Linear Rec.709 from the planes of [`Layer::wanted`].
pub(super) fn to_rgb(header: &Header, layer: &Layer, planes: &[Plane], warnings: &mut Vec<String>) -> RgbImage {
    let chromaticities = chromaticities(header);
    let convert = conversion(chromaticities, warnings);
    let finish = |rgb: DVec3| convert.map_or(rgb, |matrix| matrix * rgb).as_vec3().to_array();
    let Vec2(width, height) = header.layer_size;
    let (width, height) = (width as u32, height as u32);
    match &layer.channels {
        Channels::Rgb(rgb) => {
            let mut remaining = planes.iter();
            let planes = rgb.map(|channel| channel.and_then(|_| remaining.next()));
            for (name, _) in ["R", "G", "B"].iter().zip(planes).filter(|(_, plane)| plane.is_none()) {
                warnings.push(format!("Channel {name} is missing; it was set to 0."));
            }
            RgbImage::from_fn(width, height, |x, y| {
                let rgb = planes.map(|plane| plane.map_or(0.0, |plane| sample(plane, x as usize, y as usize)));
                // Without a conversion f32 samples pass through f64 unchanged.
                finish(rgb.into())
            })
        }
        Channels::Luminance { chroma: None, .. } => {
            RgbImage::from_fn(width, height, |x, y| [sample(&planes[0], x as usize, y as usize) as f32; 3])
        }
        Channels::Luminance { chroma: Some(_), .. } => {
            let weights =
                chromaticities.and_then(|c| c.to_xyz()).map_or(DVec3::from(REC709_LUMINANCE), |to_xyz| to_xyz.row(1));
            RgbImage::from_fn(width, height, |x, y| {
                let [luminance, ry, by] = [0, 1, 2].map(|i| sample(&planes[i], x as usize, y as usize));
                let (r, b) = ((ry + 1.0) * luminance, (by + 1.0) * luminance);
                let g = (luminance - weights.x * r - weights.z * b) / weights.y;
                finish(DVec3::new(r, g, b))
            })
        }
    }
}

fn chromaticities(header: &Header) -> Option<Chromaticities> {
    let xy = |Vec2(x, y): Vec2<f32>| DVec2::new(x.into(), y.into());
    header.shared_attributes.chromaticities.map(|c| Chromaticities {
        red: xy(c.red),
        green: xy(c.green),
        blue: xy(c.blue),
        white: xy(c.white),
    })
}

fn conversion(chromaticities: Option<Chromaticities>, warnings: &mut Vec<String>) -> Option<DMat3> {
    let foreign = chromaticities.filter(|c| !c.is_close_to(&REC709))?;
    let matrix = foreign.to_rec709();
    warnings.push(match matrix {
        Some(_) => "The colours were converted from the header's chromaticities to Rec.709.".into(),
        None => "The header's chromaticities span no colour space; the colours were taken as Rec.709.".into(),
    });
    matrix
}
