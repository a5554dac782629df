//! Materials of OBJ files.
//!
//! | read | becomes | without it |
//! |---|---|---|
//! | `Kd` (three numbers, or one grey) | albedo | 0.8 grey, white under a `map_Kd` |
//! | `Pm` | metallic | 0 |
//! | `Pr` | alpha = Pr² | from `Ns` |
//! | `Ns` | alpha = sqrt(2 / (Ns + 2)), the width of a Phong lobe of that exponent | 0.25 |
//! | `Ni` above 1 | f0 = ((Ni - 1) / (Ni + 1))² | 0.04 |
//! | `Pc`, `Pcr` | weight of a clear coat, its alpha = Pcr² | 0 |
//! | `Ps` | grey of a sheen of alpha 0.25 | 0 |
//! | `aniso`, `anisor` | strength of the anisotropy, its turn in whole turns | 0 |
//! | `Ke` (three numbers, or one grey) | emission | 0, white under a `map_Ke` |
//! | `map_Kd`, `map_Ke` | colour maps (sRGB); multiply `Kd`, `Ke` | none |
//! | `map_Pr` (green), `map_Pm` (blue) | multiply `Pr`, `Pm`, which are then 1 by default | none |
//! | `norm` | normal map | none |
//! | `map_Ka` (red) | occlusion map, as obj2gltf reads it, unless it is the file of `map_Kd` | none |
//!
//! Blender's writer, which line 1 names, has its own laws: `Ns` is 1000 (1 - roughness)², `Ka` of
//! `illum` 3 and 6 is metallic, `Ks` multiplies f0 by 2 Ks, `Pc` is 4 times the weight of the coat,
//! and `map_Bump` is a normal map of scale `-bm`. A warning says which law was taken.
//!
//! Other writers' `Ks` is ignored, since they rarely write a reflectance there, as are `Ka` and
//! `illum`. `Ni 1` counts as missing: exporters write it when they know no index of refraction.
//! Values outside their range are clamped with a warning; values that are not numbers are refused.
//! Other statements with an effect (`d`, `Tf`, `illum` of glass, coloured `Ks`, other maps) are named
//! in a warning.

use super::map_text::{BUMP_MAPS, MapText};
use super::statements::{Role, Statements, check_color, check_numbers};
use crate::base::glsl::constants::ALPHA_MIN;
use crate::instrument::brdf;
use crate::instrument::scene::SceneError;
use crate::instrument::scene::maps::Meaning;
use crate::instrument::scene::material::{
    Anisotropy, Coat, DEFAULT_ALBEDO, DEFAULT_ALPHA, Emission, Material, Sheen,
};
use crate::instrument::scene::source::{SceneFiles, existing};
use std::collections::{BTreeSet, HashMap};
use std::f32::consts::TAU;
use std::path::{Path, PathBuf};

/// Largest value of a parameter, far above any real one.
const MAX_VALUE: f32 = 1e30;

/// `Ns` of a mirror by Blender.
const BLENDER_NS_MAX: f32 = 1000.0;

/// `Ks` of Blender's materials that reflect as their index of refraction says.
const BLENDER_KS_NEUTRAL: f32 = 0.5;

/// `Pc` by Blender over the weight of the coat.
const BLENDER_PC: f32 = 4.0;

/// `illum` of Blender's metals, opaque and transparent.
const BLENDER_METALS: [f32; 2] = [3.0, 6.0];

/// `illum` of glass.
const GLASS: [f32; 4] = [4.0, 6.0, 7.0, 9.0];

fn role(keyword: &str) -> Role {
    match keyword {
        "Kd" | "Ke" | "Ka" | "Ks" => Role::Numbers(3),
        "Ns" | "Ni" | "Pr" | "Pm" | "Pc" | "Pcr" | "Ps" | "aniso" | "anisor" | "Tr" | "illum" => {
            Role::Numbers(1)
        }
        "newmtl" | "map_Kd" | "map_Ke" | "map_Ka" | "map_Pr" | "map_Pm" | "norm" | "d" | "Tf" => {
            Role::Text
        }
        _ if BUMP_MAPS.contains(&keyword) => Role::Text,
        _ => Role::Unread,
    }
}

