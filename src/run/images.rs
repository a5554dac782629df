//! The images of a run: linear EXR, tone-mapped PNG, error maps; what their files are called.

use super::store::Store;
use super::tables::{CellResult, Results, Rows};
use crate::environment::BUILTIN_PREFIX;
use crate::experiment::axis::{
    ALPHA, AXES, Axis, BRDF, DIFFUSE_METHOD, ENVIRONMENT, METHOD, Named, Point, SAMPLES, SCENE,
};
use crate::experiment::plan::{Cell, Plan};
use crate::files::content_hash;
use crate::pipeline::Frame;
use crate::pixels::{PixelsError, exr};
use crate::spelling::short_number;
use crate::table::csv::Cell as Field;
use blake3::Hash;
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::Path;

/// The layer of a reference that holds its standard error.
pub const STANDARD_ERROR_LAYER: &str = "standard_error";
/// File names stop here; the id after it keeps them apart.
const SLUG_LENGTH: usize = 120;

/// A value as people say it: builtins without their prefix, files without folder and extension, numbers in a few digits. Tables for
/// programs hold the value whole.
pub fn short_text(named: Named, point: &Point) -> String {
    short_value(named.entry(), &named.shown(&point[named.axis]).to_string()).into_owned()
}

/// As [`short_text`], of a value as tables hold it.
pub fn short_value<'v>(axis: &Axis, text: &'v str) -> Cow<'v, str> {
    match (axis.kind.path_in(text), text.strip_prefix(BUILTIN_PREFIX)) {
        (None, _) => short_number(text),
        (_, Some(formula)) => formula.into(),
        (Some(path), None) => Path::new(path).file_stem().map_or(text.into(), |stem| stem.to_string_lossy()),
    }
}

/// The axes whose values begin a file name, for people; the id after them tells files apart. They are the same in every plan, so that a larger
/// one finds the files of a smaller one.
const NAMING: [usize; 7] = [ENVIRONMENT, SCENE, BRDF, ALPHA, METHOD, DIFFUSE_METHOD, SAMPLES];

/// The values of a point that begin a file name.
fn slug(point: &Point) -> String {
    let words: Vec<String> =
        NAMING.iter().map(|&axis| short_text(Named::own(axis), point)).filter(|word| !word.is_empty()).collect();
    file_words(&words.join("_"))
}

/// A text as part of a file name. It begins with a letter, digit or `_`, or as a number does: nothing that a spreadsheet, a shell or a
/// listing takes for something else.
pub fn file_words(text: &str) -> String {
    let is_number = text.strip_prefix('-').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
    let plain = |(place, c): (usize, char)| match c {
        '-' | '.' if place == 0 && !is_number => '_',
        c if c.is_ascii_alphanumeric() || "-_.".contains(c) => c,
        _ if place == 0 => '_',
        _ => '-',
    };
    text.chars().enumerate().map(plain).take(SLUG_LENGTH).collect()
}

/// File name of the linear image of a point.
pub fn radiance_name(point: &Point, id: &str) -> String {
    format!("{}.{id}.exr", slug(point))
}

pub(super) fn picture_name(cell: &Cell) -> String {
    format!("{}.{}.png", slug(&cell.point), cell.id)
}

/// Cells that differ in the tone curve only share it.
pub(super) fn error_name(cell: &Cell) -> String {
    format!("{}.{}.error.png", slug(&cell.point), cell.radiance)
}

pub(super) fn flip_name(cell: &Cell) -> String {
    format!("{}.{}.flip.png", slug(&cell.point), cell.id)
}

pub(super) fn reference_picture_name(plan: &Plan, cell: &Cell) -> String {
    let point = plan.reference_point(&cell.point);
    let display = AXES.iter().zip(&point.0).filter(|(axis, _)| !axis.changes_radiance());
    let display: Vec<String> = display.map(|(axis, value)| format!("{}{value}", axis.name)).collect();
    format!("{}.{}.{}.png", slug(&point), display.join("-"), cell.reference)
}

