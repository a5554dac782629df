//! Nine coefficients of spherical harmonics in files: cmgen's text, our JSON, and F3D's tables.

use super::f3d_sh;
use crate::base::files::{TEXT_BYTES_MAX, read_text};
use crate::base::math::spherical_harmonics::{COSINE_LOBE, COUNT, DEGREE, basis};
use crate::base::pixels::{Fault, PixelsError};
use crate::instrument::precompute::sh9::reference::Sh9;
use glam::DVec3;
use std::f64::consts::PI;
use std::path::Path;

/// Coefficients of radiance as in [`crate::base::math::spherical_harmonics`], in the file's axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Coefficients {
    pub radiance: Sh9,
    /// The file's number over each coefficient.
    pub factors: [f64; COUNT],
}

/// Reads `.json` as ours, `.vtt` as F3D's and other text as cmgen's. Numbers alone are read as
/// cmgen's, with a warning.
pub fn read(path: &Path, warnings: &mut Vec<String>) -> Result<Coefficients, PixelsError> {
    let text = read_text(path, TEXT_BYTES_MAX).map_err(|error| {
        Fault::new(
            format!("cannot be read ({error})"),
            "a text of nine coefficients",
        )
        .in_file(path)
    })?;
    let found = parse(path, &text)?;
    if is_bare(path, &text) {
        warnings.push(
            "its numbers have no comment; they are read as cmgen's, which multiply polynomials in \
             irradiance over pi"
                .to_owned(),
        );
    }
    Ok(found)
}

fn is_json(path: &Path) -> bool {
    has_extension(path, "json")
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

/// Whether a text has numbers but no words.
fn is_bare(path: &Path, text: &str) -> bool {
    let is_word = |word: &str| word.chars().any(char::is_alphabetic) && number(word).is_none();
    !is_json(path) && !words_of(text).any(is_word)
}

/// Splits a text at all that is not part of a number or a word.
fn words_of(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || matches!(c, '.' | '+' | '-' | '_')))
        .filter(|word| !word.is_empty())
}

/// Parses a number, which may end in the f of a literal.
fn number(word: &str) -> Option<f64> {
    word.trim_end_matches('f').parse().ok()
}

/// Parses the text of the file at `path`.
pub fn parse(path: &Path, text: &str) -> Result<Coefficients, PixelsError> {
    let found = if has_extension(path, f3d_sh::EXTENSION) {
        f3d_sh::read(text.as_bytes()).map(|radiance| Coefficients {
            radiance,
            factors: [1.0; COUNT],
        })
    } else if is_json(path) {
        from_json(text)
    } else if is_bare(path, text) {
        from_numbers(text)
    } else {
        from_cmgen(text)
    };
    found.map_err(|fault| fault.in_file(path))
}

fn from_json(text: &str) -> Result<Coefficients, Fault> {
    const EXPECTED: &str = "the sh9.json of splitsum bake: \"radiance\" with 9 triples";
    #[derive(serde::Deserialize)]
    struct File {
        radiance: Vec<[f64; 3]>,
    }
    let file: File = serde_json::from_str(text)
        .map_err(|error| Fault::new(format!("cannot be read ({error})"), EXPECTED))?;
    let count = file.radiance.len();
    let radiance = <[[f64; 3]; COUNT]>::try_from(file.radiance)
        .map_err(|_| Fault::new(format!("\"radiance\" has {count} triples"), EXPECTED))?;
    finite(Coefficients {
        radiance: radiance.map(DVec3::from_array),
        factors: [1.0; COUNT],
    })
}

/// Parses cmgen's lines `( r, g, b); // L00, irradiance, pre-scaled base`. Each number multiplies
/// its polynomial, such as `3 z² - 1`, in irradiance over π.
fn from_cmgen(text: &str) -> Result<Coefficients, Fault> {
    const EXPECTED: &str = "nine lines such as \"( 0.5, 0.4, 0.6); // L00, irradiance, pre-scaled \
                            base\", as cmgen writes them";
    let mut found = Vec::new();
    for (number, line) in (1..)
        .zip(text.lines())
        .filter(|(_, line)| !line.trim().is_empty())
    {
        // Other bases need other factors, so they are refused.
        let is_prescaled = line.contains("irradiance") && line.contains("pre-scaled");
        let Some(triple) = triple(line).filter(|_| is_prescaled) else {
            return Err(Fault::new(
                format!("line {number} is not a coefficient of irradiance"),
                EXPECTED,
            ));
        };
        found.push(triple);
    }
    from_scaled(found, EXPECTED)
}

