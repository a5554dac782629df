//! Babylon.js' `.env`: a prefiltered cube as PNG or WebP in RGBD, and irradiance as a polynomial.
//!
//! Eight bytes, JSON that ends with a zero byte, then the images: six a level, rows from the
//! bottom. Level k has the width `2^(k/s)/n` (n texels a side of level 0, s the
//! `lodGenerationScale`) [Babylon.js 9.35.0, `environmentTextureTools.pure.js`]. The polynomial has
//! irradiance that was convolved with the cosine twice: its degree 1 times 3/2 and degree 2 times 4
//! give irradiance over π.

use super::container::{Interpretation, RGBD, TEXELS_MAX};
use super::parts::Map;
use super::sh::{self, Coefficients};
use crate::base::pixels::{Fault, Pixels, RgbImage, png, webp};
use crate::instrument::environment::layout::LAYOUTS;
use crate::instrument::precompute::sh9::reference::Sh9;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Extension of the files.
pub const EXTENSION: &str = "env";
/// Name of the conventions in the list of presets.
pub const PRESET: &str = "babylon-env";

const MAGIC: [u8; 8] = [0x86, 0x16, 0x87, 0x96, 0xf6, 0xd6, 0x96, 0x36];
const FACES: usize = 6;
/// Levels per halving of the width.
const LOD_GENERATION_SCALE: f64 = 0.8;
const PNG: &str = "image/png";
const WEBP: &str = "image/webp";
/// Largest side of level 0, texels.
const SIDE_MAX: u32 = 1024;
/// Factors of the polynomial's degrees 0, 1 and 2 in irradiance over π.
const DEGREE_FACTORS: [f64; 3] = [1.0, 1.5, 4.0];

/// The header.
#[derive(Debug, Deserialize, Serialize)]
#[serde(rename_all = "camelCase")]
struct Header {
    version: u32,
    width: u32,
    #[serde(default = "png_type")]
    image_type: String,
    irradiance: Option<Polynomial>,
    specular: Specular,
}

fn png_type() -> String {
    PNG.to_owned()
}

#[derive(Debug, Deserialize, Serialize)]
#[serde(rename_all = "camelCase")]
struct Specular {
    mipmaps: Vec<Placement>,
    #[serde(default = "default_scale")]
    lod_generation_scale: f64,
}

fn default_scale() -> f64 {
    LOD_GENERATION_SCALE
}

/// Bytes of an image after the header.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
struct Placement {
    length: usize,
    position: usize,
}

/// Irradiance over π of a normal (x, y, z), as a sum of terms; colours by term.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
struct Polynomial {
    x: [f64; 3],
    y: [f64; 3],
    z: [f64; 3],
    xx: [f64; 3],
    yy: [f64; 3],
    zz: [f64; 3],
    yz: [f64; 3],
    zx: [f64; 3],
    xy: [f64; 3],
}

/// The contents of a file.
#[derive(Debug)]
pub struct BabylonEnv {
    pub map: Map,
    pub sh: Option<Coefficients>,
    /// Width of each level.
    pub alphas: Vec<f64>,
}

/// Returns the width of each level of a cube with `side` texels. Level 0 is the map itself.
pub fn alphas(side: u32, level_count: usize, lod_generation_scale: f64) -> Vec<f64> {
    let alpha = |level: usize| {
        if level == 0 {
            0.0
        } else {
            (level as f64 / lod_generation_scale).exp2() / f64::from(side)
        }
    };
    (0..level_count).map(alpha).collect()
}

/// Reads a file.
pub fn read(bytes: &[u8]) -> Result<BabylonEnv, Fault> {
    let expected = "an .env file of Babylon.js";
    let rest = bytes
        .strip_prefix(&MAGIC)
        .ok_or_else(|| Fault::new("has another magic number", expected))?;
    let end = rest
        .iter()
        .position(|byte| *byte == 0)
        .ok_or_else(|| Fault::new("its header has no end", expected))?;
    let header: Header = serde_json::from_slice(&rest[..end])
        .map_err(|error| Fault::new(format!("its header cannot be read ({error})"), expected))?;
    header.check()?;
    let images = &rest[end + 1..];
    let mut levels: Vec<Vec<RgbImage>> = Vec::new();
    for (index, placement) in header.specular.mipmaps.iter().enumerate() {
        let level = index / FACES;
        let side = header.width >> level;
        let data = images
            .get(placement.position..)
            .and_then(|rest| rest.get(..placement.length))
            .ok_or_else(|| {
                Fault::new(
                    format!("image {index} ends behind the file"),
                    "a complete file; it is probably truncated",
                )
            })?;
        let face =
            decoded(data, side).map_err(|fault| fault.preceded_by(format!("image {index}: ")))?;
        if levels.len() == level {
            levels.push(Vec::new());
        }
        levels[level].push(face);
    }
    Ok(BabylonEnv {
        alphas: alphas(
            header.width,
            levels.len(),
            header.specular.lod_generation_scale,
        ),
        map: Map {
            layout: &LAYOUTS[0],
            levels,
        },
        sh: header.irradiance.as_ref().map(Polynomial::coefficients),
    })
}

