//! Loads environments from files and formulas.

use super::Environment;
use super::builtin::{self, BUILTIN_PREFIX};
use super::error::{EnvironmentError, MAX_RADIANCE, unusable};
use crate::base::color::luminance;
use crate::base::pixels::{Decoded, PixelsError, RgbImage, exr, radiance, read_bounded};
use std::path::{Path, PathBuf};

/// Decodes the bytes of the file at a path: its main image, or the named layer.
type Reader = fn(&Path, &[u8], Option<&str>) -> Result<Decoded, PixelsError>;

#[derive(Debug)]
pub struct Format {
    pub name: &'static str,
    /// Lower-case file name extension.
    pub extension: &'static str,
    pub about: &'static str,
    read: Reader,
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
        name: "openexr",
        extension: "exr",
        about: "OpenEXR with R, G, B channels (half, float or uint): the first part with colour, \
                or FILE#NAME for a layer or part",
        read: exr::read_bytes,
    },
];

#[derive(Clone, Debug, PartialEq)]
pub struct LoadOptions {
    /// Sets NaN, infinite and negative channels to 0 with a warning; otherwise they are an error.
    pub clamp_invalid: bool,
    pub builtin_size: [u32; 2],
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self {
            clamp_invalid: false,
            builtin_size: [512, 256],
        }
    }
}

/// Relative deviation from 2:1 that rounding of a size can explain.
const ASPECT_TOLERANCE: f64 = 0.01;

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
        let (path, layer) = file_and_layer(spec, base_dir);
        if spec.is_empty() || !path.exists() {
            // A name with a folder or an extension means a file: suggesting a formula would not
            // help.
            let is_word = !spec.contains(['/', '\\']) && Path::new(spec).extension().is_none();
            let hint = match builtin::nearest(spec).filter(|_| is_word) {
                Some(name) => format!("; did you mean {BUILTIN_PREFIX}{name}?"),
                None => format!("; expected a file, FILE.exr#LAYER or {BUILTIN_PREFIX}NAME"),
            };
            let is_elsewhere = path.as_os_str() != spec && !spec.is_empty();
            let place = if is_elsewhere {
                format!(" {}", path.display())
            } else {
                String::new()
            };
            return Err(unusable(spec, format!("no such file{place}{hint}")));
        }
        let format = format_of(spec, &path)?;
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
        checked(
            &spec,
            (format_of(&spec, path)?.read)(path, bytes, None)?,
            options,
        )
    }
}

/// Splits `NAME` or `FILE#LAYER` into path and layer. A file whose own name contains `#` takes
/// precedence.
fn file_and_layer<'a>(spec: &'a str, base_dir: &Path) -> (PathBuf, Option<&'a str>) {
    let whole = base_dir.join(spec);
    if !whole.exists() {
        for (at, sign) in spec.rmatch_indices('#').filter(|(at, _)| *at > 0) {
            let path = base_dir.join(&spec[..at]);
            if path.is_file() {
                return (path, Some(&spec[at + sign.len()..]));
            }
        }
    }
    (whole, None)
}

fn format_of(spec: &str, path: &Path) -> Result<&'static Format, EnvironmentError> {
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase())
        .unwrap_or_default();
    FORMATS
        .iter()
        .find(|format| format.extension == extension)
        .ok_or_else(|| {
            let expected = FORMATS
                .iter()
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
        mut warnings,
        ..
    } = decoded;
    if let Some(found) = invalid_texels(&image) {
        if !options.clamp_invalid {
            return Err(EnvironmentError::InvalidTexels {
                spec: spec.to_owned(),
                found,
            });
        }
        clamp_invalid(&mut image);
        warnings.push(format!("{found}; these channels were set to 0."));
    }
    let (index, peak) =
        image
            .data
            .as_flattened()
            .iter()
            .enumerate()
            .fold(
                (0, 0.0),
                |most, (i, &value)| if value > most.1 { (i / 3, value) } else { most },
            );
    if peak > MAX_RADIANCE {
        let (x, y) = (index % image.width as usize, index / image.width as usize);
        let what = format!(
            "the largest value is {peak:e}, at column {x}, row {y}; expected at most \
             {MAX_RADIANCE:e}, above which sums of squares \
             overflow (scale the file)"
        );
        return Err(unusable(spec, what));
    }
    warnings.extend(oddities(&image));
    Ok(Environment {
        warnings,
        ..Environment::from_image(spec, image)
    })
}

/// Counts values that cannot be radiance and names the first; `None` if every channel is finite and
/// not negative.
fn invalid_texels(image: &RgbImage) -> Option<String> {
    let (mut nan, mut infinite, mut negative) = (0u64, 0u64, 0u64);
    let mut first = None;
    for (i, texel) in image.data.iter().enumerate() {
        for (channel, &value) in ["R", "G", "B"].iter().zip(texel) {
            let count = match value {
                v if v.is_nan() => &mut nan,
                v if v.is_infinite() => &mut infinite,
                v if v < 0.0 => &mut negative,
                _ => continue,
            };
            *count += 1;
            first.get_or_insert((
                i % image.width as usize,
                i / image.width as usize,
                channel,
                value,
            ));
        }
    }
    let (x, y, channel, value) = first?;
    let counts: Vec<String> = [(nan, "NaN"), (infinite, "infinite"), (negative, "negative")]
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, kind)| format!("{count} {kind}"))
        .collect();
    Some(format!(
        "{} channel values, the first at column {x}, row {y}: {channel} = {value}",
        counts.join(", ")
    ))
}

fn clamp_invalid(image: &mut RgbImage) {
    for value in image.data.as_flattened_mut() {
        if !(value.is_finite() && *value >= 0.0) {
            *value = 0.0;
        }
    }
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
