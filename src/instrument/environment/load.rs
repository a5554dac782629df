//! Loads environments from files and formulas.

use super::Environment;
use super::builtin::{self, BUILTIN_PREFIX};
use super::error::{EnvironmentError, MAX_RADIANCE, not_radiance, unusable};
use super::faces::{check_not_a_cross, check_not_a_strip};
use super::resample::{Cube, from_edges};
use crate::base::color::luminance;
#[cfg(feature = "gpu")]
use crate::base::pixels::gain_map;
use crate::base::pixels::{
    Content, Decoded, Fault, GrayImage, HALF_MAX, PixelsError, Projection, RgbImage, TexelPosition,
    exr, radiance, read_bounded,
};
use std::fmt;
use std::path::{Path, PathBuf};

/// Decodes the bytes of the file at a path: its main image, or what the text after `#` names.
type Reader = fn(&Path, &[u8], Option<&str>) -> Result<Decoded, PixelsError>;

#[derive(Debug)]
pub struct Format {
    pub name: &'static str,
    /// Lower-case file name extension.
    pub extension: &'static str,
    pub about: &'static str,
    pub(crate) read: Reader,
}

/// Formats have names of their own.
impl PartialEq for Format {
    fn eq(&self, other: &Self) -> bool {
        (self.name, self.extension) == (other.name, other.extension)
    }
}

impl Format {
    /// Decodes the main image in the bytes of the file at `path`.
    pub(crate) fn read(&self, path: &Path, bytes: &[u8]) -> Result<Decoded, PixelsError> {
        (self.read)(path, bytes, None)
    }
}

/// Every format; the file's extension selects one.
pub static FORMATS: &[Format] = &[
    Format {
        name: "radiance",
        extension: "hdr",
        about: "Radiance RGBE, run-length coded or flat, any orientation; EXPOSURE is divided out",
        read: radiance::read_bytes,
    },
    Format {
        name: "radiance",
        extension: "pic",
        about: "the same under the name that the Radiance programs use",
        read: radiance::read_bytes,
    },
    Format {
        name: "openexr",
        extension: "exr",
        about: "OpenEXR with R, G, B channels (half, float or uint): the first part with colour, \
                or FILE#NAME for a layer or part",
        read: exr::read_bytes,
    },
    #[cfg(feature = "gpu")]
    Format {
        name: "gain-map",
        extension: "jpg",
        about: "JPEG with a gain map (UltraHDR); a plain JPEG holds no radiance",
        read: gain_map::read_bytes,
    },
    #[cfg(feature = "gpu")]
    Format {
        name: "gain-map",
        extension: "jpeg",
        about: "the same under its longer name",
        read: gain_map::read_bytes,
    },
];

#[derive(Clone, Debug, PartialEq)]
pub struct LoadOptions {
    /// Sets NaN and negative channels to 0 and +infinity to the largest finite value, with a
    /// warning; otherwise they are an error.
    pub clamp_invalid: bool,
    /// Where the outermost texels of a file lie; `None` leaves that to the format.
    pub texels: Option<TexelPosition>,
    /// Formats beyond [`FORMATS`]: folders that import this one read them.
    pub more_formats: &'static [Format],
    pub builtin_size: [u32; 2],
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self {
            clamp_invalid: false,
            texels: None,
            more_formats: &[],
            builtin_size: [512, 256],
        }
    }
}

/// Relative deviation from 2:1 that rounding of a size can explain.
const ASPECT_TOLERANCE: f64 = 0.01;
/// Alpha from which a pixel is opaque: lossy compression changes it a little.
const OPAQUE: f32 = 0.99;

