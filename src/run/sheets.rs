//! Contact sheets: columns are the reference and the methods, rows everything else that is swept.
//!
//! Below each display image is its error. If exposure or contrast is swept, each display image has
//! its FLIP map instead, and the linear error map, which does not depend on them, follows once.

use super::images::{
    error_name, flip_name, picture_name, reference_picture_name, short_text, sweeps_display,
};
use super::rows;
use super::store::{KeptCell, Store, StoreError};
use super::tables::{CellResult, DISPLAY_HEADLINE, HEADLINE, Results};
use crate::base::files::names_in;
use crate::base::pixels::{Rgb8Image, write_atomically};
use crate::draw::colormap::{FLIP_ERROR, RELATIVE_ERROR};
use crate::draw::figure::sheet::{ContactSheet, Head, Tile};
use crate::draw::markdown::significant;
use crate::experiment::axis::{AXES, AxisId, FRAMES, METHOD, POINT_SET, SAMPLES, SCENE, Sheet};
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::value::Value;
use indexmap::IndexMap;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Width of all images of a sheet, pixels, unless one would be narrower than the first of
/// [`TILE_WIDTHS`] or wider than the second.
const GRID_WIDTH: u32 = 1100;
const TILE_WIDTHS: [u32; 2] = [112, 256];

/// Writes one contact sheet for each environment, scene and model. Removes sheets of earlier runs.
/// There are no sheets of the scene `design`, and none with `sheets = false`.
pub fn write_sheets(store: &Store, plan: &Plan, results: &Results) -> Result<(), StoreError> {
    let [sheet_axes, column_axes] = [Sheet::Page, Sheet::Column].map(|place| swept(plan, place));
    let mut written: BTreeSet<PathBuf> = BTreeSet::new();
    let shown = if plan.config.has_sheets {
        shown(plan)
    } else {
        Vec::new()
    };
    for cells in grouped(&shown, &sheet_axes) {
        let columns = grouped(&cells, &column_axes);
        let title = format!(
            "{} {}",
            plan.config.name,
            words(plan, &sheet_axes, cells[0], " ")
        );
        let (tile, has_flip) = (
            tile_size(plan.size_of(cells[0]), columns.len() + 1),
            sweeps_display(plan),
        );
        let maker = Maker {
            store,
            plan,
            results,
            columns: &columns,
            column_axes: &column_axes,
            tile,
            has_flip,
        };
        let name = words(plan, &sheet_axes, cells[0], "_").replace(['/', ':'], "-");
        let name = if name.is_empty() {
            plan.config.name.clone()
        } else {
            name
        };
        let path = store.table_path(&format!("{name}.svg"));
        let sheet = maker.sheet(&cells, title.trim_end().to_owned()).svg();
        write_atomically(&path, |writer| {
            std::io::Write::write_all(writer, sheet.as_bytes())
        })?;
        written.insert(path);
    }
    for path in sheet_files(store.dir())
        .into_iter()
        .filter(|path| !written.contains(path))
    {
        std::fs::remove_file(&path).map_err(|error| StoreError::Io { path, error })?;
    }
    Ok(())
}

/// Contact sheets of the run in a folder, by name.
pub fn sheet_files(dir: &Path) -> Vec<PathBuf> {
    let folder = Store::at(dir).table_path("");
    names_in(&folder)
        .iter()
        .filter(|name| name.ends_with(".svg"))
        .map(|name| folder.join(name))
        .collect()
}

/// The swept axes whose values are in this place of a sheet.
fn swept(plan: &Plan, place: Sheet) -> Vec<AxisId> {
    plan.swept()
        .filter(|&axis| AXES[axis].sheet == place)
        .collect()
}

/// Cells with pictures, of the first point set: further sets only differ in noise.
fn shown(plan: &Plan) -> Vec<&Cell> {
    let sets = plan.cells.iter().map(|cell| &cell.point[POINT_SET]);
    let first = sets
        .into_iter()
        .find(|set| **set != Value::Unset)
        .unwrap_or(&Value::Unset);
    let is_picture = |cell: &Cell| !plan.inputs.scene(cell.point[SCENE].text()).is_design;
    plan.cells
        .iter()
        .filter(|cell| is_picture(cell) && [&Value::Unset, first].contains(&&cell.point[POINT_SET]))
        .collect()
}

