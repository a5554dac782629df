//! Other tools' tables for `prefiltered` and `dfg` of an experiment, converted to our axes texel by
//! texel.

use super::convention::{Convention, PRESETS, Preset};
use super::source::{Reading, read};
use crate::base::glsl::constants::FILE_PREFIX;
use crate::base::names::Listed;
use crate::base::pixels::RgbImage;
use crate::instrument::environment::layout::LAYOUTS;
use crate::instrument::precompute::given::{CENTRES, Given, GivenMap, GivenTable, OWN};
use crate::instrument::precompute::prefilter::{LEVEL_MAPPINGS, LevelMapping};
use glam::DVec2;
use std::path::Path;
use std::sync::Arc;

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
    let Some((bake, convention)) = opened(value, dir)? else {
        return Ok(None);
    };
    let refuse = |what: String| Err(format!("{value}: {what}"));
    let Some(mut map) = bake.specular else {
        return refuse("it has no prefiltered map".to_owned());
    };
    let layout = &LAYOUTS[0];
    if map.layout != layout {
        return refuse(format!(
            "its layout is {}; expected a cube",
            map.layout.name
        ));
    }
    // The engine reads no further levels.
    map.levels
        .truncate(convention.mapping.engine_levels.unwrap_or(u32::MAX) as usize);
    let count = map.levels.len();
    let side = map.levels[0][0].width;
    if count < 2 {
        return refuse("it has one level; expected 2 or more".to_owned());
    }
    if let Some(k) = (0..count).find(|k| map.levels[*k][0].width != side >> k) {
        return refuse(format!(
            "level {k} is {} wide; expected {}, half of the one before",
            map.levels[k][0].width,
            side >> k
        ));
    }
    let alphas = convention
        .alphas(count)
        .map_err(|fault| format!("{value}: {fault}"))?;
    let holds = |mapping: &&LevelMapping| {
        let own = (0..count).map(|k| mapping.alpha_from_mip(k as f64, count as u32));
        own.zip(&alphas)
            .all(|(own, alpha)| (own - alpha).abs() < ALPHA_WITHIN)
    };
    // Tries the convention's own mapping first: short chains fit several.
    let Some(mapping) = [convention.mapping]
        .into_iter()
        .chain(LEVEL_MAPPINGS)
        .find(holds)
    else {
        return refuse(format!("no level mapping has its widths {alphas:?}"));
    };
    let level = |faces: &Vec<RgbImage>| -> Vec<[f32; 4]> {
        let side = faces[0].width;
        let texel = |index: u32| {
            let at = DVec2::new((index % side).into(), (index / side % side).into()) + 0.5;
            // Orientations of a cube map texel centres to texel centres.
            let world = (layout.direction)(index / (side * side), at / f64::from(side));
            let (face, uv) = (layout.place)(convention.axes.to_file(world));
            let [x, y] = (uv * f64::from(side))
                .to_array()
                .map(|at| (at as u32).min(side - 1));
            let [r, g, b] = faces[face as usize]
                .get(x, y)
                .map(|value| (f64::from(value) * convention.scale) as f32);
            [r, g, b, 1.0]
        };
        (0..6 * side * side).map(texel).collect()
    };
    let levels: Vec<_> = map.levels.iter().map(level).collect();
    let hash = hash(mapping.name, side, levels.iter().flatten());
    Ok(Some(Arc::new(GivenMap {
        name: value.to_owned(),
        hash,
        layout,
        side,
        mapping,
        levels,
    })))
}

/// Loads the DFG table of a value, relative to `dir`; `None` for [`OWN`].
pub fn table(value: &str, dir: &Path) -> Result<Option<Arc<GivenTable>>, String> {
    if value == CENTRES {
        return Ok(None);
    }
    let Some((bake, convention)) = opened(value, dir)? else {
        return Ok(None);
    };
    let Some(image) = bake.dfg else {
        return Err(format!("{value}: it has no DFG table"));
    };
    if image.width != image.height || image.width < 2 {
        return Err(format!(
            "{value}: it is {}x{}; expected a square table",
            image.width, image.height
        ));
    }
    let side = image.width;
    let texel = |index: u32| {
        let at = (DVec2::new((index % side).into(), (index / side).into()) + 0.5) / f64::from(side);
        let [x, y] = (convention.table_axes.uv(at) * f64::from(side))
            .to_array()
            .map(|at| (at as u32).min(side - 1));
        let [a, b, _] = image.get(x, y).map(f64::from);
        let pair = (convention.table_channels.pair)(DVec2::new(a, b)).as_vec2();
        [pair.x, pair.y, 0.0, 1.0]
    };
    let texels: Vec<_> = (0..side * side).map(texel).collect();
    let hash = hash("", side, texels.iter());
    Ok(Some(Arc::new(GivenTable {
        name: value.to_owned(),
        hash,
        side,
        texels,
    })))
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

/// Reads the bake of a value with the preset after `#`, else its own.
fn opened(value: &str, dir: &Path) -> Result<Option<(super::Bake, Convention)>, String> {
    if value == OWN {
        return Ok(None);
    }
    let Some(path) = value.strip_prefix(FILE_PREFIX) else {
        return Err(format!(
            "{value:?} is neither {OWN} nor {FILE_PREFIX}PATH or {FILE_PREFIX}PATH#PRESET"
        ));
    };
    let (path, preset) = path
        .rsplit_once(PRESET)
        .map_or((path, None), |(path, preset)| (path, Some(preset)));
    let bake = read(&[dir.join(path).display().to_string()], Reading::default())
        .map_err(|fault| fault.to_string())?;
    let name = preset
        .or(bake.stated.preset.as_deref())
        .unwrap_or(PRESETS[0].name);
    let found = Preset::parse(name).map_err(|fault| format!("{value}: {fault}"))?;
    let own = found.convention();
    let convention = Convention {
        alphas: bake.stated.alphas.clone().or(own.alphas),
        ..own
    };
    Ok(Some((bake, convention)))
}