/// Parses nine triples of numbers without a word.
fn from_numbers(text: &str) -> Result<Coefficients, Fault> {
    const EXPECTED: &str = "nine triples of red, green and blue";
    let numbers: Vec<f64> = words_of(text).filter_map(number).collect();
    let (triples, rest) = numbers.as_chunks::<3>();
    if !rest.is_empty() || numbers.len() != words_of(text).count() {
        let what = format!("it has {} numbers", numbers.len());
        return Err(Fault::new(what, EXPECTED));
    }
    from_scaled(
        triples.iter().map(|rgb| DVec3::from_array(*rgb)).collect(),
        EXPECTED,
    )
}

/// Takes factors of cmgen's polynomials, such as `3 z² - 1`, in irradiance over π.
pub fn from_irradiance_terms(scaled: Sh9) -> Coefficients {
    let factors = prescaled();
    Coefficients {
        radiance: std::array::from_fn(|k| scaled[k] / factors[k]),
        factors,
    }
}

/// Divides by the factors of cmgen.
fn from_scaled(found: Vec<DVec3>, expected: &str) -> Result<Coefficients, Fault> {
    let count = found.len();
    let scaled = Sh9::try_from(found)
        .map_err(|_| Fault::new(format!("it has {count} coefficients"), expected))?;
    finite(from_irradiance_terms(scaled))
}

/// Parses the numbers of a line that starts with `(r, g, b)`.
fn triple(line: &str) -> Option<DVec3> {
    let (numbers, _) = line.trim_start().strip_prefix('(')?.split_once(')')?;
    let numbers: Vec<f64> = numbers
        .split(',')
        .map(|number| number.trim().parse().ok())
        .collect::<Option<_>>()?;
    Some(DVec3::from_array(numbers.try_into().ok()?))
}

/// Returns cmgen's coefficient over ours for each function: `A_l / π` times the constant of its
/// polynomial.
pub fn prescaled() -> [f64; COUNT] {
    // At z = 1 the polynomials z and 3 z² - 1 are 1 and 2; xy, yz and xz are 1/2 at a diagonal.
    let [x, y, z] = DVec3::AXES;
    let directions = [z, y, z, x, x + y, y + z, z, x + z, x];
    let polynomials = [1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 2.0, 0.5, 1.0];
    std::array::from_fn(|k| {
        basis(directions[k].normalize())[k] / polynomials[k] * COSINE_LOBE[DEGREE[k]] / PI
    })
}

/// Writes the coefficients as cmgen does.
pub fn to_cmgen(radiance: &Sh9) -> String {
    const NAMES: [&str; COUNT] = [
        "L00", "L1-1", "L10", "L11", "L2-2", "L2-1", "L20", "L21", "L22",
    ];
    NAMES
        .into_iter()
        .zip(scaled(radiance))
        .map(|(name, [r, g, b])| {
            format!("({r:18.15}, {g:18.15}, {b:18.15}); // {name}, irradiance, pre-scaled base\n")
        })
        .collect()
}

/// Returns cmgen's coefficients.
pub fn scaled(radiance: &Sh9) -> [[f64; 3]; COUNT] {
    let factors = prescaled();
    std::array::from_fn(|k| (radiance[k] * factors[k]).to_array())
}

fn finite(found: Coefficients) -> Result<Coefficients, Fault> {
    match found.radiance.iter().position(|triple| !triple.is_finite()) {
        Some(k) => Err(Fault::new(
            format!("coefficient {k} is {:?}", found.radiance[k].to_array()),
            "finite numbers",
        )),
        None => Ok(found),
    }
}
