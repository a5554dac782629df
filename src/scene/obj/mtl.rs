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
//! `Ks` is ignored: exporters rarely write a reflectance there. `Ni 1` counts as missing: exporters write it when they know no
//! index of refraction. Values outside their range are clamped with a warning; values that are not numbers are refused.

use super::add_first;
use super::lines::{logical_lines, number, split_keyword};
use crate::brdf;
use crate::glsl::constants::ALPHA_MIN;
use crate::scene::SceneError;
use crate::scene::material::{DEFAULT_ALBEDO, DEFAULT_ALPHA, Material};
use crate::scene::source::{SceneFiles, existing};
use std::path::{Path, PathBuf};

/// The material libraries of a file.
#[derive(Debug, Default)]
pub struct Libraries {
    pub materials: Vec<Source>,
    /// Albedo maps, each once.
    pub maps: Vec<PathBuf>,
    /// Warnings about libraries that cannot be read.
    pub unreadable: Vec<String>,
}

/// A material's statements.
#[derive(Debug, Default)]
pub struct Source {
    pub name: String,
    kd: Option<[f32; 3]>,
    /// Index into [`Libraries::maps`].
    map_kd: Option<usize>,
    pr: Option<f32>,
    pm: Option<f32>,
    ns: Option<f32>,
    ni: Option<f32>,
}

impl Libraries {
    /// Adds the library at `path`, or a warning to `unreadable`.
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
            let mut warn = |message: String| odd.push(format!("{}:{line}: {message}", path.display()));
            self.statement(&logical, files, path, &mut warn, &mut unread)
                .map_err(|message| SceneError::of_line(path, line, message))?;
        }
        add_first(warnings, odd);
        if !unread.is_empty() {
            warnings.push(format!("{}: {} are not read", path.display(), unread.join(", ")));
        }
        Ok(())
    }

    fn statement(
        &mut self,
        logical: &str,
        files: &dyn SceneFiles,
        path: &Path,
        warn: &mut dyn FnMut(String),
        unread: &mut Vec<String>,
    ) -> Result<(), String> {
        let (keyword, rest) = split_keyword(logical);
        let fault = |message: String| format!("{keyword}: {message}");
        // Statements before the first material have no effect.
        let mut before = Source::default();
        let material = self.materials.last_mut().unwrap_or(&mut before);
        match keyword {
            "newmtl" if rest.is_empty() => return Err(fault("expected a name".to_owned())),
            "newmtl" => self.materials.push(Source { name: rest.to_owned(), ..Source::default() }),
            "Kd" if ["spectral", "xyz"].contains(&split_keyword(rest).0) => {
                warn(format!("Kd {rest} is not RGB and is not read"));
            }
            "Kd" => {
                let rgb = color(rest).map_err(fault)?;
                let clamped = rgb.map(|x| x.clamp(0.0, 1.0));
                if clamped != rgb {
                    warn(format!("Kd {rest} is outside 0 to 1 and is clamped"));
                }
                material.kd = Some(clamped);
            }
            "Pr" | "Pm" | "Ns" | "Ni" => {
                let value =
                    rest.split_whitespace().next().ok_or("no value".to_owned()).and_then(number).map_err(fault)?;
                let clamped = value.clamp(0.0, if keyword.starts_with('P') { 1.0 } else { f32::MAX });
                if clamped != value {
                    warn(format!("{keyword} {value} is outside its range and is read as {clamped}"));
                }
                let place = match keyword {
                    "Pr" => &mut material.pr,
                    "Pm" => &mut material.pm,
                    "Ns" => &mut material.ns,
                    _ => &mut material.ni,
                };
                *place = Some(clamped);
            }
            "map_Kd" => {
                let (file, has_options) = map_file(rest).map_err(fault)?;
                if has_options {
                    warn("the options of map_Kd are not read".to_owned());
                }
                let map = existing(files, path, file);
                material.map_kd = Some(self.maps.iter().position(|known| *known == map).unwrap_or_else(|| {
                    self.maps.push(map);
                    self.maps.len() - 1
                }));
            }
            "map_Pr" | "map_Pm" | "map_Ns" | "map_d" | "map_Bump" | "map_bump" | "bump" | "norm" | "disp"
                if !unread.iter().any(|known| known == keyword) =>
            {
                unread.push(keyword.to_owned());
            }
            _ => {}
        }
        Ok(())
    }
}

/// Parses three numbers, or one grey.
fn color(values: &str) -> Result<[f32; 3], String> {
    let numbers = values.split_whitespace().take(3).map(number).collect::<Result<Vec<_>, _>>()?;
    match numbers[..] {
        [grey] => Ok([grey; 3]),
        [r, g, b] => Ok([r, g, b]),
        _ => Err(format!("{} values; expected 3", numbers.len())),
    }
}

/// Returns the file name of a texture statement, which may contain spaces, and whether options precede it.
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

impl Source {
    /// Builds the material. `maps` has the texture of each of [`Libraries::maps`], `None` for unreadable ones.
    pub fn material(&self, maps: &[Option<usize>]) -> Material {
        let default = Material::default();
        let albedo_map = self.map_kd.and_then(|index| maps[index]);
        let alpha = match (self.pr, self.ns) {
            (Some(roughness), _) => brdf::alpha_from_perceptual_roughness(f64::from(roughness)) as f32,
            (None, Some(exponent)) => (2.0 / (exponent + 2.0)).sqrt(),
            (None, None) => DEFAULT_ALPHA,
        };
        let f0 = self.ni.filter(|&ior| ior > 1.0).map(|ior| [brdf::f0_from_ior(f64::from(ior)) as f32; 3]);
        Material {
            name: self.name.clone(),
            albedo: self.kd.unwrap_or(if albedo_map.is_some() { [1.0; 3] } else { [DEFAULT_ALBEDO; 3] }),
            albedo_map,
            metallic: self.pm.unwrap_or(default.metallic),
            // Narrower lobes, such as a mirror's (Pr 0), are not shaded.
            alpha: alpha.max(ALPHA_MIN),
            f0: f0.unwrap_or(default.f0),
            ..default
        }
    }
}
