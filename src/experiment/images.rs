//! The images of a run: linear EXR, tone-mapped PNG, error maps, and contact sheets made of them.

use super::axis::{AXES, Axis, Point};
use super::plan::{Cell, Plan};
use super::store::{Store, StoreError};
use super::tables::{CellResult, HEADLINE, Results, Rows};
use crate::metrics::Comparison;
use crate::pipeline::Frame;
use crate::pixels::{GrayImage, PixelsError, Rgb8Image, exr, png};
use crate::table::colormap::RELATIVE_ERROR;
use crate::table::contact_sheet::{ContactSheet, Legend, Tile};
use crate::table::csv::Cell as Field;
use crate::table::markdown::significant;
use std::path::Path;

/// The layer of a reference that holds its standard error.
pub const STANDARD_ERROR_LAYER: &str = "standard_error";
/// File names stop here; the id after it keeps them apart.
const SLUG_LENGTH: usize = 120;
/// Smallest side of a tile in a contact sheet, pixels.
const TILE_SIDE_MIN: u32 = 128;

/// A value as people say it: builtins without their prefix, files without folder and extension.
pub fn short_text(axis: &Axis, point: &Point) -> String {
    let text = point.get(axis.name).to_string();
    if !matches!(axis.kind, super::value::Kind::Input) {
        return text;
    }
    match text.strip_prefix("builtin:") {
        Some(formula) => formula.to_owned(),
        None => Path::new(&text).file_stem().map_or_else(|| text.clone(), |stem| stem.to_string_lossy().into_owned()),
    }
}

/// The swept values of a point as part of a file name.
fn slug(plan: &Plan, point: &Point, with_display: bool) -> String {
    let axes = plan.swept().filter(|axis| axis.changes_radiance || with_display);
    let words: Vec<String> = axes.map(|axis| short_text(axis, point)).filter(|word| !word.is_empty()).collect();
    let word = if words.is_empty() { plan.config.name.clone() } else { words.join("_") };
    word.chars()
        .map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' })
        .take(SLUG_LENGTH)
        .collect()
}

/// File name of the linear image of a point.
pub fn radiance_name(plan: &Plan, point: &Point, id: &str) -> String {
    format!("{}.{id}.exr", slug(plan, point, false))
}

fn picture_name(plan: &Plan, cell: &Cell) -> String {
    format!("{}.{}.png", slug(plan, &cell.point, true), cell.id)
}

fn error_name(plan: &Plan, cell: &Cell) -> String {
    format!("{}.{}.error.png", slug(plan, &cell.point, true), cell.id)
}

fn reference_picture_name(plan: &Plan, cell: &Cell) -> String {
    let point = cell.point.reference(&plan.config.reference);
    let display = AXES.iter().filter(|axis| !axis.changes_radiance);
    let display: Vec<String> = display.map(|axis| format!("{}{}", axis.name, point.get(axis.name))).collect();
    format!("{}.{}.{}.png", slug(plan, &point, false), display.join("-"), cell.reference)
}

/// Writes linear RGBA (A is the mask) and, for a reference, its standard error as a layer.
pub fn write_radiance(path: &Path, frame: &Frame) -> Result<(), PixelsError> {
    let layers: Vec<_> = frame.standard_error.iter().map(|image| (STANDARD_ERROR_LAYER, image)).collect();
    exr::write_rgba(path, &frame.radiance, &frame.mask, &layers)
}

/// Relative error in fixed colours.
pub fn error_picture(comparison: &Comparison, mask: &GrayImage) -> Rgb8Image {
    RELATIVE_ERROR.image(&comparison.relative_error_map(), mask)
}

/// The display images of one cell.
pub struct CellPictures<'a> {
    pub test: &'a Rgb8Image,
    pub reference: &'a Rgb8Image,
    pub error: &'a Rgb8Image,
}

impl CellPictures<'_> {
    /// Writes them; the reference's picture is shared by cells and written once.
    pub fn write(&self, store: &Store, plan: &Plan, cell: &Cell) -> Result<(), PixelsError> {
        png::write_rgb8(&store.image_path(&picture_name(plan, cell)), self.test)?;
        png::write_rgb8(&store.image_path(&error_name(plan, cell)), self.error)?;
        let reference = store.image_path(&reference_picture_name(plan, cell));
        if reference.exists() { Ok(()) } else { png::write_rgb8(&reference, self.reference) }
    }
}

/// `images.csv`: which files of `images/` belong to a cell. One row a finished cell.
pub fn index(plan: &Plan, results: &Results) -> Rows {
    let columns = ["cell", "radiance", "reference", "picture", "reference_picture", "error"].map(str::to_owned).to_vec();
    let is_done = |cell: &&Cell| matches!(results.get(&cell.id), Some(CellResult::Done(_)));
    let row = |cell: &Cell| {
        let reference = cell.point.reference(&plan.config.reference);
        let names = [
            radiance_name(plan, &cell.point, &cell.radiance),
            radiance_name(plan, &reference, &cell.reference),
            picture_name(plan, cell),
            reference_picture_name(plan, cell),
            error_name(plan, cell),
        ];
        std::iter::once(Field::from(cell.id.as_str())).chain(names.map(Field::Text)).collect()
    };
    (columns, plan.cells.iter().filter(is_done).map(row).collect())
}

/// Axes that make one sheet each.
const SHEET_AXES: &[&str] = &["environment", "scene", "brdf"];
/// Axes that make columns.
const COLUMN_AXES: &[&str] = &["method", "diffuse", "samples"];

