//! Contact sheets: columns are the reference and the methods, rows everything else that is swept.
//!
//! Below each display image is its error. If exposure or contrast is swept, each display image has
//! its FLIP map instead, and the linear error map, which does not depend on them, follows once.

use crate::base::files::names_in;
use crate::base::pixels::{Rgb8Image, write_atomically};
use crate::draw::colormap::{FLIP_ERROR, RELATIVE_ERROR};
use crate::draw::figure::sheet::{ContactSheet, Head, Tile, TileRow};
use crate::draw::markdown::significant;
use crate::experiment::axis::{AXES, AxisId, FRAMES, METHOD, POINT_SET, SAMPLES, SCENE, Sheet};
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::value::Value;
use crate::run::companion::ResultFiles;
use crate::run::images::{
    error_name, flip_name, picture_name, reference_picture_name, short_text, sweeps_display,
};
use crate::run::results::Results;
use crate::run::rows;
use crate::run::store::{CellRecord, Store, StoreError};
use crate::run::tables::{DISPLAY_HEADLINE, HEADLINE};
use indexmap::IndexMap;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Width of all images of a sheet together, pixels, within the limits of one image.
const GRID_WIDTH: u32 = 1100;
const TILE_WIDTH_MIN: u32 = 112;
const TILE_WIDTH_MAX: u32 = 256;

/// Writes one contact sheet for each environment, scene and model. Removes sheets of earlier runs.
/// The scene `design` has no sheets, nor has an experiment with `sheets = false`.
#[derive(Clone, Copy, Debug)]
pub struct ContactSheets;

impl ResultFiles for ContactSheets {
    fn write(&self, store: &Store, plan: &Plan, results: &Results) -> Result<(), StoreError> {
        let mut written: BTreeSet<PathBuf> = BTreeSet::new();
        if plan.config.has_sheets {
            let page_axes = swept(plan, Sheet::Page);
            for cells in grouped(&pictured_cells(plan), &page_axes) {
                let path = store.table_path(&file_name(plan, &page_axes, cells[0]));
                let sheet = SheetMaker::new(store, plan, results, &cells).sheet(&cells, &page_axes);
                let text = sheet.svg();
                write_atomically(&path, |writer| {
                    std::io::Write::write_all(writer, text.as_bytes())
                })?;
                written.insert(path);
            }
        }
        for path in sheet_files(store.dir()) {
            if !written.contains(&path) {
                std::fs::remove_file(&path).map_err(|error| StoreError::Io { path, error })?;
            }
        }
        Ok(())
    }
}

/// The file of the sheet that shows a cell: its values on the axes of pages, else the name of the
/// experiment.
fn file_name(plan: &Plan, page_axes: &[AxisId], cell: &Cell) -> String {
    let values = values_in_words(plan, page_axes, cell, "_").replace(['/', ':'], "-");
    let stem = if values.is_empty() {
        &plan.config.name
    } else {
        &values
    };
    format!("{stem}.svg")
}

/// Contact sheets of the run in a folder, by name.
pub fn sheet_files(dir: &Path) -> Vec<PathBuf> {
    let folder = Store::read_only(dir).table_path("");
    names_in(&folder)
        .iter()
        .filter(|name| name.ends_with(".svg"))
        .map(|name| folder.join(name))
        .collect()
}

/// The swept axes whose values a sheet shows in this way.
fn swept(plan: &Plan, sheet: Sheet) -> Vec<AxisId> {
    plan.swept()
        .filter(|&axis| AXES[axis].sheet == sheet)
        .collect()
}

/// Cells with pictures, of the first point set: further sets only differ in noise.
fn pictured_cells(plan: &Plan) -> Vec<&Cell> {
    let first_set = plan
        .cells
        .iter()
        .map(|cell| &cell.point[POINT_SET])
        .find(|set| **set != Value::Unset)
        .unwrap_or(&Value::Unset);
    let is_pictured = |cell: &&Cell| {
        let set = &cell.point[POINT_SET];
        let has_picture = !plan.inputs.scene(cell.point[SCENE].text()).is_design;
        has_picture && (set == &Value::Unset || set == first_set)
    };
    plan.cells.iter().filter(is_pictured).collect()
}

/// The size of images in a sheet with this many columns.
fn tile_size([width, height]: [u32; 2], column_count: usize) -> [u32; 2] {
    let side = (GRID_WIDTH / column_count as u32).clamp(TILE_WIDTH_MIN, TILE_WIDTH_MAX);
    [side, (height * side / width).max(1)]
}

/// What a row of a sheet shows of its cells.
#[derive(Clone, Copy)]
enum Kind {
    Display,
    Flip,
    RelativeError,
}

