//! Materials of OBJ files.
//!
//! | read | becomes | without it |
//! |---|---|---|
//! | `Kd` (three numbers) | albedo | 0.8 grey, white under a `map_Kd` |
//! | `map_Kd` | albedo map (PNG or JPEG, sRGB); multiplies `Kd` | none |
//! | `Pm` | metallic | 0 |
//! | `Pr` | alpha = Pr² | from `Ns` |
//! | `Ns` | alpha = sqrt(2 / (Ns + 2)), the width of a Phong lobe of that exponent | 0.25 |
//! | `Ni` above 1 | f0 = ((Ni - 1) / (Ni + 1))² | 0.04 |
//!
//! `Ks` is ignored: exporters rarely write a reflectance there. `Ni 1` counts as missing: exporters
//! write it when they know no index of refraction. Values outside their range are clamped with a
//! warning; values that are not numbers are refused.

use super::statements::{Statements, check_numbers};
use crate::base::glsl::constants::ALPHA_MIN;
use crate::instrument::brdf;
use crate::instrument::scene::SceneError;
use crate::instrument::scene::material::{DEFAULT_ALBEDO, DEFAULT_ALPHA, Material};
use crate::instrument::scene::source::{SceneFiles, existing};
use std::path::{Path, PathBuf};

/// Maps that cause a warning.
const UNREAD: [&str; 9] = [
    "map_Pr", "map_Pm", "map_Ns", "map_d", "map_Bump", "map_bump", "bump", "norm", "disp",
];

/// Largest value of a parameter, far above any real one.
const MAX_VALUE: f32 = 1e30;

/// A material whose map is not read yet.
#[derive(Debug)]
pub struct Source {
    /// Without albedo.
    material: Material,
    kd: Option<[f32; 3]>,
    map: Option<PathBuf>,
}

/// Reads the library at `path`; an unreadable one is empty and causes a warning.
pub fn read(
    files: &dyn SceneFiles,
    path: &Path,
    warnings: &mut Vec<String>,
) -> Result<Vec<Source>, SceneError> {
    let bytes = match files.read(path) {
        Ok(bytes) => bytes,
        Err(error) => {
            let place = path.display();
            warnings.push(format!(
                "{place}: cannot read the materials: {error}; the default material is used"
            ));
            return Ok(Vec::new());
        }
    };
    let statements = Statements::new(&bytes);
    statements.check(path, |keyword, values| match keyword {
        "Kd" => check_numbers(values, 3, MAX_VALUE),
        "Ns" | "Ni" | "Pr" | "Pm" => check_numbers(values, 1, MAX_VALUE),
        _ => Ok(()),
    })?;
    let (found, _) = statements.read(path, |text| tobj::load_mtl_buf(text))?;
    let mut odd = Vec::new();
    let materials = found
        .iter()
        .map(|material| Source::new(material, files, path, &mut odd))
        .collect();
    warnings.extend(
        odd.into_iter()
            .map(|warning| format!("{}: {warning}", path.display())),
    );
    let unread: Vec<&str> = UNREAD
        .into_iter()
        .filter(|keyword| statements.skipped.contains_key(*keyword))
        .collect();
    if !unread.is_empty() {
        warnings.push(format!(
            "{}: {} are not read",
            path.display(),
            unread.join(", ")
        ));
    }
    Ok(materials)
}

impl Source {
    fn new(
        found: &tobj::Material,
        files: &dyn SceneFiles,
        path: &Path,
        warnings: &mut Vec<String>,
    ) -> Self {
        let name = &found.name;
        let mut clamp = |parameter: &str, value: f32, most: f32| {
            let clamped = value.clamp(0.0, most);
            if clamped != value {
                warnings.push(format!(
                    "material \"{name}\": {parameter} {value} is outside its range and is read as \
                     {clamped}"
                ));
            }
            clamped
        };
        let kd = found
            .diffuse
            .map(|rgb| rgb.map(|value| clamp("Kd", value, 1.0)));
        let mut fraction = |parameter: &str| {
            let value = found
                .unknown_param
                .get(parameter)?
                .split_whitespace()
                .next()?;
            Some(clamp(parameter, value.parse().ok()?, 1.0))
        };
        let (roughness, metallic) = (fraction("Pr"), fraction("Pm"));
        let exponent = found.shininess.map(|value| clamp("Ns", value, f32::MAX));
        let alpha = match (roughness, exponent) {
            (Some(roughness), _) => {
                brdf::alpha_from_perceptual_roughness(f64::from(roughness)) as f32
            }
            (None, Some(exponent)) => (2.0 / (exponent + 2.0)).sqrt(),
            (None, None) => DEFAULT_ALPHA,
        };
        let default = Material::default();
        let f0 = found
            .optical_density
            .filter(|ior| *ior > 1.0)
            .map(|ior| brdf::f0_from_ior(f64::from(ior)) as f32);
        let material = Material {
            name: name.clone(),
            metallic: metallic.unwrap_or(default.metallic),
            // Narrower lobes, such as a mirror's (Pr 0), are not shaded.
            alpha: alpha.max(ALPHA_MIN),
            f0: f0.map_or(default.f0, |f0| [f0; 3]),
            ..default
        };
        let map = found.diffuse_texture.as_deref().map(|text| {
            // File names may contain blanks, but not after options.
            let options = text
                .starts_with('-')
                .then(|| text.rsplit_once(char::is_whitespace))
                .flatten();
            if let Some((options, _)) = options {
                warnings.push(format!(
                    "material \"{name}\": the options {options} of map_Kd are not read"
                ));
            }
            existing(files, path, options.map_or(text, |(_, file)| file))
        });
        Self { material, kd, map }
    }

    pub fn name(&self) -> &str {
        &self.material.name
    }

    /// Builds the material; `read_map` returns the index of a texture, `None` for an unreadable
    /// one.
    pub fn material(&self, read_map: impl FnOnce(&Path) -> Option<usize>) -> Material {
        let albedo_map = self.map.as_deref().and_then(read_map);
        let default = if albedo_map.is_some() {
            1.0
        } else {
            DEFAULT_ALBEDO
        };
        Material {
            albedo: self.kd.unwrap_or([default; 3]),
            albedo_map,
            ..self.material.clone()
        }
    }
}