/// Whose law a file follows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Writer {
    Blender,
    Other,
}

/// A map of a material.
#[derive(Debug)]
pub struct MapUse {
    pub path: PathBuf,
    /// The kind of map, for messages.
    pub kind: &'static str,
    pub meaning: Meaning,
}

/// A material whose maps are not read yet.
#[derive(Debug)]
pub struct Source {
    name: String,
    writer: Writer,
    /// By keyword; the last statement counts.
    values: HashMap<String, String>,
    parameters: Parameters,
    maps: MapUses,
}

/// The parameters of a material, within their ranges; `None` if the file does not state one.
#[derive(Debug, Default)]
struct Parameters {
    albedo: Option<[f32; 3]>,
    emission: Option<[f32; 3]>,
    /// Perceptual, in [0, 1].
    roughness: Option<f32>,
    metallic: Option<f32>,
    /// `Ns`, at least 0.
    exponent: Option<f32>,
    /// `Ni`, index of refraction.
    ior: Option<f32>,
    coat: Option<f32>,
    coat_roughness: Option<f32>,
    sheen: Option<f32>,
    anisotropy: Option<f32>,
    /// In whole turns.
    anisotropy_turn: Option<f32>,
}

#[derive(Debug, Default)]
struct MapUses {
    albedo: Option<MapUse>,
    emission: Option<MapUse>,
    roughness: Option<MapUse>,
    metallic: Option<MapUse>,
    normal: Option<MapUse>,
    occlusion: Option<MapUse>,
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
    let statements = Statements::new(&bytes, role);
    let writer = if statements.first_comment.contains("Blender") {
        Writer::Blender
    } else {
        Writer::Other
    };
    let mut materials: Vec<Source> = Vec::new();
    statements.check(path, |keyword, values| {
        check_values(keyword, values)?;
        if keyword == "newmtl" {
            materials.push(Source::named(values, writer));
        } else if let Some(material) = materials.last_mut() {
            let values = values.to_owned();
            material.values.insert(keyword.to_owned(), values);
        }
        Ok(())
    })?;
    let mut found = Vec::new();
    for material in &mut materials {
        material.complete(files, path, &mut found);
    }
    found.extend(law(&materials, writer));
    found.extend(unread(&materials, &statements));
    let with_path = |warning: String| format!("{shown_path}: {warning}");
    warnings.extend(found.into_iter().map(with_path));
    Ok(materials)
}

fn check_values(keyword: &str, values: &str) -> Result<(), String> {
    match keyword {
        "newmtl" if values.is_empty() => Err("expected the name of a material".to_owned()),
        "map_Kd" | "map_Ke" | "map_Ka" | "map_Pr" | "map_Pm" | "norm" if values.is_empty() => {
            Err("expected a file".to_owned())
        }
        "Kd" | "Ke" => check_color(values, MAX_VALUE),
        "Ns" | "Ni" | "Pr" | "Pm" | "Pc" | "Pcr" | "Ps" | "aniso" | "anisor" => {
            check_numbers(values, 1, MAX_VALUE)
        }
        _ => Ok(()),
    }
}