impl Environment {
    /// Loads `builtin:NAME[:PARAMETER=VALUE,...]`, an image file or `FILE.exr#LAYER`; paths are
    /// relative to `base_dir`.
    pub fn load(
        spec: &str,
        base_dir: &Path,
        options: &LoadOptions,
    ) -> Result<Self, EnvironmentError> {
        if let Some(formula) = spec.strip_prefix(BUILTIN_PREFIX) {
            return Ok(Environment::from_image(
                spec,
                builtin::make(spec, formula, options.builtin_size)?,
            ));
        }
        let FileLayer { path, layer } = FileLayer::of_spec(spec, base_dir);
        if spec.is_empty() || !path.exists() {
            return Err(no_such_file(spec, &path));
        }
        let format = format_of(spec, &path, options)?;
        let decoded = (format.read)(&path, &read_bounded(&path)?, layer)?;
        checked(spec, decoded, options)
    }

    /// Loads `builtin:NAME` or an image file with default options. Relative paths start at the
    /// working directory.
    pub fn open(spec: &str) -> Result<Self, EnvironmentError> {
        Self::load(spec, Path::new(""), &LoadOptions::default())
    }

    /// Decodes the bytes of the image file at `path`, whose extension names the format. Nothing is
    /// read from disk.
    pub fn from_bytes(
        path: &Path,
        bytes: &[u8],
        options: &LoadOptions,
    ) -> Result<Self, EnvironmentError> {
        let spec = path.to_string_lossy();
        let decoded = format_of(&spec, path, options)?.read(path, bytes)?;
        checked(&spec, decoded, options)
    }
}

/// A file, and the layer of it that is asked for.
struct FileLayer<'a> {
    path: PathBuf,
    layer: Option<&'a str>,
}

impl<'a> FileLayer<'a> {
    /// Splits `NAME` or `FILE#LAYER`. A file whose own name contains `#` takes precedence.
    fn of_spec(spec: &'a str, base_dir: &Path) -> Self {
        let whole = base_dir.join(spec);
        if !whole.exists() {
            for (index, sign) in spec.rmatch_indices('#').filter(|(index, _)| *index > 0) {
                let path = base_dir.join(&spec[..index]);
                if path.is_file() {
                    let layer = Some(&spec[index + sign.len()..]);
                    return Self { path, layer };
                }
            }
        }
        Self {
            path: whole,
            layer: None,
        }
    }
}

fn no_such_file(spec: &str, path: &Path) -> EnvironmentError {
    // A name with a folder or an extension means a file: suggesting a formula would not help.
    let is_word = !spec.contains(['/', '\\']) && Path::new(spec).extension().is_none();
    let hint = match builtin::nearest(spec).filter(|_| is_word) {
        Some(name) => format!("; did you mean {BUILTIN_PREFIX}{name}?"),
        None => format!("; expected a file, FILE.exr#LAYER or {BUILTIN_PREFIX}NAME"),
    };
    let is_elsewhere = path.as_os_str() != spec && !spec.is_empty();
    let shown_path = if is_elsewhere {
        format!(" {}", path.display())
    } else {
        String::new()
    };
    unusable(spec, format!("no such file{shown_path}{hint}"))
}

/// Returns the format that a file's extension selects.
fn format_of(
    spec: &str,
    path: &Path,
    options: &LoadOptions,
) -> Result<&'static Format, EnvironmentError> {
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase())
        .unwrap_or_default();
    let formats = || FORMATS.iter().chain(options.more_formats);
    formats()
        .find(|format| format.extension == extension)
        .ok_or_else(|| {
            let expected = formats()
                .map(|format| format!(".{}", format.extension))
                .collect::<Vec<_>>()
                .join(", ");
            let what = if path.is_dir() {
                "it is a folder".to_owned()
            } else {
                format!("the extension is {extension:?}")
            };
            unusable(spec, format!("{what}; expected one of {expected}"))
        })
}