impl Header {
    fn check(&self) -> Result<(), Fault> {
        if ![PNG, WEBP].contains(&&*self.image_type) {
            return Err(Fault::new(
                format!("its images are {}", self.image_type),
                "image/png or image/webp (`CreateEnvTextureAsync(texture, { imageType: \
                 \"image/png\" })`)",
            ));
        }
        let is_side = self.width.is_power_of_two() && self.width <= SIDE_MAX;
        let levels = self.specular.mipmaps.len() / FACES;
        let is_whole = levels > 0 && self.specular.mipmaps.len().is_multiple_of(FACES);
        if !is_side || !is_whole || levels as u32 > self.width.ilog2() + 1 {
            return Err(Fault::new(
                format!(
                    "the header claims {} images for a width of {}",
                    self.specular.mipmaps.len(),
                    self.width
                ),
                format!("six a level, and a power of 2 up to {SIDE_MAX}"),
            ));
        }
        let scale = self.specular.lod_generation_scale;
        if !(scale.is_finite() && scale > 0.0) {
            return Err(Fault::new(
                format!("its lodGenerationScale is {scale}"),
                "a number above 0",
            ));
        }
        debug_assert!(8 * u64::from(SIDE_MAX).pow(2) <= TEXELS_MAX);
        Ok(())
    }
}

/// Decodes a face, rows from the top. Browsers that cannot encode the stated type write PNG.
fn decoded(data: &[u8], side: u32) -> Result<RgbImage, Fault> {
    let image = if webp::is_webp(data) {
        webp::decode_rgba8(data)?
    } else {
        png::decode_rgba8(data)?
    };
    if [image.width, image.height] != [side; 2] {
        return Err(Fault::new(
            format!("it is {}x{}", image.width, image.height),
            format!("{side}x{side}"),
        ));
    }
    let texels = image.data.as_flattened();
    let bottom_up = RGBD.image(side, side, texels, &Interpretation::default())?;
    Ok(flipped(&bottom_up))
}

/// Reverses the rows.
fn flipped(image: &RgbImage) -> RgbImage {
    RgbImage::from_fn(image.width, image.height, |x, y| {
        image.get(x, image.height - 1 - y)
    })
}

impl Polynomial {
    /// Converts to coefficients of radiance in the map's axes.
    fn coefficients(&self) -> Coefficients {
        let term =
            |color: [f64; 3], degree: usize| DVec3::from_array(color) * DEGREE_FACTORS[degree];
        let squares = [self.xx, self.yy, self.zz].map(DVec3::from_array);
        let mean = squares.iter().sum::<DVec3>() / 3.0;
        // Without their mean the squares are of degree 2: c z² + ... = s6 (3 z² - 1) + s8 (x² - y²).
        let [xx, yy, zz] = squares.map(|square| DEGREE_FACTORS[2] * (square - mean));
        sh::from_irradiance_terms([
            mean,
            term(self.y, 1),
            term(self.z, 1),
            term(self.x, 1),
            term(self.xy, 2),
            term(self.yz, 2),
            0.5 * zz,
            term(self.zx, 2),
            0.5 * (xx - yy),
        ])
    }

    /// Inverse of [`Self::coefficients`].
    fn of_radiance(radiance: &Sh9) -> Self {
        let [s0, y, z, x, xy, yz, s6, zx, s8] = sh::scaled(radiance).map(DVec3::from_array);
        let one = |value: DVec3| (value / DEGREE_FACTORS[1]).to_array();
        let two = |value: DVec3| value / DEGREE_FACTORS[2];
        Self {
            x: one(x),
            y: one(y),
            z: one(z),
            xx: (s0 + two(s8 - s6)).to_array(),
            yy: (s0 - two(s8 + s6)).to_array(),
            zz: (s0 + two(2.0 * s6)).to_array(),
            yz: two(yz).to_array(),
            zx: two(zx).to_array(),
            xy: two(xy).to_array(),
        }
    }
}

/// Writes a file of levels with rows from the top, and of coefficients in the same axes.
pub fn write(levels: &[Vec<RgbImage>], radiance: &Sh9) -> Vec<u8> {
    let mut images = Vec::new();
    let mut mipmaps = Vec::new();
    for face in levels.iter().flatten() {
        let texels = RGBD.bytes_of(&flipped(face));
        let pixels = Pixels::new(face.width, face.height, texels.as_chunks::<4>().0.to_vec());
        let image = png::encode_rgba8(&pixels).expect("memory does not fail");
        mipmaps.push(Placement {
            length: image.len(),
            position: images.len(),
        });
        images.extend(image);
    }
    let header = Header {
        version: 2,
        width: levels[0][0].width,
        image_type: png_type(),
        irradiance: Some(Polynomial::of_radiance(radiance)),
        specular: Specular {
            mipmaps,
            lod_generation_scale: LOD_GENERATION_SCALE,
        },
    };
    let json = serde_json::to_vec(&header).expect("plain values");
    [&MAGIC[..], &json, &[0], &images].concat()
}
