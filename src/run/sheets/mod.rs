//! Contact sheets: columns are the reference and the methods, rows everything else that is swept.
//!
//! Below each display image stands its error. The linear error does not depend on the tone curve: where exposure or contrast is
//! swept, each display image has its FLIP map, and the linear map stands once below all of them.

use super::images::{
    error_name, flip_name, linear_files, picture_name, reference_picture_name, short_text, sweeps_display,
};
use super::rows;
use super::store::{KeptCell, Store, StoreError};
use super::tables::{CellResult, DISPLAY_HEADLINE, HEADLINE, Results};
use crate::experiment::axis::{AXES, METHOD, POINT_SET, SAMPLES, SCENE, Sheet};
use crate::experiment::plan::{Cell, Plan};
use crate::files::names_in;
use crate::pixels::{GrayImage, PixelsError, Rgb8Image, RgbImage, exr, png};
use crate::table::colormap::{FLIP_ERROR, RELATIVE_ERROR, SIGNED_ERROR};
use crate::table::contact_sheet::{ContactSheet, Legend, Tile};
use crate::table::markdown::significant;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Smaller images are magnified to this side, pixels.
const TILE_SIDE_MIN: u32 = 128;
/// Width of a page, pixels: two sheets fit side by side on a large monitor.
const PAGE_WIDTH_MAX: u32 = 2600;
/// Width and height of a published page, pixels: wider ones are shrunk to the width, and then have the height at most.
pub const PUBLISHED_SIZE: [u32; 2] = [1200, 2400];
/// Why a sheet can be drawn.
const EVEN_SHEET: &str = "every row of a sheet has one tile a column, all of one size";
/// Room on a page beside its tiles: margins and row labels.
const PAGE_OVERHEAD: u32 = 240;
/// Room between two columns, group gaps included.
const COLUMN_GAP: u32 = 8;
/// Images are never shrunk below this width: rather, a sheet is split.
const SHRUNK_WIDTH_MIN: u32 = 200;

/// One contact sheet for each environment, scene and model: in parts for some of the methods where all would not fit side by side, and in
/// pages where not all rows would fit below each other. None of a design, whose images are no pictures, and none where the experiment says
/// `sheets = false`. Sheets of an earlier program are removed.
pub fn write_sheets(store: &Store, plan: &Plan, results: &Results) -> Result<(), StoreError> {
    let [sheet_axes, column_axes] = [Sheet::Page, Sheet::Column].map(|place| swept(plan, place));
    let mut written: BTreeSet<PathBuf> = BTreeSet::new();
    let shown = if plan.config.has_sheets { of_first_point_set(plan) } else { Vec::new() };
    for cells in grouped(&shown, &sheet_axes) {
        let columns = grouped(&cells, &column_axes);
        let tiles = TileSize::new(plan.size_of(cells[0]));
        let parts = parts(&columns, tiles.columns_max());
        let mut pages: Vec<ContactSheet> = Vec::new();
        for (part, columns) in parts.iter().enumerate() {
            let of = if parts.len() > 1 { format!(", part {} of {}", part + 1, parts.len()) } else { String::new() };
            let title = format!("{} {}", plan.config.name, words(&sheet_axes, cells[0], " "));
            let content = Page { store, plan, results, columns, column_axes: &column_axes, tiles };
            let sheet = content.sheet(&cells, format!("{}{of}", title.trim_end()));
            let [width, _] = sheet.size().expect(EVEN_SHEET);
            pages.extend(sheet.pages(page_height(width)).expect(EVEN_SHEET));
        }
        let name = words(&sheet_axes, cells[0], "_").replace(['/', ':'], "-");
        let name = if name.is_empty() { plan.config.name.clone() } else { name };
        let page_path = |page: usize| {
            let number = if pages.len() > 1 { format!("_{}", page + 1) } else { String::new() };
            store.table_path(&format!("{name}{number}.png"))
        };
        let write = |(page, sheet): (usize, &ContactSheet)| {
            png::write_rgb8(&page_path(page), &sheet.render().expect(EVEN_SHEET))
        };
        pages.par_iter().enumerate().try_for_each(write)?;
        written.extend((0..pages.len()).map(page_path));
    }
    for path in sheet_files(store.dir()).into_iter().filter(|path| !written.contains(path)) {
        std::fs::remove_file(&path).map_err(|error| StoreError::Io { path, error })?;
    }
    Ok(())
}

/// The swept axes whose values sheets show in that place.
fn swept(plan: &Plan, place: Sheet) -> Vec<usize> {
    plan.swept().filter(|&axis| AXES[axis].sheet == place).collect()
}

