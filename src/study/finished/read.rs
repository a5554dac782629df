//! A finished run from the files of its folder, published or not. The tables are parsed here and nowhere else.

use super::{Bin, CellImages, Finished, FinishedCell, Light, MetricValues, StepRow, Stop, point_of};
use crate::files::read_regular;
use crate::metrics::BiasVariance;
use crate::runner::config::Config;
use crate::runner::environments::{LUMINANCE_COLUMNS, RANGE_COLUMN};
use crate::runner::fault::Faults;
use crate::runner::frozen::EXPERIMENT_FILE;
use crate::runner::provenance::{self, PROVENANCE_FILE, ProvenanceError};
use crate::runner::store::{StopReason, Store, StoreError, TIMINGS_FOLDER};
use crate::runner::tables::{HEADLINE, REFERENCE_COLUMNS};
use crate::spelling::printable;
use crate::table::csv::{Table, TableError};
use serde_json::Value as Json;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Why a folder cannot be reported.
#[derive(Debug, thiserror::Error)]
pub enum FinishedError {
    #[error("{}: is a file; expected the folder of a run of `splitsum run`", dir.display())]
    NotAFolder { dir: PathBuf },
    #[error("{}: has no {file}; expected the folder of a run of `splitsum run`", dir.display())]
    NotARun { dir: PathBuf, file: &'static str },
    #[error("{}: the run was stopped before its first table; to go on run the same command again: {command}", dir.display())]
    Unfinished { dir: PathBuf, command: String },
    #[error("{}: a run is under way in it and has written no table yet; expected one a few seconds after its first cell", dir.display())]
    NoTableYet { dir: PathBuf },
    #[error(transparent)]
    Provenance(#[from] ProvenanceError),
    #[error("{}: {error}", path.display())]
    Io { path: PathBuf, error: std::io::Error },
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error("{}: {what}; expected the table as `splitsum run` wrote it, which writes it anew from its records", path.display())]
    Damaged { path: PathBuf, what: String },
}

impl Finished {
    /// Reads everything but the images themselves. Tables that were emptied or cut off are refused: their answers would be wrong, and
    /// would replace right ones.
    pub fn read(dir: &Path) -> Result<Self, FinishedError> {
        // Asked first: a run that ends meanwhile leaves a whole folder.
        let is_under_way = Store::at(dir).is_under_way();
        let provenance = provenance(dir)?;
        let table = |name: &str| {
            let path = dir.join(name);
            path.exists().then(|| Table::read(&path)).transpose()
        };
        let errors = table("errors.csv")?.ok_or_else(|| match is_under_way {
            true => FinishedError::NoTableYet { dir: dir.to_owned() },
            false => unfinished(dir, &provenance),
        })?;
        let bins = table("errors_by_n_dot_v.csv")?;
        check_errors(dir, &provenance, &errors, bins.as_ref(), is_under_way)?;
        let experiment = text(&dir.join(EXPERIMENT_FILE))?.unwrap_or_default();
        let images = table("images.csv")?.map_or_else(|| Ok(BTreeMap::new()), |table| images(&table))?;
        Ok(Self {
            config: config(&experiment, &provenance),
            cells: cells(&errors, bins.as_ref(), table("steps.csv")?.as_ref(), &images),
            lights: table("environments.csv")?.map(|table| lights(&table)).unwrap_or_default(),
            timings: of_store(dir, TIMINGS_FOLDER, Store::timing)?,
            failures: of_store(dir, "failed", Store::failure)?,
            provenance,
            experiment,
            is_under_way,
            dir: dir.to_owned(),
        })
    }
}

/// Text fields of one row by column name.
struct Fields<'t> {
    table: &'t Table,
    row: &'t [String],
}

impl Fields<'_> {
    fn text(&self, name: &str) -> Option<String> {
        let column = self.table.columns.iter().position(|column| column == name)?;
        Some(self.row[column].clone()).filter(|text| !text.is_empty())
    }

    fn number(&self, name: &str) -> Option<f64> {
        self.text(name)?.parse().ok()
    }

    fn metrics(&self, suffix: &str) -> MetricValues {
        MetricValues::of(|name| self.number(&format!("{name}{suffix}")))
    }
}

fn rows(table: &Table) -> impl Iterator<Item = Fields<'_>> {
    table.rows.iter().map(move |row| Fields { table, row })
}

