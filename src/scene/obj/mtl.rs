//! Materials of OBJ files.
//!
//! | read | becomes | without it |
//! |---|---|---|
//! | `Kd` | albedo | 0.8 grey, white under a `map_Kd` |
//! | `map_Kd` | albedo map (PNG or JPEG, sRGB); multiplies `Kd` | none |
//! | `Pm` | metallic | 0 |
//! | `Pr` | alpha = Pr² | from `Ns` |
//! | `Ns` | alpha = sqrt(2 / (Ns + 2)), the width of a Phong lobe of that exponent | 0.25 |
//! | `Ni` above 1 | f0 = ((Ni - 1) / (Ni + 1))² | 0.04 |
//!
//! `Ks` is not read: exporters fill it with the strength of a legacy highlight more often than with a reflectance. `Ni 1` is what exporters
//! write who know no index of refraction, so it counts as absent. Values outside their range are clamped with a warning; what is no number
//! is refused.

use super::add_first;
use super::lines::{logical_lines, number, split_keyword};

use crate::brdf;
use crate::glsl::constants::ALPHA_MIN;
use crate::scene::SceneError;
use crate::scene::material::{DEFAULT_ALBEDO, DEFAULT_ALPHA, Material};
use crate::scene::source::{SceneFiles, existing};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The checked statements of all material libraries of a file.
#[derive(Debug, Default)]
pub struct Libraries {
    /// The materials as `tobj` shall see them; the argument of a `map_Kd` is an index into `maps`.
    pub text: String,
    /// Albedo maps, each once.
    pub maps: Vec<PathBuf>,
    /// Warnings about libraries that cannot be read.
    pub unreadable: Vec<String>,
}

impl Libraries {
    /// Adds the library at `path`. A library that cannot be read adds to the warnings of those only.
    pub fn add(&mut self, files: &dyn SceneFiles, path: &Path, warnings: &mut Vec<String>) -> Result<(), SceneError> {
        let bytes = match files.read(path) {
            Ok(bytes) => bytes,
            Err(source) => {
                self.unreadable.push(format!(
                    "{}: cannot read the materials: {source}; the default material is used",
                    path.display()
                ));
                return Ok(());
            }
        };
        let (mut unread, mut odd) = (Vec::new(), Vec::new());
        for (line, logical) in logical_lines(&String::from_utf8_lossy(&bytes)) {
            let (keyword, rest) = split_keyword(&logical);
            let warn_at_line = |message: String| format!("{}:{line}: {message}", path.display());
            let scalar = |range: [f32; 2]| match rest.split_whitespace().next() {
                Some(word) => number(word).map(|value| (value.clamp(range[0], range[1]), value)),
                None => Err("no value".to_owned()),
            };
            let result = match keyword {
                "newmtl" if rest.is_empty() => Err("expected a name".to_owned()),
                "newmtl" => {
                    let _ = writeln!(self.text, "newmtl {rest}");
                    Ok(())
                }
                "Kd" if ["spectral", "xyz"].contains(&split_keyword(rest).0) => {
                    odd.push(warn_at_line(format!("Kd {rest} is not RGB and is not read")));
                    Ok(())
                }
                "Kd" => color(rest).map(|rgb| {
                    let clamped = rgb.map(|x| x.clamp(0.0, 1.0));
                    if clamped != rgb {
                        odd.push(warn_at_line(format!("Kd {rest} is outside 0 to 1 and is clamped")));
                    }
                    let _ = writeln!(self.text, "Kd {} {} {}", clamped[0], clamped[1], clamped[2]);
                }),
                "Pr" | "Pm" | "Ns" | "Ni" => {
                    let range = if keyword.starts_with('P') { [0.0, 1.0] } else { [0.0, f32::MAX] };
                    scalar(range).map(|(clamped, value)| {
                        if clamped != value {
                            odd.push(warn_at_line(format!(
                                "{keyword} {value} is outside its range and is read as {clamped}"
                            )));
                        }
                        let _ = writeln!(self.text, "{keyword} {clamped}");
                    })
                }
                "map_Kd" => map_file(rest).map(|(file, has_options)| {
                    if has_options {
                        odd.push(warn_at_line("the options of map_Kd are not read".to_owned()));
                    }
                    let map = existing(files, path, file);
                    let index = self.maps.iter().position(|known| *known == map).unwrap_or_else(|| {
                        self.maps.push(map);
                        self.maps.len() - 1
                    });
                    let _ = writeln!(self.text, "map_Kd {index}");
                }),
                "map_Pr" | "map_Pm" | "map_Ns" | "map_d" | "map_Bump" | "map_bump" | "bump" | "norm" | "disp" => {
                    if !unread.contains(&keyword.to_owned()) {
                        unread.push(keyword.to_owned());
                    }
                    Ok(())
                }
                _ => Ok(()),
            };
            result.map_err(|message| SceneError::of_line(path, line, format!("{keyword}: {message}")))?;
        }
        add_first(warnings, odd);
        if !unread.is_empty() {
            warnings.push(format!("{}: {} are not read", path.display(), unread.join(", ")));
        }
        Ok(())
    }
}