/// Height of a page of a width, pixels: shrunk for publication it fits.
fn page_height(width: u32) -> u32 {
    let [published_width, published_height] = PUBLISHED_SIZE;
    (width.max(published_width) * published_height) / published_width
}

/// Contact sheets of the run in a folder: by name, pages by number.
pub fn sheet_files(dir: &Path) -> Vec<PathBuf> {
    let folder = Store::at(dir).table_path("");
    let names = names_in(&folder).into_iter().filter(|name| name.ends_with(".png"));
    let mut found: Vec<PathBuf> = names.map(|name| folder.join(name)).collect();
    let key = |path: &PathBuf| {
        let stem = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        match stem.rsplit_once('_').and_then(|(name, page)| Some((name.to_owned(), page.parse::<u32>().ok()?))) {
            Some((name, page)) => (name, page),
            None => (stem, 0),
        }
    };
    found.sort_by_key(key);
    found
}

/// The cells that a sheet shows: point sets differ in luck only, so the first one stands for all.
fn of_first_point_set(plan: &Plan) -> Vec<&Cell> {
    let set = |cell: &&Cell| cell.point[POINT_SET].to_string();
    let first = plan.cells.iter().map(|cell| set(&cell)).find(|set| !set.is_empty());
    let is_picture = |cell: &&Cell| !plan.inputs.scene(cell.point[SCENE].text()).is_design;
    plan.cells.iter().filter(|cell| is_picture(cell) && (set(cell).is_empty() || Some(set(cell)) == first)).collect()
}

/// How images of one size are shown.
#[derive(Clone, Copy, Debug)]
struct TileSize {
    image: [u32; 2],
    /// Factor for small images.
    scale: u32,
}

impl TileSize {
    fn new(image: [u32; 2]) -> Self {
        Self { image, scale: TILE_SIDE_MIN.div_ceil(image[0]).max(1) }
    }

    fn native_width(self) -> u32 {
        self.image[0] * self.scale
    }

    /// Columns of a page, the reference's included, at the smallest width that images may have.
    fn columns_max(self) -> usize {
        let smallest = self.native_width().min(SHRUNK_WIDTH_MIN);
        ((PAGE_WIDTH_MAX - PAGE_OVERHEAD) / (smallest + COLUMN_GAP)).max(2) as usize
    }

    /// The size of images on a page of `columns` columns, when they must be made smaller.
    fn shrunk(self, columns: usize) -> Option<[u32; 2]> {
        let room = ((PAGE_WIDTH_MAX - PAGE_OVERHEAD) / columns as u32).saturating_sub(COLUMN_GAP).max(1);
        let [width, height] = self.image;
        (room < width).then(|| [room, (height * room / width).max(1)])
    }
}

/// Columns in parts of at most `columns_max` with the reference's; the columns of a method stay together where they can.
fn parts<'c>(columns: &[Vec<&'c Cell>], columns_max: usize) -> Vec<Vec<Vec<&'c Cell>>> {
    let room = columns_max - 1;
    let mut pages: Vec<Vec<Vec<&Cell>>> = Vec::new();
    for family in columns.chunk_by(|a, b| a[0].point[METHOD] == b[0].point[METHOD]) {
        match pages.last_mut() {
            Some(page) if page.len() + family.len() <= room => page.extend_from_slice(family),
            _ => pages.extend(family.chunks(room).map(<[_]>::to_vec)),
        }
    }
    pages
}

/// Some columns of a sheet.
struct Page<'p> {
    store: &'p Store,
    plan: &'p Plan,
    results: &'p Results,
    columns: &'p [Vec<&'p Cell>],
    column_axes: &'p [usize],
    tiles: TileSize,
}

/// The kind of picture in a row.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Display,
    Flip,
    RelativeError,
}

impl Kind {
    fn file(self, cell: &Cell) -> String {
        match self {
            Self::Display => picture_name(cell),
            Self::Flip => flip_name(cell),
            Self::RelativeError => error_name(cell),
        }
    }

    /// The metric below it.
    fn metric(self, with_flip: bool) -> Option<&'static str> {
        match self {
            Self::Display => Some(if with_flip { DISPLAY_HEADLINE } else { HEADLINE }),
            Self::RelativeError if with_flip => Some(HEADLINE),
            Self::Flip | Self::RelativeError => None,
        }
    }
}

