//! Which channels hold a colour, and how they become Rec.709.

use super::blocks::Plane;
use crate::color::{Chromaticities, REC709, REC709_LUMINANCE};
use crate::pixels::RgbImage;
use crate::pixels::file::{Fault, reserved};
use ::exr::meta::header::Header;
use ::exr::prelude::Vec2;
use glam::{DVec2, DVec3};
use std::collections::{HashMap, HashSet};

/// The colour channels of one layer of a part, as indices of the header's list.
pub(super) enum Channels {
    /// Red, green, blue; at least one is there.
    Rgb([Option<usize>; 3]),
    /// CIE 1931 XYZ.
    Xyz([usize; 3]),
    /// Luminance, and the chroma `(R - Y) / Y`, `(B - Y) / Y`; without them the image is grey.
    Luminance { y: usize, chroma: Option<[usize; 2]> },
}

/// A layer that can be read as colour.
pub(super) struct Layer {
    /// What stands before the dot of its channels' names; none for plain channels.
    pub name: Option<String>,
    pub channels: Channels,
    pub alpha: Option<usize>,
}

/// The channels of a part by name.
struct Names {
    index: HashMap<String, usize>,
    /// The prefixes before the last dot of a name, each once, in the order of the file.
    prefixes: Vec<String>,
}

impl Names {
    fn of(header: &Header) -> Self {
        let mut names = Self { index: HashMap::new(), prefixes: Vec::new() };
        let mut seen = HashSet::new();
        for (index, channel) in header.channels.list.iter().enumerate() {
            let name = channel.name.to_string();
            if let Some((prefix, _)) = name.rsplit_once('.')
                && seen.insert(prefix.to_owned())
            {
                names.prefixes.push(prefix.to_owned());
            }
            names.index.entry(name).or_insert(index);
        }
        names
    }

    /// The colour channels of a layer; of the plain channels without a name.
    fn layer(&self, name: Option<&str>) -> Option<Layer> {
        let find = |channel: &str| {
            let full = name.map(|name| format!("{name}.{channel}"));
            self.index.get(full.as_deref().unwrap_or(channel)).copied()
        };
        let rgb = [find("R"), find("G"), find("B")];
        let channels = if rgb.iter().any(Option::is_some) {
            Channels::Rgb(rgb)
        } else if let [Some(x), Some(y), Some(z)] = [find("X"), find("Y"), find("Z")] {
            Channels::Xyz([x, y, z])
        } else {
            Channels::Luminance { y: find("Y")?, chroma: find("RY").zip(find("BY")).map(|(ry, by)| [ry, by]) }
        };
        Some(Layer { name: name.map(str::to_owned), channels, alpha: find("A") })
    }
}

/// Every layer of this part that holds a colour: the plain channels first. Of layers with a name, X, Y and Z are far more often a
/// direction or place than a colour; they are read as a colour only when they are asked for.
pub(super) fn colour_layers(header: &Header) -> Vec<Layer> {
    let names = Names::of(header);
    let is_colour = |layer: &Layer| !matches!(layer.channels, Channels::Xyz(_));
    let named = names.prefixes.iter().filter_map(|prefix| names.layer(Some(prefix)).filter(is_colour));
    names.layer(None).into_iter().chain(named).collect()
}

/// The layer called `name` in this part: channels with that prefix, or the plain channels of a part of that name.
pub(super) fn layer_called(header: &Header, name: &str) -> Option<Layer> {
    let is_part = header.own_attributes.layer_name.as_ref().is_some_and(|part| *part == *name);
    let names = Names::of(header);
    names.layer(Some(name)).or_else(|| is_part.then(|| names.layer(None)).flatten())
}

impl Layer {
    /// Whether nothing but the names of its channels says that it is a colour.
    pub fn is_doubtful(&self) -> bool {
        matches!(self.channels, Channels::Xyz(_))
    }

    /// Indices of the channels to read: those of the colour in order, then alpha.
    pub fn wanted(&self) -> Vec<usize> {
        let colour = match &self.channels {
            Channels::Rgb(rgb) => rgb.iter().flatten().copied().collect(),
            Channels::Xyz(xyz) => xyz.to_vec(),
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
pub(super) fn to_rgb(
    header: &Header,
    layer: &Layer,
    planes: &[Plane],
    warnings: &mut Vec<String>,
) -> Result<RgbImage, Fault> {
    let chromaticities = chromaticities(header);
    let convert = match layer.channels {
        Channels::Xyz(_) => {
            // What a spectrum's XYZ is in Rec.709, as the renderers that write it compute: nothing adapts to another white.
            warnings.push("The channels X, Y and Z were taken as CIE XYZ, whose D65 is white in Rec.709.".to_owned());
            REC709.to_xyz().map(|to_xyz| to_xyz.inverse())
        }
        _ => chromaticities
            .filter(|c| !c.is_close_to(&REC709))
            .and_then(|c| c.to_rec709_with_warning("chromaticities", warnings)),
    };
    let finish = |rgb: DVec3| convert.map_or(rgb, |matrix| matrix * rgb).as_vec3().to_array();
    match &layer.channels {
        Channels::Rgb(rgb) => {
            let mut remaining = planes.iter();
            let planes = rgb.map(|channel| channel.and_then(|_| remaining.next()));
            for (name, _) in ["R", "G", "B"].iter().zip(planes).filter(|(_, plane)| plane.is_none()) {
                warnings.push(format!("Channel {name} is missing; it was set to 0."));
            }
            image(header, |x, y| {
                let rgb = planes.map(|plane| plane.map_or(0.0, |plane| sample(plane, x, y)));
                // Without a conversion f32 samples pass through f64 unchanged.
                finish(rgb.into())
            })
        }
        Channels::Xyz(_) => image(header, |x, y| finish([0, 1, 2].map(|i| sample(&planes[i], x, y)).into())),
        Channels::Luminance { chroma: None, .. } => image(header, |x, y| [sample(&planes[0], x, y) as f32; 3]),
        Channels::Luminance { chroma: Some(_), .. } => {
            let weights =
                chromaticities.and_then(|c| c.to_xyz()).map_or(DVec3::from(REC709_LUMINANCE), |to_xyz| to_xyz.row(1));
            image(header, |x, y| {
                let [luminance, ry, by] = [0, 1, 2].map(|i| sample(&planes[i], x, y));
                let (r, b) = ((ry + 1.0) * luminance, (by + 1.0) * luminance);
                let g = (luminance - weights.x * r - weights.z * b) / weights.y;
                finish(DVec3::new(r, g, b))
            })
        }
    }
}

/// The image of a function of column and row.
fn image(header: &Header, texel: impl Fn(usize, usize) -> [f32; 3]) -> Result<RgbImage, Fault> {
    let Vec2(width, height) = header.layer_size;
    let mut data = reserved(width * height)?;
    data.extend((0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| texel(x, y)));
    Ok(RgbImage::new(width as u32, height as u32, data))
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