/// Returns the warning about the law by which a file's materials are read.
fn law(materials: &[Source], writer: Writer) -> Option<String> {
    let has = |is_used: fn(&Source) -> bool| materials.iter().any(is_used);
    let by_exponent = has(|material| material.exponent().is_some());
    if writer == Writer::Other {
        return by_exponent.then(|| "Ns is read as the exponent of Phong's lobe".to_owned());
    }
    let laws = [
        (by_exponent, "Ns as 1000 (1 - roughness)^2"),
        (
            has(|material| material.ambient_metallic().is_some()),
            "Ka of illum 3 as metallic",
        ),
        (
            has(|material| material.specular_level() != 1.0),
            "Ks as half the factor of f0",
        ),
        (
            has(|material| material.parameters.coat.is_some_and(|coat| coat > 0.0)),
            "Pc as 4 times the weight of the coat",
        ),
        (
            has(|material| material.parameters.anisotropy.is_some_and(|x| x > 0.0)),
            "aniso as a strength for --anisotropy-widths disney",
        ),
    ];
    let taken: Vec<&str> = laws
        .into_iter()
        .filter_map(|(is_taken, law)| is_taken.then_some(law))
        .collect();
    (!taken.is_empty())
        .then(|| format!("written by Blender, read by its laws: {}", taken.join(", ")))
}

/// Returns the warning about statements with an effect that are not read.
fn unread(materials: &[Source], statements: &Statements) -> Option<String> {
    let mut names: BTreeSet<&str> = statements.skipped.keys().map(String::as_str).collect();
    for name in materials.iter().flat_map(Source::unread) {
        names.insert(name);
    }
    let names: Vec<&str> = names.into_iter().collect();
    (!names.is_empty()).then(|| format!("not read: {}", names.join(", ")))
}

impl Source {
    fn named(name: &str, writer: Writer) -> Self {
        Self {
            name: name.to_owned(),
            writer,
            values: HashMap::new(),
            parameters: Parameters::default(),
            maps: MapUses::default(),
        }
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn needs_tangents(&self) -> bool {
        self.maps.normal.is_some() || self.parameters.anisotropy.is_some_and(|x| x > 0.0)
    }

    /// Reads parameters and names of maps from the values.
    fn complete(&mut self, files: &dyn SceneFiles, path: &Path, warnings: &mut Vec<String>) {
        self.parameters = self.clamped(warnings);
        let mut map = |keyword: &str, kind: &'static str, meaning: Meaning| {
            let text = self.values.get(keyword)?;
            let MapText { file, scale } = MapText::parse(text, keyword, &self.name, warnings);
            Some(MapUse {
                path: existing(files, path, file),
                kind,
                meaning: match meaning {
                    Meaning::Normal { .. } => Meaning::Normal { scale },
                    other => other,
                },
            })
        };
        let normals = Meaning::Normal { scale: 1.0 };
        let bump_map = BUMP_MAPS
            .into_iter()
            .filter(|_| self.writer == Writer::Blender)
            .find_map(|keyword| map(keyword, "normal map", normals));
        let occlusion = self.has_occlusion().then(|| {
            map(
                "map_Ka",
                "occlusion map",
                Meaning::Occlusion { strength: 1.0 },
            )
        });
        self.maps = MapUses {
            albedo: map("map_Kd", "albedo map", Meaning::Color),
            emission: map("map_Ke", "map of emission", Meaning::Color),
            roughness: map("map_Pr", "roughness map", Meaning::Linear),
            metallic: map("map_Pm", "metallic map", Meaning::Linear),
            normal: map("norm", "normal map", normals).or(bump_map),
            occlusion: occlusion.flatten(),
        };
    }

    /// Whether another definition has the same values.
    pub fn is_like(&self, other: &Self) -> bool {
        self.values == other.values
    }

    /// Whether `map_Ka` is an occlusion map. Some writers repeat the albedo map there.
    fn has_occlusion(&self) -> bool {
        let map = self.values.get("map_Ka");
        map.is_some() && map != self.values.get("map_Kd")
    }

    fn number(&self, keyword: &str) -> Option<f32> {
        self.numbers(keyword).first().copied()
    }

    fn numbers(&self, keyword: &str) -> Vec<f32> {
        let words = self.values.get(keyword).map_or("", String::as_str);
        words
            .split_whitespace()
            .map_while(|word| word.parse().ok())
            .collect()
    }