fn cells(
    errors: &Table,
    bins: Option<&Table>,
    steps: Option<&Table>,
    images: &BTreeMap<String, CellImages>,
) -> Vec<FinishedCell> {
    let mut steps_of: BTreeMap<String, Vec<StepRow>> = BTreeMap::new();
    for fields in steps.into_iter().flat_map(rows) {
        if let (Some(cell), Some(step)) = (fields.text("cell"), step(&fields)) {
            steps_of.entry(cell).or_default().push(step);
        }
    }
    let mut bins_of: BTreeMap<String, Vec<Bin>> = BTreeMap::new();
    for fields in bins.into_iter().flat_map(rows) {
        let numbers = ["n_dot_v_from", "n_dot_v_to", "pixel_count"].map(|name| fields.number(name));
        if let (Some(cell), [Some(lo), Some(hi), Some(count)]) = (fields.text("cell"), numbers) {
            let bin = Bin { lo, hi, pixel_count: count as u64, scores: fields.metrics("") };
            bins_of.entry(cell).or_default().push(bin);
        }
    }
    let cell = |fields: Fields| {
        let id = fields.text("cell").unwrap_or_default();
        let [variance, bias] = BiasVariance::RELATIVE_NAMES.map(|name| fields.number(name));
        let is_failed = fields.text("verdict").as_deref() == Some("failed");
        FinishedCell {
            point: point_of(|name| fields.text(name)),
            scores: (!is_failed).then(|| fields.metrics("")),
            noise_floors: fields.metrics("_noise_floor"),
            bias_variance: bias.zip(variance).map(|(bias, variance)| [bias, variance]),
            reference: stop(&fields),
            bins: bins_of.remove(&id).unwrap_or_default(),
            steps: steps_of.remove(&id).unwrap_or_default(),
            images: images.get(&id).cloned(),
            id,
        }
    };
    rows(errors).map(cell).collect()
}

fn step(fields: &Fields) -> Option<StepRow> {
    Some(StepRow {
        seen: [fields.number("n_dot_v_from")?, fields.number("n_dot_v_to")?],
        step: fields.text("step")?,
        share: fields.number("share")?,
        rung_error: fields.number("rung_error")?,
        first_in: fields.number("first_in")?,
        last_out: fields.number("last_out")?,
        shapley: fields.number("shapley")?,
        noise: fields.number("noise")?,
    })
}

fn stop(fields: &Fields) -> Option<Stop> {
    let [samples, error, by] = REFERENCE_COLUMNS;
    let reasons = [StopReason::Samples, StopReason::RelativeError];
    let by = fields.text(by)?;
    Some(Stop {
        samples: fields.number(samples)? as u64,
        relative_error: fields.number(error)?,
        stopped_by: reasons.into_iter().find(|reason| reason.name() == by)?,
    })
}

fn lights(table: &Table) -> Vec<Light> {
    let light = |fields: Fields| {
        Some(Light {
            environment: fields.text("environment")?,
            clip_log2: fields.text("environment_clip_log2").unwrap_or_default(),
            mean: fields.number(LUMINANCE_COLUMNS[0])?,
            peak: fields.number(LUMINANCE_COLUMNS[1])?,
            range_stops: fields.number(RANGE_COLUMN),
        })
    };
    rows(table).filter_map(light).collect()
}

/// The frozen experiment, where this program still understands it.
fn config(experiment: &str, provenance: &Json) -> Option<Config> {
    let overrides = provenance["overrides"].as_array().into_iter().flatten();
    let overrides: Vec<String> = overrides.filter_map(|text| Some(text.as_str()?.to_owned())).collect();
    let path = Path::new(EXPERIMENT_FILE);
    let mut faults = Faults::new(path, experiment);
    let config = Config::parse(path, experiment, &overrides, &mut faults);
    faults.is_empty().then_some(config)
}

/// A run that left no table, with the command that makes one.
fn unfinished(dir: &Path, provenance: &Json) -> FinishedError {
    match last_command(provenance) {
        Some(command) => FinishedError::Unfinished { dir: dir.to_owned(), command },
        None => FinishedError::NotARun { dir: dir.to_owned(), file: "errors.csv" },
    }
}

/// What the user typed last to work on the run.
pub(super) fn last_command(provenance: &Json) -> Option<String> {
    let words = provenance["sessions"].as_array()?.last()?["command_line"].as_array()?;
    let words: Vec<&str> = words.iter().filter_map(serde_json::Value::as_str).collect();
    Some(words.join(" ")).filter(|command| !command.is_empty())
}

/// `provenance.json` of a run, published or not.
pub fn provenance(dir: &Path) -> Result<Json, FinishedError> {
    if dir.is_file() {
        return Err(FinishedError::NotAFolder { dir: dir.to_owned() });
    }
    provenance::read(dir)?.ok_or_else(|| FinishedError::NotARun { dir: dir.to_owned(), file: PROVENANCE_FILE })
}