impl Page<'_> {
    fn sheet(&self, cells: &[&Cell], title: String) -> ContactSheet {
        let plan = self.plan;
        let row_axes = swept(plan, Sheet::Row);
        let radiance_axes: Vec<usize> =
            row_axes.iter().copied().filter(|&axis| AXES[axis].changes_radiance()).collect();
        let with_flip = sweeps_display(plan);
        let mut sheet = ContactSheet {
            title,
            caption: self.caption(with_flip),
            column_labels: vec!["reference".to_owned()],
            row_labels: Vec::new(),
            rows: Vec::new(),
            column_group_starts: vec![1],
            row_group_starts: Vec::new(),
            scale: self.tiles.scale,
            legends: vec![Legend { label: format!("relative error, root of {HEADLINE}"), scale: RELATIVE_ERROR }],
        };
        if with_flip {
            sheet.legends.insert(0, Legend { label: "FLIP".to_owned(), scale: FLIP_ERROR });
        }
        for (index, column) in self.columns.iter().enumerate() {
            let label = words(self.column_axes, column[0], " ");
            sheet.column_labels.push(if label.is_empty() { method_label(column[0]) } else { label });
            if index > 0 && column[0].point[METHOD] != self.columns[index - 1][0].point[METHOD] {
                sheet.column_group_starts.push(index + 1);
            }
        }
        let label = |row: &[&Cell]| {
            let value = |axis: usize| short_text(axis, rows::teller(row.iter().map(|cell| &cell.point), axis));
            let lines = row_axes.iter().map(|&axis| format!("{} {}", AXES[axis].name, value(axis)));
            lines.collect::<Vec<_>>().join("\n")
        };
        for shared in in_rows(cells, &radiance_axes) {
            let displays = in_rows(&shared, &row_axes);
            for row in &displays {
                sheet.row_group_starts.push(sheet.rows.len());
                self.row(&mut sheet, label(row), row, Kind::Display);
                if with_flip {
                    self.row(&mut sheet, "FLIP".to_owned(), row, Kind::Flip);
                }
            }
            if displays.len() > 1 {
                sheet.row_group_starts.push(sheet.rows.len());
            }
            self.row(&mut sheet, "relative error".to_owned(), &shared, Kind::RelativeError);
            if self.plan.config.ladder.is_some() {
                self.steps(&mut sheet, &shared);
            }
        }
        if self.plan.config.ladder.is_some() {
            sheet.legends.push(Legend { label: "signed step".to_owned(), scale: SIGNED_ERROR });
        }
        sheet
    }

    fn caption(&self, with_flip: bool) -> String {
        let below = if with_flip {
            format!(
                "Below each image: its {DISPLAY_HEADLINE} and the map of it. The relative error is that of linear values, the same for \
                 every exposure and contrast; below it, its {HEADLINE}."
            )
        } else {
            format!("Below each image: its {HEADLINE}; below it, relative error against the reference.")
        };
        let step = match self.plan.config.ladder {
            Some(_) => " Signed step: what an image adds to the one before it, over the reference.",
            None => "",
        };
        format!("{} {below}{step}", self.plan.config.question)
    }

    /// Adds a row: of all `cells` of a column, the first that was done stands for it.
    fn row(&self, sheet: &mut ContactSheet, label: String, cells: &[&Cell], kind: Kind) {
        let mut tiles = vec![self.reference_tile(cells, kind)];
        // Pictures are read and shrunk side by side: a large sheet has hundreds.
        tiles.par_extend(self.columns.par_iter().map(|column| {
            let of_column = cells.iter().copied().filter(|cell| same(cell, column[0], self.column_axes));
            self.tile(&of_column.collect::<Vec<_>>(), kind)
        }));
        sheet.row_labels.push(label);
        sheet.rows.push(tiles);
    }

    /// Adds a row with what each column adds to the one before, over the reference: the steps of the ladder.
    fn steps(&self, sheet: &mut ContactSheet, cells: &[&Cell]) {
        let mut tiles = vec![Tile::Blank];
        let of_column =
            |column: &[&'_ Cell]| cells.iter().find(|cell| same(cell, column[0], self.column_axes)).copied();
        let own: Vec<Option<&Cell>> = self.columns.iter().map(|column| of_column(column)).collect();
        for (i, cell) in own.iter().enumerate() {
            tiles.push(match cell.map(|cell| self.step(cell, if i > 0 { own[i - 1] } else { None })) {
                Some(Ok(image)) => {
                    let image =
                        self.tiles.shrunk(self.columns.len() + 1).map_or(image.clone(), |[w, h]| image.shrunk(w, h));
                    Tile::Image { image, note: String::new() }
                }
                Some(Err(error)) => Tile::Missing(error.to_string()),
                None => Tile::Missing("excluded".to_owned()),
            });
        }
        sheet.row_labels.push("signed step".to_owned());
        sheet.rows.push(tiles);
    }

    /// The difference of an image to the one before, else to the reference, over the root of `r² + ε`, mean over channels.
    fn step(&self, cell: &Cell, before: Option<&Cell>) -> Result<Rgb8Image, PixelsError> {
        let [own, reference] = linear_files(self.plan, cell);
        let before = before.map_or(reference.clone(), |before| linear_files(self.plan, before)[0].clone());
        let read = |name: String| exr::read(&self.store.image_path(&name));
        let (own, before, reference) = (read(own)?, read(before)?, read(reference)?);
        let epsilon = self.plan.request(&cell.point).epsilon().beside_square();
        let map = signed_step([&own.rgb, &before.rgb, &reference.rgb], epsilon);
        let mask = reference.alpha.unwrap_or_else(|| map.map(|_| 1.0));
        Ok(SIGNED_ERROR.image(&map, &mask))
    }

    fn done(&self, cell: &Cell) -> Option<&KeptCell> {
        match self.results.get(&cell.id) {
            Some(CellResult::Done(record)) => Some(record),
            _ => None,
        }
    }

    fn reference_tile(&self, row: &[&Cell], kind: Kind) -> Tile {
        let Some((cell, record)) = row.iter().find_map(|cell| Some((*cell, self.done(cell)?))) else {
            return Tile::Missing("not done".to_owned());
        };
        if kind == Kind::Display {
            return self.picture(&reference_picture_name(self.plan, cell), String::new());
        }
        match record.noise_floor(HEADLINE) {
            Some(floor) if kind == Kind::RelativeError => Tile::Missing(format!(
                "an exact image would have {HEADLINE} {} by the reference's noise",
                significant(floor, 2)
            )),
            _ => Tile::Blank,
        }
    }

    fn tile(&self, cells: &[&Cell], kind: Kind) -> Tile {
        let Some(first) = cells.first() else { return Tile::Missing("excluded".to_owned()) };
        if let Some((cell, record)) = cells.iter().find_map(|cell| Some((*cell, self.done(cell)?))) {
            let score = kind.metric(sweeps_display(self.plan)).and_then(|metric| record.score(metric));
            let note = score.map_or_else(String::new, |score| significant(score, 3));
            return self.picture(&kind.file(cell), note);
        }
        Tile::Missing(match self.results.get(&first.id) {
            Some(CellResult::Failed(record)) => format!("failed: {}", record.reason),
            _ => "not done".to_owned(),
        })
    }

    /// A picture of the run at the page's size; one that somebody removed is shown as missing.
    fn picture(&self, name: &str, note: String) -> Tile {
        match png::read_rgb8(&self.store.image_path(name)) {
            Ok(image) => {
                let image = match self.tiles.shrunk(self.columns.len() + 1) {
                    Some([width, height]) => image.shrunk(width, height),
                    None => image,
                };
                Tile::Image { image, note }
            }
            Err(error) => Tile::Missing(error.to_string()),
        }
    }
}