/// Checks the texels of a map in memory; `spec` names it in messages.
pub fn checked(
    spec: &str,
    decoded: Decoded,
    options: &LoadOptions,
) -> Result<Environment, EnvironmentError> {
    let Decoded {
        rgb: mut image,
        alpha,
        mut warnings,
        content,
        projection,
    } = decoded;
    if content == Content::Data {
        let what = "it holds no colours, by its label; expected radiance".to_owned();
        return Err(not_radiance(spec, what));
    }
    if let Some(invalid) = InvalidChannels::find(&image) {
        if invalid.is_rounding(&image) {
            warnings.push(format!(
                "{invalid}; lossy compression makes such, so they were set to 0."
            ));
        } else if options.clamp_invalid {
            warnings.push(invalid.clamped_words(&image));
        } else {
            return Err(EnvironmentError::InvalidTexels {
                spec: spec.to_owned(),
                found: invalid.to_string(),
            });
        }
        clamp_invalid(&mut image);
    }
    check_peak(spec, &image)?;
    warnings.extend(alpha.as_ref().and_then(transparency));
    if projection.is_none() {
        check_not_a_strip(spec, &image)?;
        check_not_a_cross(spec, &image)?;
    }
    let image = equirect(image, projection, options.texels, &mut warnings)
        .map_err(|fault| fault.in_file(Path::new(spec)))?;
    warnings.extend(oddities(&image));
    Ok(Environment {
        warnings,
        ..Environment::from_image(spec, image)
    })
}

/// The channels of a map that cannot be radiance.
struct InvalidChannels {
    nan_count: u64,
    infinite_count: u64,
    /// Of the infinite ones.
    positive_infinity_count: u64,
    negative_count: u64,
    first: InvalidChannel,
}

struct InvalidChannel {
    column: usize,
    row: usize,
    channel: &'static str,
    value: f32,
}

impl InvalidChannels {
    /// Returns `None` if every channel is finite and not negative.
    fn find(image: &RgbImage) -> Option<Self> {
        let mut nan_count = 0;
        let mut infinite_count = 0;
        let mut positive_infinity_count = 0;
        let mut negative_count = 0;
        let mut first = None;
        for (i, texel) in image.data.iter().enumerate() {
            for (channel, &value) in ["R", "G", "B"].into_iter().zip(texel) {
                if value.is_nan() {
                    nan_count += 1;
                } else if value.is_infinite() {
                    infinite_count += 1;
                    positive_infinity_count += u64::from(value > 0.0);
                } else if value < 0.0 {
                    negative_count += 1;
                } else {
                    continue;
                }
                first.get_or_insert_with(|| InvalidChannel {
                    column: i % image.width as usize,
                    row: i / image.width as usize,
                    channel,
                    value,
                });
            }
        }
        Some(Self {
            nan_count,
            infinite_count,
            positive_infinity_count,
            negative_count,
            first: first?,
        })
    }
}

impl fmt::Display for InvalidChannels {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let counts: Vec<String> = [
            (self.nan_count, "NaN"),
            (self.infinite_count, "infinite"),
            (self.negative_count, "negative"),
        ]
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, kind)| format!("{count} {kind}"))
        .collect();
        let InvalidChannel {
            column,
            row,
            channel,
            value,
        } = &self.first;
        write!(
            f,
            "{} channel values, the first at column {column}, row {row}: {channel} = {value}",
            counts.join(", ")
        )
    }
}

/// Largest negative value that compression makes of 0, over the mean of the map.
const ROUNDING: f64 = 1e-3;

impl InvalidChannels {
    /// Whether the values are what lossy compression (DWAA, B44) makes of dark texels.
    fn is_rounding(&self, image: &RgbImage) -> bool {
        if self.nan_count > 0 || self.infinite_count > 0 {
            return false;
        }
        let values = image.data.as_flattened();
        let sum: f64 = values.iter().map(|value| f64::from(*value)).sum();
        let limit = -ROUNDING * sum / values.len() as f64;
        values.iter().all(|value| f64::from(*value) >= limit)
    }

