//! Other tools' tables for `prefiltered` and `dfg` of an experiment, converted to our axes texel by
//! texel.

use super::convention::{Convention, PRESETS, Preset};
use super::parts::{Bake, Map};
use super::source::{Reading, read};
use crate::base::glsl::constants::FILE_PREFIX;
use crate::base::pixels::RgbImage;
use crate::instrument::environment::layout::LAYOUTS;
use crate::instrument::precompute::given::{CENTRES, Given, GivenMap, GivenTable, OWN};
use crate::instrument::precompute::prefilter::{LEVEL_MAPPINGS, LevelMapping};
use glam::DVec2;
use std::path::Path;
use std::sync::Arc;

/// Separates the path of a value from its preset.
const PRESET: char = '#';
/// Largest difference of a width from its mapping's.
const ALPHA_WITHIN: f64 = 1e-4;

/// Loads the tables of two values, relative to `dir`.
pub fn load(prefiltered: &str, dfg: &str, dir: &Path) -> Result<Given, String> {
    Ok(Given {
        prefiltered: map(prefiltered, dir)?,
        dfg: table(dfg, dir)?,
    })
}

/// Loads the map of a value, relative to `dir`; `None` for [`OWN`].
pub fn map(value: &str, dir: &Path) -> Result<Option<Arc<GivenMap>>, String> {
    let Some(opened) = Opened::new(value, dir)? else {
        return Ok(None);
    };
    let map = opened.map().map_err(|fault| format!("{value}: {fault}"))?;
    Ok(Some(Arc::new(map)))
}

/// Loads the DFG table of a value, relative to `dir`; `None` for [`OWN`].
pub fn table(value: &str, dir: &Path) -> Result<Option<Arc<GivenTable>>, String> {
    if value == CENTRES {
        return Ok(None);
    }
    let Some(opened) = Opened::new(value, dir)? else {
        return Ok(None);
    };
    let table = opened
        .table()
        .map_err(|fault| format!("{value}: {fault}"))?;
    Ok(Some(Arc::new(table)))
}

/// The bake of a value, and its conventions.
struct Opened<'v> {
    value: &'v str,
    bake: Bake,
    convention: Convention,
}

impl<'v> Opened<'v> {
    /// Reads the bake of a value with the preset after `#`, else with the stated one; `None` for
    /// [`OWN`].
    fn new(value: &'v str, dir: &Path) -> Result<Option<Self>, String> {
        if value == OWN {
            return Ok(None);
        }
        let Some(path) = value.strip_prefix(FILE_PREFIX) else {
            return Err(format!(
                "{value:?} is neither {OWN} nor {FILE_PREFIX}PATH or {FILE_PREFIX}PATH#PRESET"
            ));
        };
        let (path, preset) = match path.rsplit_once(PRESET) {
            Some((path, preset)) => (path, Some(preset)),
            None => (path, None),
        };
        let open =
            |name: &str| Preset::open(name, dir).map_err(|fault| format!("{value}: {fault}"));
        let named = preset.map(open).transpose()?;
        let reading = Reading {
            byte_color: named.and_then(|preset| preset.convention().byte_color),
            ..Reading::default()
        };
        let bake = read(&[dir.join(path).display().to_string()], reading)
            .map_err(|fault| fault.to_string())?;
        let preset = match (named, &bake.stated.preset) {
            (Some(preset), _) => preset,
            (None, Some(stated)) => open(stated)?,
            (None, None) => &PRESETS[0],
        };
        let mut convention = preset.convention();
        convention.alphas = bake.stated.alphas.clone().or(convention.alphas);
        Ok(Some(Self {
            value,
            bake,
            convention,
        }))
    }

    /// Converts the prefiltered map.
    fn map(self) -> Result<GivenMap, String> {
        let Some(mut map) = self.bake.specular else {
            return Err("it has no prefiltered map".to_owned());
        };
        let layout = &LAYOUTS[0];
        if map.layout != layout {
            return Err(format!(
                "its layout is {}; expected a cube",
                map.layout.name
            ));
        }
        let convention = &self.convention;
        // The engine reads no further levels.
        let level_count_max = convention.mapping.engine_levels.unwrap_or(u32::MAX);
        map.levels.truncate(level_count_max as usize);
        check_sizes(&map)?;
        let mapping = level_mapping(convention, map.levels.len())?;
        let side = map.levels[0][0].width;
        let levels: Vec<Vec<[f32; 4]>> = map
            .levels
            .iter()
            .map(|faces| converted(faces, convention))
            .collect();
        Ok(GivenMap {
            name: self.value.to_owned(),
            hash: hash(mapping.name, side, levels.iter().flatten()),
            layout,
            side,
            mapping,
            levels,
        })
    }