fn images(table: &Table) -> Result<BTreeMap<String, CellImages>, FinishedError> {
    let [cell, radiance, reference] = [table.column("cell")?, table.column("radiance")?, table.column("reference")?];
    // Joined to the folder's path, and linked from a page: nothing but a name may get that far.
    let is_name =
        |text: &str| !text.contains(['/', '\\', ':']) && ![".", ".."].contains(&text) && printable(text) == text;
    let file = |text: &String| match is_name(text) {
        true => Ok(text.clone()),
        false => Err(FinishedError::Damaged {
            path: table.path().to_owned(),
            what: format!("{text:?} is not the name of an image"),
        }),
    };
    let entry = |row: &Vec<String>| {
        let images = CellImages { radiance: file(&row[radiance])?, reference: file(&row[reference])? };
        Ok((row[cell].clone(), images))
    };
    table.rows.iter().map(entry).collect()
}

/// Whether the tables of errors are whole: their columns, their numbers, each cell once, and, unless a run is adding to them, no fewer cells
/// than the folder has records of.
fn check_errors(
    dir: &Path,
    provenance: &Json,
    errors: &Table,
    bins: Option<&Table>,
    is_under_way: bool,
) -> Result<(), FinishedError> {
    let damaged = |what: String| Err(FinishedError::Damaged { path: errors.path().to_owned(), what });
    if let Some(table) = [Some(errors), bins].into_iter().flatten().find(|table| table.columns.is_empty()) {
        return Err(FinishedError::Damaged { path: table.path().to_owned(), what: "the file is empty".to_owned() });
    }
    let cell = errors.column("cell")?;
    let verdict = errors.column("verdict")?;
    let scores = errors.numbers(HEADLINE)?;
    let ids: BTreeSet<&str> = errors.rows.iter().map(|row| row[cell].as_str()).collect();
    if ids.len() < errors.rows.len() {
        return damaged(format!("{} rows of {} cells", errors.rows.len(), ids.len()));
    }
    if is_under_way {
        return Ok(());
    }
    // Records that cannot be read are none, but are only looked at where there seem to be too many.
    let store = Store::at(dir);
    let records: BTreeSet<String> = ["cells", "failed"].into_iter().flat_map(|folder| store.ids(folder)).collect();
    let is_record = |id: &&String| matches!(store.cell(id), Ok(Some(_))) || matches!(store.failure(id), Ok(Some(_)));
    let rows = errors.rows.len();
    let records = if rows < records.len() { records.iter().filter(is_record).count() } else { records.len() };
    if rows < records {
        return damaged(format!("{rows} rows, but the folder has records of {records} cells: it is cut off"));
    }
    // A published folder has no records. A run that was stopped before its first cell has no session that did work.
    let has_worked = provenance["sessions"].as_array().is_some_and(|sessions| !sessions.is_empty());
    if rows == 0 && records == 0 && has_worked && !dir.join("cells").is_dir() && provenance["cell_count"] != 0 {
        return damaged("no rows".to_owned());
    }
    let Some(bins) = bins else { return Ok(()) };
    bins.numbers(HEADLINE)?;
    let bin_cell = bins.column("cell")?;
    let binned: BTreeSet<&str> = bins.rows.iter().map(|row| row[bin_cell].as_str()).collect();
    let is_scored =
        |(row, score): &(&Vec<String>, &Option<f64>)| score.is_some_and(f64::is_finite) && row[verdict] != "failed";
    let mut scored = errors.rows.iter().zip(&scores).filter(is_scored).map(|(row, _)| row[cell].as_str());
    match scored.find(|id| !binned.contains(id)) {
        Some(id) => Err(FinishedError::Damaged {
            path: bins.path().to_owned(),
            what: format!("no row of cell {id}, which {} has", errors.path().display()),
        }),
        None => Ok(()),
    }
}

/// Largest file of a run that is read, bytes.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// The text of a file, or `None` when it does not exist.
pub(super) fn text(path: &Path) -> Result<Option<String>, FinishedError> {
    match read_regular(path, MAX_FILE_BYTES).and_then(|bytes| String::from_utf8(bytes).map_err(std::io::Error::other)) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(FinishedError::Io { path: path.to_owned(), error }),
    }
}

/// The records of a folder, by file name. One that is damaged or another's, under a name of its own, is none, as for the run itself.
fn of_store<T>(
    dir: &Path,
    folder: &str,
    read: fn(&Store, &str) -> Result<Option<T>, StoreError>,
) -> Result<Vec<T>, FinishedError> {
    let store = Store::at(dir);
    store.ids(folder).iter().filter_map(|id| read(&store, id).map_err(FinishedError::from).transpose()).collect()
}
