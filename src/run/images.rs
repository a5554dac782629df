//! The images of a run (linear EXR, tone-mapped PNG, error maps) and their file names.

use super::columns::{CELL, Columns, ImageColumns};
use super::results::Results;
use super::run_table::RunTable;
use super::store::Store;
use crate::base::csv::Cell as Field;
use crate::base::files::content_hash;
use crate::base::numbers::short_number;
use crate::base::pixels::{PixelsError, exr};
use crate::experiment::axis::{
    ALPHA, AXES, Axis, AxisId, BRDF, DIFFUSE_METHOD, ENVIRONMENT, METHOD, Named, Point, SAMPLES,
    SCENE,
};
use crate::experiment::{Cell, Id, Plan};
use crate::instrument::environment::BUILTIN_PREFIX;
use crate::instrument::pipeline::Frame;
use blake3::Hash;
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::Path;

/// The layer of a reference that holds its standard error.
pub const STANDARD_ERROR_LAYER: &str = "standard_error";
/// The layer of an unscored image that holds n·v, in [0, 1], in each of three channels.
pub const N_DOT_V_LAYER: &str = "n_dot_v";
/// Longest beginning of a file name; the id follows.
const SLUG_LENGTH: usize = 120;

/// A value for people: builtins without prefix, files without folder and extension, numbers with
/// few digits.
pub fn short_text(named: Named, point: &Point) -> String {
    short_value(named.entry(), &named.shown(&point[named.axis]).to_string()).into_owned()
}

/// As [`short_text`], for a value from a table.
pub fn short_value<'v>(axis: &Axis, text: &'v str) -> Cow<'v, str> {
    let Some(path) = axis.kind.path_in(text) else {
        return short_number(text);
    };
    if let Some(formula) = text.strip_prefix(BUILTIN_PREFIX) {
        return formula.into();
    }
    let stem = Path::new(path).file_stem();
    stem.map_or(text.into(), |stem| stem.to_string_lossy())
}

/// The axes whose values begin a file name. They are the same in every plan, so that a larger plan
/// finds the files of a smaller one.
const NAMING: [AxisId; 7] = [
    ENVIRONMENT,
    SCENE,
    BRDF,
    ALPHA,
    METHOD,
    DIFFUSE_METHOD,
    SAMPLES,
];

fn slug(point: &Point) -> String {
    let words: Vec<String> = NAMING
        .iter()
        .map(|&axis| short_text(Named::primary(axis), point))
        .filter(|word| !word.is_empty())
        .collect();
    file_words(&words.join("_"))
}

/// Makes a text safe as part of a file name: no leading `-` or `.` unless it is a number, nothing
/// that a shell interprets.
pub fn file_words(text: &str) -> String {
    let is_number = text
        .strip_prefix('-')
        .is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
    let plain = |(index, c): (usize, char)| match c {
        '-' | '.' if index == 0 && !is_number => '_',
        c if c.is_ascii_alphanumeric() || "-_.".contains(c) => c,
        _ if index == 0 => '_',
        _ => '-',
    };
    text.chars()
        .enumerate()
        .map(plain)
        .take(SLUG_LENGTH)
        .collect()
}

pub fn radiance_name(point: &Point, id: Id) -> String {
    format!("{}.{id}.exr", slug(point))
}

pub fn picture_name(cell: &Cell) -> String {
    format!("{}.{}.png", slug(&cell.point), cell.id)
}

/// Shared by cells that differ only in the tone curve.
pub fn error_name(cell: &Cell) -> String {
    format!("{}.{}.error.png", slug(&cell.point), cell.radiance)
}

pub fn flip_name(cell: &Cell) -> String {
    format!("{}.{}.flip.png", slug(&cell.point), cell.id)
}

/// `None` without references.
pub fn reference_picture_name(plan: &Plan, cell: &Cell) -> Option<String> {
    let point = plan.judge_of(cell)?;
    let id = cell.reference?;
    let display = AXES
        .iter()
        .zip(point.values())
        .filter(|(axis, _)| !axis.changes_radiance());
    let display: Vec<String> = display
        .map(|(axis, value)| format!("{}{value}", axis.name))
        .collect();
    Some(format!("{}.{}.{id}.png", slug(&point), display.join("-")))
}