    /// Converts the DFG table.
    fn table(self) -> Result<GivenTable, String> {
        let Some(image) = self.bake.dfg else {
            return Err("it has no DFG table".to_owned());
        };
        let RgbImage { width, height, .. } = image;
        if width != height || width < 2 {
            return Err(format!("it is {width}x{height}; expected a square table"));
        }
        let side = width;
        let texel = |index: u32| {
            let centre = DVec2::new((index % side).into(), (index / side).into()) + 0.5;
            let uv = self.convention.table_axes.uv(centre / f64::from(side));
            let [x, y] = pixel(uv, side);
            let [a, b, _] = image.get(x, y).map(f64::from);
            let pair = (self.convention.table_channels.pair)(DVec2::new(a, b)).as_vec2();
            [pair.x, pair.y, 0.0, 1.0]
        };
        let texels: Vec<[f32; 4]> = (0..side * side).map(texel).collect();
        Ok(GivenTable {
            name: self.value.to_owned(),
            hash: hash("", side, texels.iter()),
            side,
            texels,
        })
    }
}

/// Refuses a map without levels that halve.
fn check_sizes(map: &Map) -> Result<(), String> {
    let side = map.levels[0][0].width;
    let count = map.levels.len();
    if count < 2 {
        return Err("it has one level; expected 2 or more".to_owned());
    }
    for (k, faces) in map.levels.iter().enumerate() {
        let width = faces[0].width;
        if width != side >> k {
            return Err(format!(
                "level {k} is {width} wide; expected {}, half of the one before",
                side >> k
            ));
        }
    }
    Ok(())
}

/// Finds the mapping with the widths of the convention.
fn level_mapping(convention: &Convention, count: usize) -> Result<&'static LevelMapping, String> {
    let alphas = convention.alphas(count)?;
    let has_widths = |mapping: &&LevelMapping| {
        alphas.iter().enumerate().all(|(k, alpha)| {
            let mapped = mapping.alpha_from_mip(k as f64, count as u32);
            (mapped - alpha).abs() < ALPHA_WITHIN
        })
    };
    // Tries the convention's mapping first: short chains fit several.
    [convention.mapping]
        .into_iter()
        .chain(LEVEL_MAPPINGS)
        .find(has_widths)
        .ok_or_else(|| format!("no level mapping has its widths {alphas:?}"))
}

/// Turns and scales the faces of a level.
fn converted(faces: &[RgbImage], convention: &Convention) -> Vec<[f32; 4]> {
    let layout = &LAYOUTS[0];
    let side = faces[0].width;
    let texel = |index: u32| {
        let centre = DVec2::new((index % side).into(), (index / side % side).into()) + 0.5;
        // Orientations of a cube map texel centres to texel centres.
        let world = (layout.direction)(index / (side * side), centre / f64::from(side));
        let (face, uv) = (layout.face_uv)(convention.axes.to_file(world));
        let [x, y] = pixel(uv, side);
        let [r, g, b] = faces[face as usize]
            .get(x, y)
            .map(|value| (f64::from(value) * convention.scale) as f32);
        [r, g, b, 1.0]
    };
    (0..6 * side * side).map(texel).collect()
}

/// Returns the pixel at texture coordinates of a square image.
fn pixel(uv: DVec2, side: u32) -> [u32; 2] {
    (uv * f64::from(side))
        .to_array()
        .map(|texels| (texels as u32).min(side - 1))
}

fn hash<'t>(mapping: &str, side: u32, texels: impl Iterator<Item = &'t [f32; 4]>) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher
        .update(mapping.as_bytes())
        .update(&side.to_le_bytes());
    for texel in texels {
        hasher.update(bytemuck::cast_slice(texel));
    }
    hasher.finalize().to_hex().to_string()
}
