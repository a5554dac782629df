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
    name: String,
    parameters: Parameters,
    albedo_map: Option<PathBuf>,
}

/// The parameters of a material, within their ranges.
#[derive(Debug)]
struct Parameters {
    /// `Kd`, linear RGB in [0, 1].
    albedo: Option<[f32; 3]>,
    /// `Pr`, perceptual, in [0, 1].
    roughness: Option<f32>,
    /// `Pm`, in [0, 1].
    metallic: Option<f32>,
    /// `Ns`, of Phong's lobe, at least 0.
    exponent: Option<f32>,
    /// `Ni`, index of refraction.
    ior: Option<f32>,
}

/// Reads the library at `path`; an unreadable one is empty and causes a warning.
pub fn read(
    files: &dyn SceneFiles,
    path: &Path,
    warnings: &mut Vec<String>,
) -> Result<Vec<Source>, SceneError> {
    let shown_path = path.display();
    let bytes = match files.read(path) {
        Ok(bytes) => bytes,
        Err(error) => {
            warnings.push(format!(
                "{shown_path}: cannot read the materials: {error}; the default material is used"
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
    let mut material_warnings = Vec::new();
    let materials = found
        .iter()
        .map(|material| Source::new(material, files, path, &mut material_warnings))
        .collect();
    warnings.extend(
        material_warnings
            .into_iter()
            .map(|warning| format!("{shown_path}: {warning}")),
    );
    let unread: Vec<&str> = UNREAD
        .into_iter()
        .filter(|keyword| statements.skipped.contains_key(*keyword))
        .collect();
    if !unread.is_empty() {
        warnings.push(format!("{shown_path}: {} are not read", unread.join(", ")));
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
        Self {
            name: found.name.clone(),
            parameters: Parameters::new(found, warnings),
            albedo_map: found
                .diffuse_texture
                .as_deref()
                .map(|text| existing(files, path, map_file(text, &found.name, warnings))),
        }
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    /// Builds the material; `read_map` returns the index of a texture, `None` for an unreadable
    /// one.
    pub fn material(&self, read_map: impl FnOnce(&Path) -> Option<usize>) -> Material {
        let albedo_map = self.albedo_map.as_deref().and_then(read_map);
        let default_albedo = if albedo_map.is_some() {
            1.0
        } else {
            DEFAULT_ALBEDO
        };
        let default = Material::default();
        let parameters = &self.parameters;
        Material {
            name: self.name.clone(),
            albedo: parameters.albedo.unwrap_or([default_albedo; 3]),
            albedo_map,
            metallic: parameters.metallic.unwrap_or(default.metallic),
            alpha: parameters.alpha(),
            f0: parameters.f0().map_or(default.f0, |f0| [f0; 3]),
            ..default
        }
    }
}

impl Parameters {
    /// Clamps each parameter to its range, with a warning.
    fn new(found: &tobj::Material, warnings: &mut Vec<String>) -> Self {
        let mut clamp = |parameter: &str, value: f32, most: f32| {
            let clamped = value.clamp(0.0, most);
            if clamped != value {
                warnings.push(format!(
                    "material \"{}\": {parameter} {value} is outside its range and is read as \
                     {clamped}",
                    found.name
                ));
            }
            clamped
        };
        let albedo = found
            .diffuse
            .map(|rgb| rgb.map(|value| clamp("Kd", value, 1.0)));
        let roughness = first_number(found, "Pr").map(|value| clamp("Pr", value, 1.0));
        let metallic = first_number(found, "Pm").map(|value| clamp("Pm", value, 1.0));
        let exponent = found.shininess.map(|value| clamp("Ns", value, f32::MAX));
        Self {
            albedo,
            roughness,
            metallic,
            exponent,
            ior: found.optical_density,
        }
    }

    /// Returns the microfacet width.
    fn alpha(&self) -> f32 {
        let alpha = match (self.roughness, self.exponent) {
            (Some(roughness), _) => {
                brdf::alpha_from_perceptual_roughness(f64::from(roughness)) as f32
            }
            (None, Some(exponent)) => (2.0 / (exponent + 2.0)).sqrt(),
            (None, None) => DEFAULT_ALPHA,
        };
        // Narrower lobes, such as a mirror's (Pr 0), are not shaded.
        alpha.max(ALPHA_MIN)
    }

    /// Returns the dielectric F0, if the file states one.
    fn f0(&self) -> Option<f32> {
        self.ior
            .filter(|ior| *ior > 1.0)
            .map(|ior| brdf::f0_from_ior(f64::from(ior)) as f32)
    }
}

/// Returns the first value of a parameter that the crate `tobj` does not know.
fn first_number(found: &tobj::Material, parameter: &str) -> Option<f32> {
    let values = found.unknown_param.get(parameter)?;
    values.split_whitespace().next()?.parse().ok()
}

/// Returns the file of a `map_Kd`; warns about options, which are not read.
fn map_file<'t>(text: &'t str, material: &str, warnings: &mut Vec<String>) -> &'t str {
    // File names may contain blanks, but not after options.
    if !text.starts_with('-') {
        return text;
    }
    let Some((options, file)) = text.rsplit_once(char::is_whitespace) else {
        return text;
    };
    warnings.push(format!(
        "material \"{material}\": the options {options} of map_Kd are not read"
    ));
    file
}