/// Writes linear RGBA (A is the mask); for a reference also its standard error, as a layer.
pub fn write_radiance(path: &Path, frame: &Frame) -> Result<(), PixelsError> {
    let layers: Vec<_> = frame
        .standard_error
        .iter()
        .map(|image| (STANDARD_ERROR_LAYER, image))
        .collect();
    exr::write_rgba(path, &frame.radiance, &frame.mask, &layers)
}

/// Writes the linear RGBA of a cell without reference, with its n·v as a layer: fits weigh or select
/// pixels by it.
pub fn write_unscored(path: &Path, frame: &Frame) -> Result<(), PixelsError> {
    let n_dot_v = frame.n_dot_v.map(|cosine| [cosine; 3]);
    let mut layers = vec![(N_DOT_V_LAYER, &n_dot_v)];
    layers.extend(
        frame
            .standard_error
            .iter()
            .map(|image| (STANDARD_ERROR_LAYER, image)),
    );
    exr::write_rgba(path, &frame.radiance, &frame.mask, &layers)
}

/// Whether the tone curve is swept: then each cell has its own map of visible differences.
pub fn sweeps_display(plan: &Plan) -> bool {
    plan.swept().any(|axis| !AXES[axis].changes_radiance())
}

/// All files of a finished cell in `images/`.
pub(super) fn files(plan: &Plan, cell: &Cell) -> Vec<String> {
    let names = index_names(plan, cell);
    let mut files = vec![names.radiance, names.picture];
    files.extend(
        [names.reference, names.reference_picture, names.error]
            .into_iter()
            .flatten(),
    );
    if cell.reference.is_some() && sweeps_display(plan) {
        files.push(flip_name(cell));
    }
    files
}

/// File name of the linear image of a cell.
pub fn linear_file(cell: &Cell) -> String {
    radiance_name(&cell.point, cell.radiance)
}

/// File name of the linear image of a cell's reference; `None` without references.
pub fn reference_file(plan: &Plan, cell: &Cell) -> Option<String> {
    let id = cell.reference?;
    Some(radiance_name(&plan.judge_of(cell)?, id))
}

/// The names in `images.csv`.
fn index_names(plan: &Plan, cell: &Cell) -> ImageColumns {
    let reference = reference_file(plan, cell);
    ImageColumns {
        radiance: linear_file(cell),
        error: reference.is_some().then(|| error_name(cell)),
        reference,
        picture: picture_name(cell),
        reference_picture: reference_picture_name(plan, cell),
    }
}

/// The content hashes that the records of finished cells name for each file.
pub(super) type Recorded = BTreeMap<String, HashSet<Hash>>;

/// Notes the files of a finished cell with the hashes in its record.
pub(super) fn note(
    recorded: &mut Recorded,
    plan: &Plan,
    cell: &Cell,
    hashes: &BTreeMap<String, String>,
) {
    for name in files(plan, cell) {
        // A missing or invalid hash fits no file.
        let hash = hashes.get(&name).and_then(|hex| Hash::from_hex(hex).ok());
        let hash = hash.unwrap_or(Hash::from_bytes([0; blake3::OUT_LEN]));
        recorded.entry(name).or_default().insert(hash);
    }
}

/// Files that are missing or differ from their records, by name.
pub(super) fn damaged(store: &Store, recorded: Recorded) -> BTreeSet<String> {
    let is_sound = |name: &str, hashes: &HashSet<Hash>| {
        let found = content_hash(&store.image_path(name));
        found.is_ok_and(|found| hashes.iter().all(|hash| *hash.to_hex() == *found))
    };
    recorded
        .into_par_iter()
        .filter(|(name, hashes)| !is_sound(name, hashes))
        .map(|(name, _)| name)
        .collect()
}

/// `images.csv`: the files of each finished cell.
pub fn index(plan: &Plan, results: &Results) -> RunTable<Vec<Vec<Field>>> {
    let columns = std::iter::once(CELL.name.to_owned());
    let done = plan.cells.iter().filter(|cell| results.is_done(cell));
    let rows = done.map(|cell| {
        let mut row = vec![Field::from(cell.id.to_string())];
        row.extend(index_names(plan, cell).fields());
        row
    });
    RunTable {
        columns: columns.chain(ImageColumns::names()).collect(),
        rows: rows.collect(),
    }
}