    /// Says what [`clamp_invalid`] makes of the values.
    fn clamped_words(&self, image: &RgbImage) -> String {
        if self.positive_infinity_count == 0 {
            return format!("{self}; these channels were set to 0.");
        }
        format!(
            "{self}; +infinity was set to {}, all others to 0.",
            largest_finite(image)
        )
    }
}

/// The value that stands for +infinity: a sun above the range of halves. At least the largest half,
/// which the file's own numbers may exceed.
fn largest_finite(image: &RgbImage) -> f32 {
    let finite = image
        .data
        .as_flattened()
        .iter()
        .filter(|value| value.is_finite());
    finite.copied().fold(HALF_MAX, f32::max)
}

fn clamp_invalid(image: &mut RgbImage) {
    let brightest = largest_finite(image);
    for value in image.data.as_flattened_mut() {
        if *value == f32::INFINITY {
            *value = brightest;
        } else if !(value.is_finite() && *value >= 0.0) {
            *value = 0.0;
        }
    }
}

/// Resamples an image of another projection, or with other texel centres.
fn equirect(
    image: RgbImage,
    projection: Option<Projection>,
    texels: Option<TexelPosition>,
    warnings: &mut Vec<String>,
) -> Result<RgbImage, Fault> {
    match (projection, texels) {
        (
            Some(Projection::Cube {
                texels: stated,
                file_from_world,
            }),
            _,
        ) => Cube {
            strip: &image,
            texels: texels.unwrap_or(stated),
            file_from_world,
        }
        .equirect(),
        (_, Some(TexelPosition::Edges)) => Ok(from_edges(&image)),
        (Some(Projection::LatLong), None) => {
            warnings.push(
                "The header calls the image a lat-long map: exrenvmap puts the outermost texel \
                 centres on its edges, maketx half a texel inside, as they were read; --texels \
                 edges or --texels centres says which."
                    .to_owned(),
            );
            Ok(image)
        }
        _ => Ok(image),
    }
}

/// Refuses values whose squares overflow in sums.
fn check_peak(spec: &str, image: &RgbImage) -> Result<(), EnvironmentError> {
    let mut peak = 0.0;
    let mut peak_index = 0;
    for (i, texel) in image.data.iter().enumerate() {
        for &value in texel {
            if value > peak {
                peak = value;
                peak_index = i;
            }
        }
    }
    if peak <= MAX_RADIANCE {
        return Ok(());
    }
    let column = peak_index % image.width as usize;
    let row = peak_index / image.width as usize;
    let what = format!(
        "the largest value is {peak:e}, at column {column}, row {row}; expected at most \
         {MAX_RADIANCE:e}, above which sums of squares overflow (scale the file)"
    );
    Err(not_radiance(spec, what))
}

/// Warns of pixels that are not opaque: formats with alpha store colours that are multiplied by it.
fn transparency(alpha: &GrayImage) -> Option<String> {
    let clear_count = alpha.data.iter().filter(|alpha| **alpha < OPAQUE).count();
    (clear_count > 0).then(|| {
        let share = 100.0 * clear_count as f64 / alpha.data.len() as f64;
        format!(
            "Alpha is below 1 in {share:.2} % of the pixels; their colours were taken as they are \
             stored, over black."
        )
    })
}

/// Returns warnings about a map with valid texels.
fn oddities(image: &RgbImage) -> Vec<String> {
    let mut warnings = Vec::new();
    let aspect = f64::from(image.width) / f64::from(image.height);
    if (aspect / 2.0 - 1.0).abs() > ASPECT_TOLERANCE {
        warnings.push(format!(
            "The map is {}x{} (aspect ratio {aspect:.3}); an equirectangular map is 2:1, so this \
             may be another projection.",
            image.width, image.height
        ));
    }
    if image.data.iter().all(|&texel| luminance(texel) == 0.0) {
        warnings.push("Every texel is 0: the environment is black.".to_owned());
    }
    warnings
}