struct SheetMaker<'p> {
    store: &'p Store,
    plan: &'p Plan,
    results: &'p Results,
    column_axes: Vec<AxisId>,
    /// The first cell of each column.
    columns: Vec<&'p Cell>,
    tile: [u32; 2],
    /// Whether there are references, with error maps.
    is_scored: bool,
    /// Whether exposure or contrast is swept, so that each display image has its FLIP map.
    has_flip: bool,
}

impl<'p> SheetMaker<'p> {
    fn new(store: &'p Store, plan: &'p Plan, results: &'p Results, cells: &[&'p Cell]) -> Self {
        let column_axes = swept(plan, Sheet::Column);
        let columns: Vec<&Cell> = grouped(cells, &column_axes)
            .iter()
            .map(|column| column[0])
            .collect();
        Self {
            store,
            plan,
            results,
            column_axes,
            tile: tile_size(
                plan.size_of(cells[0]),
                columns.len() + usize::from(plan.config.is_scored),
            ),
            columns,
            is_scored: plan.config.is_scored,
            has_flip: plan.config.is_scored && sweeps_display(plan),
        }
    }

    /// The sheet of cells that agree on the axes of pages.
    fn sheet(&self, cells: &[&Cell], page_axes: &[AxisId]) -> ContactSheet {
        let config = &self.plan.config;
        let page = values_in_words(self.plan, page_axes, cells[0], " ");
        let title = format!("{} {page}", config.name);
        let legend = if !self.is_scored {
            String::new()
        } else if self.has_flip {
            format!(
                "Below each image: its {DISPLAY_HEADLINE} and FLIP map. The relative error of \
                 linear values does not depend on exposure and \
                 contrast; below it: its {HEADLINE}."
            )
        } else {
            format!(
                "Below each image: its {HEADLINE} and its relative error against the reference."
            )
        };
        let mut legends = Vec::new();
        if self.has_flip {
            legends.push(("FLIP", FLIP_ERROR));
        }
        if self.is_scored {
            legends.push(("relative error, root of relmse", RELATIVE_ERROR));
        }
        ContactSheet {
            title: title.trim_end().to_owned(),
            caption: format!("{} {legend}", config.question)
                .trim_end()
                .to_owned(),
            tile: self.tile,
            columns: self.heads(),
            rows: self.rows(cells),
            legends,
        }
    }

    /// The heads of the columns; methods are groups.
    fn heads(&self) -> Vec<Head> {
        let mut heads = Vec::new();
        if self.is_scored {
            heads.push(Head {
                label: "reference".to_owned(),
                starts_group: false,
            });
        }
        let mut last_method = None;
        for &cell in &self.columns {
            let method = &cell.point[METHOD];
            let values = values_in_words(self.plan, &self.column_axes, cell, " ");
            let label = if values.is_empty() {
                format!("{method} {}", cell.point[SAMPLES])
                    .trim_end()
                    .to_owned()
            } else {
                values
            };
            heads.push(Head {
                label,
                starts_group: last_method != Some(method),
            });
            last_method = Some(method);
        }
        heads
    }

    fn rows(&self, cells: &[&Cell]) -> Vec<TileRow> {
        let row_axes = swept(self.plan, Sheet::Row);
        let radiance_axes: Vec<AxisId> = row_axes
            .iter()
            .copied()
            .filter(|&axis| AXES[axis].changes_radiance())
            .collect();
        let mut rows = Vec::new();
        for same_radiance in in_rows(cells, &radiance_axes) {
            let displays = in_rows(&same_radiance, &row_axes);
            for row in &displays {
                let label = self.row_label(row, &row_axes);
                rows.push(self.row(label, true, row, Kind::Display));
                if self.has_flip {
                    rows.push(self.row("FLIP".to_owned(), false, row, Kind::Flip));
                }
            }
            if !self.is_scored {
                continue;
            }
            let label = "relative error".to_owned();
            let is_shared = displays.len() > 1;
            rows.push(self.row(label, is_shared, &same_radiance, Kind::RelativeError));
        }
        rows
    }

    /// The values of a row, one axis a line. An unset axis changes nothing in the row.
    fn row_label(&self, cells: &[&Cell], row_axes: &[AxisId]) -> String {
        let mut lines = Vec::new();
        for &axis in row_axes {
            let point = rows::representative(cells.iter().map(|cell| &cell.point), axis);
            let named = self.plan.config.named(axis);
            let value = short_text(named, point);
            if !value.is_empty() {
                lines.push(format!("{} {value}", named.name()));
            }
        }
        lines.join("\n")
    }

    fn row(&self, label: String, starts_group: bool, cells: &[&Cell], kind: Kind) -> TileRow {
        let tiles: Vec<Tile> = self
            .columns
            .par_iter()
            .map(|column| {
                let column = key(column, &self.column_axes);
                let in_column: Vec<&Cell> = cells
                    .iter()
                    .copied()
                    .filter(|cell| key(cell, &self.column_axes) == column)
                    .collect();
                self.tile(&in_column, kind)
            })
            .collect();
        TileRow {
            head: Head {
                label,
                starts_group,
            },
            tiles: self
                .is_scored
                .then(|| self.reference_tile(cells, kind))
                .into_iter()
                .chain(tiles)
                .collect(),
        }
    }

    /// The first finished cell with its record.
    fn first_done<'c>(&self, cells: &[&'c Cell]) -> Option<(&'c Cell, CellRecord)> {
        let done = cells.iter().find(|cell| self.results.is_done(cell))?;
        // Nothing is shown of a record that vanished meanwhile.
        let record = self.store.cell(done.id).ok().flatten()?;
        Some((done, record))
    }

    fn reference_tile(&self, cells: &[&Cell], kind: Kind) -> Tile {
        let Some((cell, record)) = self.first_done(cells) else {
            return Tile::Missing("not done".to_owned());
        };
        match kind {
            Kind::Display => reference_picture_name(self.plan, cell)
                .map_or(Tile::Blank, |name| self.image(&name, String::new())),
            Kind::RelativeError => record.noise_floor(HEADLINE).map_or(Tile::Blank, |floor| {
                let floor = significant(floor, 2);
                Tile::Missing(format!(
                    "an exact image would have {HEADLINE} {floor}: the noise of the reference"
                ))
            }),
            Kind::Flip => Tile::Blank,
        }
    }

    /// The tile of the cells of one row and column: the first finished one.
    fn tile(&self, cells: &[&Cell], kind: Kind) -> Tile {
        let Some(first) = cells.first() else {
            return Tile::Missing("excluded".to_owned());
        };
        let Some((cell, record)) = self.first_done(cells) else {
            let failure = self.results.failure(first);
            return Tile::Missing(failure.map_or_else(
                || "not done".to_owned(),
                |failure| format!("failed: {}", failure.reason),
            ));
        };
        let score = |metric: &str| {
            record
                .answered(metric, self.plan.config.reference.noise_use())
                .map_or_else(String::new, |score| significant(score, 3))
        };
        match kind {
            Kind::Display if self.has_flip => {
                self.image(&picture_name(cell), score(DISPLAY_HEADLINE))
            }
            Kind::Display => self.image(&picture_name(cell), score(HEADLINE)),
            Kind::Flip => self.image(&flip_name(cell), String::new()),
            // Without FLIP the score is below the display image.
            Kind::RelativeError if self.has_flip => self.image(&error_name(cell), score(HEADLINE)),
            Kind::RelativeError => self.image(&error_name(cell), String::new()),
        }
    }

    /// An image of the run, at the sheet's size or smaller, with a note below it.
    fn image(&self, name: &str, note: String) -> Tile {
        let picture = match image::open(self.store.image_path(name)) {
            Ok(picture) => picture.into_rgb8(),
            Err(error) => return Tile::Missing(error.to_string()),
        };
        let mut image = Rgb8Image::new(
            picture.width(),
            picture.height(),
            picture.pixels().map(|pixel| pixel.0).collect(),
        );
        let [width, height] = self.tile;
        if image.width > width {
            image = image.shrunk(width, height);
        }
        Tile::Image { image, note }
    }
}