    fn triple(&self, keyword: &str) -> Option<[f32; 3]> {
        match self.numbers(keyword)[..] {
            [grey] => Some([grey; 3]),
            [red, green, blue] => Some([red, green, blue]),
            _ => None,
        }
    }

    /// Clamps each parameter to its range, with a warning.
    fn clamped(&self, warnings: &mut Vec<String>) -> Parameters {
        let mut clamp = |keyword: &str, value: f32, most: f32| {
            let clamped = value.clamp(0.0, most);
            if clamped != value {
                warnings.push(format!(
                    "material \"{}\": {keyword} {value} is outside its range and is read as \
                     {clamped}",
                    self.name
                ));
            }
            clamped
        };
        let mut number = |keyword: &str, most: f32| {
            self.number(keyword)
                .map(|value| clamp(keyword, value, most))
        };
        let coat_max = match self.writer {
            Writer::Blender => BLENDER_PC,
            Writer::Other => 1.0,
        };
        Parameters {
            roughness: number("Pr", 1.0),
            metallic: number("Pm", 1.0),
            exponent: number("Ns", f32::MAX),
            ior: self.number("Ni"),
            coat: number("Pc", coat_max).map(|weight| weight / coat_max),
            coat_roughness: number("Pcr", 1.0),
            sheen: number("Ps", 1.0),
            anisotropy: number("aniso", 1.0),
            anisotropy_turn: self.number("anisor"),
            albedo: self
                .triple("Kd")
                .map(|rgb| rgb.map(|value| clamp("Kd", value, 1.0))),
            emission: self
                .triple("Ke")
                .map(|rgb| rgb.map(|value| clamp("Ke", value, f32::MAX))),
        }
    }

    /// Builds the material; `read_map` returns the index of a texture, `None` for an unreadable
    /// one.
    pub fn material(&self, mut read_map: impl FnMut(&MapUse) -> Option<usize>) -> Material {
        let mut map = |map: &Option<MapUse>| map.as_ref().and_then(&mut read_map);
        let default = Material::default();
        let parameters = &self.parameters;
        let albedo_map = map(&self.maps.albedo);
        let emission_map = map(&self.maps.emission);
        let roughness_map = map(&self.maps.roughness);
        let metallic_map = map(&self.maps.metallic);
        let if_mapped = |map: Option<usize>, mapped: f32, plain: f32| {
            if map.is_some() { mapped } else { plain }
        };
        let metallic = parameters.metallic.or_else(|| self.ambient_metallic());
        let turns = parameters.anisotropy_turn.unwrap_or(0.0);
        Material {
            name: self.name.clone(),
            albedo: parameters
                .albedo
                .unwrap_or([if_mapped(albedo_map, 1.0, DEFAULT_ALBEDO); 3]),
            albedo_map,
            metallic: metallic.unwrap_or(if_mapped(metallic_map, 1.0, default.metallic)),
            metallic_map,
            alpha: self
                .alpha()
                .unwrap_or(if_mapped(roughness_map, 1.0, DEFAULT_ALPHA)),
            roughness_map,
            f0: self.f0(default.f0[0]),
            normal_map: map(&self.maps.normal),
            occlusion_map: map(&self.maps.occlusion),
            anisotropy: Anisotropy {
                strength: parameters.anisotropy.unwrap_or(0.0),
                turn: TAU * turns,
                ..default.anisotropy
            },
            coat: Coat {
                weight: parameters.coat.unwrap_or(0.0),
                alpha: alpha_of(parameters.coat_roughness.unwrap_or(0.0)),
                ..default.coat
            },
            sheen: Sheen {
                color: [parameters.sheen.unwrap_or(0.0); 3],
                ..default.sheen
            },
            emission: Emission {
                color: parameters
                    .emission
                    .unwrap_or([if_mapped(emission_map, 1.0, 0.0); 3]),
                map: emission_map,
            },
            ..default
        }
    }