/// Three numbers, or one that stands for all three.
fn color(values: &str) -> Result<[f32; 3], String> {
    let numbers = values.split_whitespace().take(3).map(number).collect::<Result<Vec<_>, _>>()?;
    match numbers[..] {
        [grey] => Ok([grey; 3]),
        [r, g, b] => Ok([r, g, b]),
        _ => Err(format!("{} values, expected 3", numbers.len())),
    }
}

/// The file name of a texture statement without its options, and whether there were any. File names may hold spaces.
fn map_file(rest: &str) -> Result<(&str, bool), String> {
    let mut left = rest;
    while left.starts_with('-') {
        let (option, after) = split_keyword(left);
        let (least, most) = match option {
            "-mm" => (2, 2),
            // One to three numbers.
            "-o" | "-s" | "-t" => (1, 3),
            _ => (1, 1),
        };
        left = after;
        for i in 0..most {
            let (word, after) = split_keyword(left);
            if i >= least && number(word).is_err() {
                break;
            }
            left = after;
        }
    }
    if left.is_empty() {
        return Err("expected a file name".to_owned());
    }
    Ok((left, left.len() != rest.len()))
}

/// The material of a checked library. `maps` gives the texture of each of [`Libraries::maps`], `None` for those that could not be read.
pub fn material(source: &tobj::Material, maps: &[Option<usize>]) -> Material {
    let default = Material::default();
    let parameter = |name: &str| source.unknown_param.get(name).and_then(|value| value.parse::<f32>().ok());
    let map = source.diffuse_texture.as_ref().and_then(|index| index.parse::<usize>().ok());
    let albedo_map = map.and_then(|index| maps.get(index).copied().flatten());
    let alpha = match (parameter("Pr"), source.shininess) {
        (Some(perceptual_roughness), _) => {
            brdf::alpha_from_perceptual_roughness(f64::from(perceptual_roughness)) as f32
        }
        (None, Some(exponent)) => (2.0 / (exponent + 2.0)).sqrt(),
        (None, None) => DEFAULT_ALPHA,
    };
    let f0 = source.optical_density.filter(|&ior| ior > 1.0).map(|ior| [brdf::f0_from_ior(f64::from(ior)) as f32; 3]);
    Material {
        name: source.name.clone(),
        albedo: source.diffuse.unwrap_or(if albedo_map.is_some() { [1.0; 3] } else { [DEFAULT_ALBEDO; 3] }),
        albedo_map,
        metallic: parameter("Pm").unwrap_or(default.metallic),
        // A file may ask for a mirror (Pr 0); narrower lobes are not shaded.
        alpha: alpha.max(ALPHA_MIN),
        f0: f0.unwrap_or(default.f0),
        ..default
    }
}