/// The values of a cell on some axes, for labels.
fn values_in_words(plan: &Plan, axes: &[AxisId], cell: &Cell, separator: &str) -> String {
    let mut words = Vec::new();
    for &axis in axes {
        let named = plan.config.named(axis);
        let value = short_text(named, &cell.point);
        if value.is_empty() {
            continue;
        }
        // A bare number after a method would mean samples.
        words.push(if axis == FRAMES {
            named.symbol().label(&value)
        } else {
            value
        });
    }
    words.join(separator)
}

fn key<'c>(cell: &'c Cell, axes: &[AxisId]) -> Vec<&'c Value> {
    axes.iter().map(|&axis| &cell.point[axis]).collect()
}

/// Groups cells that agree on `axes`. A cell with an unset axis is in every group that it fits.
fn in_rows<'c>(cells: &[&'c Cell], axes: &[AxisId]) -> Vec<Vec<&'c Cell>> {
    let key = |cell: &Cell| axes.iter().map(|&axis| cell.point[axis].clone()).collect();
    rows::rows(cells, key)
        .into_iter()
        .map(|(_, row)| row)
        .collect()
}

/// Groups cells that agree on `axes`, in the order of their first member.
fn grouped<'c>(cells: &[&'c Cell], axes: &[AxisId]) -> Vec<Vec<&'c Cell>> {
    let mut groups: IndexMap<Vec<&Value>, Vec<&Cell>> = IndexMap::new();
    for &cell in cells {
        groups.entry(key(cell, axes)).or_default().push(cell);
    }
    groups.into_values().collect()
}