    /// Returns `Ns`, if alpha comes from it.
    fn exponent(&self) -> Option<f32> {
        let is_rough = self.parameters.roughness.is_some() || self.maps.roughness.is_some();
        self.parameters.exponent.filter(|_| !is_rough)
    }

    /// Returns the microfacet width, if the file states one.
    fn alpha(&self) -> Option<f32> {
        if let Some(roughness) = self.parameters.roughness {
            return Some(alpha_of(roughness));
        }
        self.exponent().map(|exponent| match self.writer {
            Writer::Blender => alpha_of(1.0 - (exponent / BLENDER_NS_MAX).min(1.0).sqrt()),
            Writer::Other => (2.0 / (exponent + 2.0)).sqrt().max(ALPHA_MIN),
        })
    }

    /// Returns the metallic that Blender writes as `Ka`, if any.
    fn ambient_metallic(&self) -> Option<f32> {
        let is_metal = self.writer == Writer::Blender
            && self.parameters.metallic.is_none()
            && BLENDER_METALS.contains(&self.number("illum")?);
        let [red, green, blue] = self.triple("Ka").filter(|_| is_metal)?;
        Some(((red + green + blue) / 3.0).clamp(0.0, 1.0))
    }

    /// Returns the factor of f0 that Blender writes as `Ks`; 1 without one.
    fn specular_level(&self) -> f32 {
        let level = self.number("Ks").unwrap_or(BLENDER_KS_NEUTRAL);
        match self.writer {
            Writer::Blender => (level / BLENDER_KS_NEUTRAL).max(0.0),
            Writer::Other => 1.0,
        }
    }

    fn f0(&self, default: f32) -> [f32; 3] {
        let f0 = self
            .parameters
            .ior
            .filter(|ior| *ior > 1.0)
            .map_or(default, |ior| brdf::f0_from_ior(f64::from(ior)) as f32);
        [(self.specular_level() * f0).min(1.0); 3]
    }

    /// Whether `d` or `Tf` lets light through: a number below 1, behind words such as `-halo` and
    /// `xyz`, or a spectrum in a file.
    fn is_clear_by(&self, keyword: &str) -> bool {
        let Some(values) = self.values.get(keyword) else {
            return false;
        };
        let is_below_one = |word: &str| word.parse().is_ok_and(|x: f32| x < 1.0);
        values
            .split_whitespace()
            .take_while(|word| *word != "#")
            .any(|word| word == "spectral" || is_below_one(word))
    }

    /// Names statements with an effect that are not shaded.
    fn unread(&self) -> Vec<&'static str> {
        let mut unread = Vec::new();
        unread.extend(self.is_clear_by("d").then_some("d"));
        unread.extend(self.is_clear_by("Tf").then_some("Tf"));
        let is_clear = self.number("Tr").is_some_and(|x| x > 0.0);
        unread.extend(is_clear.then_some("Tr"));
        let is_repeated = self.values.contains_key("map_Ka") && !self.has_occlusion();
        unread.extend(is_repeated.then_some("map_Ka"));
        if self.writer == Writer::Other {
            let is_glass = |illum: f32| GLASS.contains(&illum);
            unread.extend(
                self.number("illum")
                    .is_some_and(is_glass)
                    .then_some("illum"),
            );
            let is_colored = |[red, green, blue]: [f32; 3]| red != green || green != blue;
            unread.extend(self.triple("Ks").is_some_and(is_colored).then_some("Ks"));
            let is_present = |keyword: &&str| self.values.contains_key(*keyword);
            unread.extend(BUMP_MAPS.into_iter().filter(is_present));
        }
        unread
    }
}

/// Returns alpha of a perceptual roughness; narrower lobes, such as a mirror's, are not shaded.
fn alpha_of(roughness: f32) -> f32 {
    (brdf::alpha_from_perceptual_roughness(f64::from(roughness)) as f32).max(ALPHA_MIN)
}
