//! Bakes tables for an engine: exact levels by its preset, written, read back and compared.
//! `examples/judge_bake.rs` does it.

mod exact_maps;
mod making;
mod table;
mod write;
mod written;

pub use super::judge::GOOD;
pub use making::{IRRADIANCE_SIDE, Making, TABLE_SIDE};
pub use table::dfg;
pub use written::{CutLoss, Loss, Written};

pub(super) use write::write_bytes;

use super::convention::Convention;
use super::f3d_cache;
use super::judge::exact::between_texels;
use super::map_form::MapForm;
use super::parts::Map;
use super::paste;
use super::product::LAST_SIDE;
use super::source::{MANIFEST, Reading, read};
use crate::base::pixels::{Fault, PixelsError, RgbImage};
use exact_maps::ExactMaps;
use std::path::{Path, PathBuf};
use write::Writer;

/// Why lookups between the texels of the last level err much, if few texels are the reason.
#[derive(Clone, Debug)]
pub struct LastBetween {
    /// relMSE between the texels of the last prefiltered level that the engine reads.
    pub relmse: f64,
    /// How to lower it, if it is above [`GOOD`].
    pub advice: Option<String>,
}

/// The files of a bake, and how exact they are.
#[derive(Clone, Debug)]
pub struct Baked {
    /// Every file, `bake.json` last.
    pub files: Vec<PathBuf>,
    pub levels: Vec<Written>,
    pub last_between: LastBetween,
    /// Largest error of the table in its first file.
    pub table_error: Option<f64>,
}

/// Bakes into the folder `out`, `bake.json` last, then reads everything back and compares it.
///
/// Fails if a file exists or cannot be written. [`Making::check`] reports settings that the
/// engine's format cannot hold.
pub fn make(making: &Making, out: &Path) -> Result<Baked, PixelsError> {
    let product = making.preset.product();
    let convention = making.preset.convention();
    let (code_name, code) = paste::file(product.language);
    refuse_existing(making, &code_name, out)?;
    std::fs::create_dir_all(out).map_err(|error| {
        Fault::new(format!("cannot be created ({error})"), "a folder").in_file(out)
    })?;

    let exact = ExactMaps::new(making, &convention);
    let mut writer = Writer::new(making, &convention, &exact, out);
    writer.maps(&exact, &convention)?;
    let table = (!product.tables.is_empty()).then(|| {
        dfg(
            making.brdf,
            making.masking,
            convention.table_axes,
            making.table_side,
        )
    });
    if let Some(table) = &table {
        writer.tables(table)?;
    }
    writer.sh(&exact)?;
    writer.taps(&convention, &code_name, &code)?;
    writer.manifest()?;

    let reading = Reading {
        layout: None,
        brdf: making.brdf.name(),
        byte_color: convention.byte_color,
    };
    let bake = read(&[out.display().to_string()], reading)?;
    let specular = bake.specular.as_ref().expect("it was written");
    Ok(Baked {
        files: writer.files,
        levels: exact.compared(making, &bake),
        last_between: last_between(making, &exact, &convention, specular),
        table_error: table
            .as_ref()
            .zip(bake.dfg.as_ref())
            .map(|(made, found)| table_error(made, found)),
    })
}

fn refuse_existing(making: &Making, code_name: &str, out: &Path) -> Result<(), PixelsError> {
    let product = making.preset.product();
    let names = [
        Some(product.specular),
        product.irradiance,
        product.skybox,
        product.sh,
        Some(paste::TAPS),
        Some(code_name),
        Some(MANIFEST),
    ];
    let names = names
        .into_iter()
        .flatten()
        .chain(product.tables.iter().copied());
    let images = match making.form() {
        MapForm::F3dCache => Some(f3d_cache::folder_of(product.specular)),
        _ => None,
    };
    match names.chain(images).find(|name| out.join(name).exists()) {
        Some(name) => {
            Err(Fault::new("exists", "a new or an empty folder").in_file(&out.join(name)))
        }
        None => Ok(()),
    }
}

/// Returns the largest difference of A or B.
fn table_error(made: &RgbImage, found: &RgbImage) -> f64 {
    made.data
        .iter()
        .zip(&found.data)
        .flat_map(|(a, b)| (0..2).map(|i| f64::from((a[i] - b[i]).abs())))
        .fold(0.0, f64::max)
}

/// Scores the last level that the engine reads at four points per texel.
fn last_between(
    making: &Making,
    exact: &ExactMaps,
    convention: &Convention,
    map: &Map,
) -> LastBetween {
    let count = map.levels.len();
    let faces = &map.levels[count.min(convention.mapping_levels(count) as usize) - 1];
    let alpha = exact.alphas[exact.alphas.len() - 1];
    let exact_map = exact.truth.prefiltered(alpha);
    let relmse = between_texels(&exact.truth, map.layout, faces, convention, &exact_map);
    let has_choice = making.form().has_taps();
    let is_too_small = has_choice && relmse > GOOD && faces[0].width < LAST_SIDE;
    let product = making.preset.product();
    LastBetween {
        relmse,
        advice: is_too_small.then(|| match product.level_count {
            Some(count) => format!(
                "{} needs {count} levels; use faces of {} for {LAST_SIDE} texels",
                product.engine,
                LAST_SIDE << (count - 1)
            ),
            None => "use fewer levels or larger faces".to_owned(),
        }),
    }
}