/// The size of images in a sheet with this many columns.
fn tile_size([width, height]: [u32; 2], columns: usize) -> [u32; 2] {
    let [least, most] = TILE_WIDTHS;
    let side = (GRID_WIDTH / columns as u32).clamp(least, most);
    [side, (height * side / width).max(1)]
}

#[derive(Clone, Copy)]
enum Kind {
    Display,
    Flip,
    RelativeError,
}

struct Maker<'p> {
    store: &'p Store,
    plan: &'p Plan,
    results: &'p Results,
    columns: &'p [Vec<&'p Cell>],
    column_axes: &'p [AxisId],
    tile: [u32; 2],
    has_flip: bool,
}

impl Maker<'_> {
    fn sheet(&self, cells: &[&Cell], title: String) -> ContactSheet {
        let mut columns = vec![Head {
            label: "reference".to_owned(),
            starts_group: false,
        }];
        let mut before = None;
        for column in self.columns {
            let cell = column[0];
            let label = words(self.plan, self.column_axes, cell, " ");
            let method = format!("{} {}", cell.point[METHOD], cell.point[SAMPLES])
                .trim_end()
                .to_owned();
            let starts_group = before.replace(&cell.point[METHOD]) != Some(&cell.point[METHOD]);
            columns.push(Head {
                label: if label.is_empty() { method } else { label },
                starts_group,
            });
        }
        let below = match self.has_flip {
            true => format!(
                "Below each image: its {DISPLAY_HEADLINE} and FLIP map. The relative error of \
                 linear values does not depend on exposure and \
                 contrast; below it: its {HEADLINE}."
            ),
            false => format!(
                "Below each image: its {HEADLINE} and its relative error against the reference."
            ),
        };
        let flip = self.has_flip.then_some(("FLIP", FLIP_ERROR));
        let error = Some(("relative error, root of relmse", RELATIVE_ERROR));
        ContactSheet {
            title,
            caption: format!("{} {below}", self.plan.config.question),
            tile: self.tile,
            columns,
            rows: self.rows(cells),
            legends: [flip, error].into_iter().flatten().collect(),
        }
    }

    fn rows(&self, cells: &[&Cell]) -> Vec<(Head, Vec<Tile>)> {
        let row_axes = swept(self.plan, Sheet::Row);
        let radiance_axes: Vec<AxisId> = row_axes
            .iter()
            .copied()
            .filter(|&axis| AXES[axis].changes_radiance())
            .collect();
        let mut rows = Vec::new();
        for shared in in_rows(cells, &radiance_axes) {
            let displays = in_rows(&shared, &row_axes);
            for row in &displays {
                let line = |&axis: &AxisId| {
                    let point = rows::representative(row.iter().map(|cell| &cell.point), axis);
                    let named = self.plan.config.named(axis);
                    // An unset axis changes nothing in the row.
                    Some(short_text(named, point))
                        .filter(|text| !text.is_empty())
                        .map(|text| format!("{} {text}", named.name()))
                };
                let label = row_axes
                    .iter()
                    .filter_map(line)
                    .collect::<Vec<_>>()
                    .join("\n");
                rows.push(self.row(label, true, row, Kind::Display));
                if self.has_flip {
                    rows.push(self.row("FLIP".to_owned(), false, row, Kind::Flip));
                }
            }
            rows.push(self.row(
                "relative error".to_owned(),
                displays.len() > 1,
                &shared,
                Kind::RelativeError,
            ));
        }
        rows
    }

    /// A row. The first finished cell of a column is shown.
    fn row(
        &self,
        label: String,
        starts_group: bool,
        cells: &[&Cell],
        kind: Kind,
    ) -> (Head, Vec<Tile>) {
        let of_column = |column: &Vec<&Cell>| -> Vec<&Cell> {
            cells
                .iter()
                .copied()
                .filter(|cell| key(cell, self.column_axes) == key(column[0], self.column_axes))
                .collect()
        };
        let own: Vec<Vec<&Cell>> = self.columns.iter().map(of_column).collect();
        let tiles: Vec<Tile> = own.par_iter().map(|own| self.tile(own, kind)).collect();
        let tiles = [self.reference_tile(cells, kind)]
            .into_iter()
            .chain(tiles)
            .collect();
        (
            Head {
                label,
                starts_group,
            },
            tiles,
        )
    }

    fn first_done<'c>(&self, cells: &[&'c Cell]) -> Option<(&'c Cell, &KeptCell)> {
        cells
            .iter()
            .find_map(|&cell| match self.results.get(&cell.id) {
                Some(CellResult::Done(record)) => Some((cell, &**record)),
                _ => None,
            })
    }

    fn reference_tile(&self, cells: &[&Cell], kind: Kind) -> Tile {
        let Some((cell, record)) = self.first_done(cells) else {
            return Tile::Missing("not done".to_owned());
        };
        match kind {
            Kind::Display => self.image(
                self.picture(&reference_picture_name(self.plan, cell)),
                String::new(),
            ),
            Kind::RelativeError => record.noise_floor(HEADLINE).map_or(Tile::Blank, |floor| {
                let floor = significant(floor, 2);
                Tile::Missing(format!(
                    "an exact image would have {HEADLINE} {floor}: the noise of the reference"
                ))
            }),
            Kind::Flip => Tile::Blank,
        }
    }

    fn tile(&self, cells: &[&Cell], kind: Kind) -> Tile {
        let Some(first) = cells.first() else {
            return Tile::Missing("excluded".to_owned());
        };
        let Some((cell, record)) = self.first_done(cells) else {
            return Tile::Missing(match self.results.get(&first.id) {
                Some(CellResult::Failed(record)) => format!("failed: {}", record.reason),
                _ => "not done".to_owned(),
            });
        };
        let (image, metric) = match kind {
            Kind::Display => {
                let metric = if self.has_flip {
                    DISPLAY_HEADLINE
                } else {
                    HEADLINE
                };
                (self.picture(&picture_name(cell)), Some(metric))
            }
            Kind::Flip => (self.picture(&flip_name(cell)), None),
            Kind::RelativeError => (
                self.picture(&error_name(cell)),
                self.has_flip.then_some(HEADLINE),
            ),
        };
        let score = metric.and_then(|metric| record.score(metric));
        self.image(
            image,
            score.map_or_else(String::new, |score| significant(score, 3)),
        )
    }

    fn picture(&self, name: &str) -> image::ImageResult<Rgb8Image> {
        let picture = image::open(self.store.image_path(name))?.into_rgb8();
        Ok(Rgb8Image::new(
            picture.width(),
            picture.height(),
            picture.pixels().map(|pixel| pixel.0).collect(),
        ))
    }

    /// A picture at the sheet's size, or smaller.
    fn image(&self, picture: image::ImageResult<Rgb8Image>, note: String) -> Tile {
        let [width, height] = self.tile;
        match picture {
            Ok(image) if image.width <= width => Tile::Image { image, note },
            Ok(image) => Tile::Image {
                image: image.shrunk(width, height),
                note,
            },
            Err(error) => Tile::Missing(error.to_string()),
        }
    }
}

fn words(plan: &Plan, axes: &[AxisId], cell: &Cell, separator: &str) -> String {
    let word = |&axis: &AxisId| {
        let (named, text) = (
            plan.config.named(axis),
            short_text(plan.config.named(axis), &cell.point),
        );
        // A number beside a method means samples.
        if axis == FRAMES && !text.is_empty() {
            named.symbol().label(&text)
        } else {
            text
        }
    };
    let words = axes.iter().map(word);
    words
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join(separator)
}

fn key<'c>(cell: &'c Cell, axes: &[AxisId]) -> Vec<&'c Value> {
    axes.iter().map(|&axis| &cell.point[axis]).collect()
}

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
    cells
        .iter()
        .for_each(|&cell| groups.entry(key(cell, axes)).or_default().push(cell));
    groups.into_values().collect()
}