fn method_label(cell: &Cell) -> String {
    format!("{} {}", cell.point[METHOD], cell.point[SAMPLES]).trim_end().to_owned()
}

fn words(axes: &[usize], cell: &Cell, separator: &str) -> String {
    let words = axes.iter().map(|&axis| short_text(axis, &cell.point)).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join(separator)
}

fn same(a: &Cell, b: &Cell, axes: &[usize]) -> bool {
    axes.iter().all(|&axis| a.point[axis] == b.point[axis])
}

fn in_rows<'c>(cells: &[&'c Cell], axes: &[usize]) -> Vec<Vec<&'c Cell>> {
    rows::rows(cells, axes, |cell| &cell.point).into_iter().map(|row| row.into_iter().copied().collect()).collect()
}

/// Cells that agree on `axes`, in the order of their first member.
fn grouped<'c>(cells: &[&'c Cell], axes: &[usize]) -> Vec<Vec<&'c Cell>> {
    let mut groups: Vec<Vec<&Cell>> = Vec::new();
    for &cell in cells {
        match groups.iter_mut().find(|group| same(group[0], cell, axes)) {
            Some(group) => group.push(cell),
            None => groups.push(vec![cell]),
        }
    }
    groups
}

/// The difference of an image to the one before it, over the root of `r² + ε`, mean over channels. All have one size.
pub fn signed_step([own, before, reference]: [&RgbImage; 3], epsilon: f64) -> GrayImage {
    GrayImage::from_fn(own.width, own.height, |x, y| {
        let [own, before, r] = [own, before, reference].map(|image| image.get(x, y).map(f64::from));
        let mean: f64 = (0..3).map(|c| (own[c] - before[c]) / (r[c] * r[c] + epsilon).sqrt() / 3.0).sum();
        mean as f32
    })
}