/// One contact sheet for each environment, scene and model: columns are the reference and the methods, rows the rest.
pub fn write_sheets(store: &Store, plan: &Plan, results: &Results) -> Result<(), StoreError> {
    let swept: Vec<&Axis> = plan.swept().collect();
    let select = |names: &[&str]| swept.iter().copied().filter(|a| names.contains(&a.name)).collect::<Vec<_>>();
    let (sheet_axes, column_axes) = (select(SHEET_AXES), select(COLUMN_AXES));
    let is_row = |a: &&Axis| !SHEET_AXES.contains(&a.name) && !COLUMN_AXES.contains(&a.name);
    let row_axes: Vec<&Axis> = swept.iter().copied().filter(is_row).collect();
    let scale = TILE_SIDE_MIN.div_ceil(plan.config.size[0].max(1)).max(1);
    for cells in grouped(&plan.cells.iter().collect::<Vec<_>>(), &sheet_axes) {
        let columns = grouped(&cells, &column_axes);
        let mut sheet = ContactSheet {
            title: format!("{} {}", plan.config.name, words(&sheet_axes, cells[0], " ")).trim_end().to_owned(),
            caption: format!(
                "{} Below each image: its {HEADLINE}; below it, relative error against the reference.",
                plan.config.question
            ),
            column_labels: vec!["reference".to_owned()],
            row_labels: Vec::new(),
            rows: Vec::new(),
            column_group_starts: vec![1],
            row_group_starts: Vec::new(),
            scale,
            legends: vec![Legend { label: "relative error".to_owned(), scale: RELATIVE_ERROR }],
        };
        for (index, column) in columns.iter().enumerate() {
            let label = words(&column_axes, column[0], " ");
            sheet.column_labels.push(if label.is_empty() { method_label(column[0]) } else { label });
            if index > 0 && column[0].point.get("method") != columns[index - 1][0].point.get("method") {
                sheet.column_group_starts.push(index + 1);
            }
        }
        for row in grouped(&cells, &row_axes) {
            sheet.row_group_starts.push(sheet.rows.len());
            let label = row_axes.iter().map(|axis| format!("{} {}", axis.name, short_text(axis, &row[0].point)));
            sheet.row_labels.push(label.collect::<Vec<_>>().join("\n"));
            sheet.row_labels.push("error".to_owned());
            let (mut images, mut errors) = reference_tiles(store, plan, results, &row);
            for column in &columns {
                let cell = row.iter().find(|cell| same(cell, column[0], &column_axes));
                let (image, error) = cell_tiles(store, plan, results, cell.copied());
                images.push(image);
                errors.push(error);
            }
            sheet.rows.extend([images, errors]);
        }
        let name = words(&sheet_axes, cells[0], "_").replace('/', "-");
        let name = if name.is_empty() { plan.config.name.clone() } else { name };
        let picture = sheet.render().expect("every row of a sheet has one tile a column, all of the experiment's size");
        png::write_rgb8(&store.table_path(&format!("{name}.png")), &picture)?;
    }
    Ok(())
}

fn reference_tiles(store: &Store, plan: &Plan, results: &Results, row: &[&Cell]) -> (Vec<Tile>, Vec<Tile>) {
    let done = row.iter().find_map(|cell| match results.get(&cell.id) {
        Some(CellResult::Done(record)) => Some((*cell, record)),
        _ => None,
    });
    let Some((cell, record)) = done else {
        return (vec![Tile::Missing("not done".to_owned())], vec![Tile::Missing(String::new())]);
    };
    let floor = record.noise_floors.get(HEADLINE).map_or_else(String::new, |x| {
        format!("an exact image would have {HEADLINE} {} by the reference's noise", significant(x.0, 2))
    });
    (vec![picture(store, &reference_picture_name(plan, cell), String::new())], vec![Tile::Missing(floor)])
}

fn cell_tiles(store: &Store, plan: &Plan, results: &Results, cell: Option<&Cell>) -> (Tile, Tile) {
    let missing = |why: &str| (Tile::Missing(why.to_owned()), Tile::Missing(String::new()));
    let Some(cell) = cell else { return missing("excluded") };
    match results.get(&cell.id) {
        Some(CellResult::Done(record)) => {
            let note = record.scores.get(HEADLINE).map_or_else(String::new, |score| significant(score.0, 3));
            let image = picture(store, &picture_name(plan, cell), note);
            (image, picture(store, &error_name(plan, cell), String::new()))
        }
        Some(CellResult::Failed(record)) => missing(&format!("failed: {}", record.reason)),
        None => missing("not done"),
    }
}

/// A picture of the run; one that somebody removed is shown as missing.
fn picture(store: &Store, name: &str, note: String) -> Tile {
    match png::read_rgb8(&store.image_path(name)) {
        Ok(image) => Tile::Image { image, note },
        Err(error) => Tile::Missing(error.to_string()),
    }
}

fn method_label(cell: &Cell) -> String {
    format!("{} {}", cell.point.get("method"), cell.point.get("samples")).trim_end().to_owned()
}

fn words(axes: &[&Axis], cell: &Cell, separator: &str) -> String {
    let words = axes.iter().map(|axis| short_text(axis, &cell.point)).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join(separator)
}

fn same(a: &Cell, b: &Cell, axes: &[&Axis]) -> bool {
    axes.iter().all(|axis| a.point.get(axis.name) == b.point.get(axis.name))
}

/// Cells that agree on `axes`, in the order of their first member.
fn grouped<'c>(cells: &[&'c Cell], axes: &[&Axis]) -> Vec<Vec<&'c Cell>> {
    let mut groups: Vec<Vec<&Cell>> = Vec::new();
    for &cell in cells {
        match groups.iter_mut().find(|group| same(group[0], cell, axes)) {
            Some(group) => group.push(cell),
            None => groups.push(vec![cell]),
        }
    }
    groups
}