/// Writes linear RGBA (A is the mask) and, for a reference, its standard error as a layer.
pub fn write_radiance(path: &Path, frame: &Frame) -> Result<(), PixelsError> {
    let layers: Vec<_> = frame.standard_error.iter().map(|image| (STANDARD_ERROR_LAYER, image)).collect();
    exr::write_rgba(path, &frame.radiance, &frame.mask, &layers)
}

/// Whether cells differ in the tone curve only: then each has its own map of visible differences.
pub(super) fn sweeps_display(plan: &Plan) -> bool {
    plan.swept().any(|axis| !AXES[axis].changes_radiance())
}

/// Every file of `images/` that belongs to a finished cell.
pub(super) fn files(plan: &Plan, cell: &Cell) -> Vec<String> {
    let flip = sweeps_display(plan).then(|| flip_name(cell));
    index_names(plan, cell).into_iter().chain(flip).collect()
}

/// The content hashes in a cell's record, in the order of [`files`]; none for a file that it does not tell of.
pub(super) fn hashes(plan: &Plan, cell: &Cell, recorded: &BTreeMap<String, String>) -> Box<[Option<Hash>]> {
    // What is no hash is that of no file.
    let hash = |hex: &String| Hash::from_hex(hex).unwrap_or(Hash::from_bytes([0; blake3::OUT_LEN]));
    files(plan, cell).iter().map(|name| recorded.get(name).map(hash)).collect()
}

/// The linear images of a cell and its reference.
pub fn linear_files(plan: &Plan, cell: &Cell) -> [String; 2] {
    let reference = plan.reference_point(&cell.point);
    [radiance_name(&cell.point, &cell.radiance), radiance_name(&reference, &cell.reference)]
}

/// Whether a file of `images/` is whole, as far as the file itself tells.
pub(super) fn is_whole(path: &Path) -> bool {
    match path.extension().is_some_and(|extension| extension == "exr") {
        true => exr::check_whole(path).is_ok(),
        false => std::fs::metadata(path).is_ok_and(|metadata| metadata.len() > 0),
    }
}

/// The names in `images.csv`, in the order of its columns.
fn index_names(plan: &Plan, cell: &Cell) -> [String; 5] {
    let [radiance, reference] = linear_files(plan, cell);
    [radiance, reference, picture_name(cell), reference_picture_name(plan, cell), error_name(cell)]
}

/// Files of finished cells that are missing or not what the cells' records say, in the order of their names. Each cell comes with the
/// [`hashes`] of its record; where that has none, a file need only be whole.
pub(super) fn damaged<'p>(
    plan: &Plan,
    store: &Store,
    cells: impl Iterator<Item = (&'p Cell, &'p [Option<Hash>])>,
) -> BTreeSet<String> {
    // What cells share must be what each of them says.
    let mut said: BTreeMap<String, HashSet<Hash>> = BTreeMap::new();
    for (cell, hashes) in cells {
        for (name, hash) in files(plan, cell).into_iter().zip(hashes) {
            said.entry(name).or_default().extend(hash);
        }
    }
    let is_sound = |name: &str, hashes: &HashSet<Hash>| {
        let path = store.image_path(name);
        match hashes.is_empty() {
            true => is_whole(&path),
            false => content_hash(&path).is_ok_and(|found| hashes.iter().all(|hash| *hash.to_hex() == *found)),
        }
    };
    said.into_par_iter().filter(|(name, hashes)| !is_sound(name, hashes)).map(|(name, _)| name).collect()
}

/// `images.csv`: which files of `images/` belong to a cell. One row a finished cell.
pub fn index(plan: &Plan, results: &Results) -> Rows {
    let columns =
        ["cell", "radiance", "reference", "picture", "reference_picture", "error"].map(str::to_owned).to_vec();
    let is_done = |cell: &&Cell| matches!(results.get(&cell.id), Some(CellResult::Done(_)));
    let row = |cell: &Cell| {
        std::iter::once(Field::from(cell.id.as_str())).chain(index_names(plan, cell).map(Field::Text)).collect()
    };
    (columns, plan.cells.iter().filter(is_done).map(row).collect())
}
