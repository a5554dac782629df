//! Reading the folder of a finished run: only its files, so that a report needs neither the device nor the inputs.

use crate::files::read_regular;
use crate::runner::config::Config;
use crate::runner::fault::Faults;
use crate::runner::frozen::EXPERIMENT_FILE;
use crate::runner::provenance::{self, PROVENANCE_FILE, ProvenanceError};
use crate::runner::store::{FailureRecord, Store, StoreError, TIMINGS_FOLDER};
use crate::runner::tables::HEADLINE;
use crate::runner::timing::TimingRecord;
use crate::slips;
use crate::spelling::printable;
use crate::table::csv::{Table, TableError};
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Why a folder cannot be reported.
#[derive(Debug, thiserror::Error)]
pub enum RunFolderError {
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
    #[error("{}: {error}; expected a file that `splitsum run` wrote", path.display())]
    Json { path: PathBuf, error: serde_json::Error },
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error("{}: {what}; expected the table as `splitsum run` wrote it, which writes it anew from its records", path.display())]
    Damaged { path: PathBuf, what: String },
}

/// The files of `images/` that belong to a cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellImages {
    /// Linear EXR of the cell.
    pub radiance: String,
    /// Linear EXR of its reference.
    pub reference: String,
}

/// A finished run as its files tell it.
#[derive(Debug)]
pub struct RunFolder {
    pub dir: PathBuf,
    /// `provenance.json`, shown whole and searched by [`RunFolder::text`].
    pub provenance: serde_json::Value,
    /// The frozen experiment file.
    pub experiment: String,
    /// What it says, with the overrides of the run; `None` where this program does not understand it.
    pub config: Option<Config>,
    pub errors: Table,
    /// By `n_dot_v`; `None` for a run that has no such table.
    pub bins: Option<Table>,
    /// What the light is like; `None` for a run that has no such table.
    pub environments: Option<Table>,
    /// What each slip of the source documents costs, where the experiment asks for it.
    pub slips: Option<Table>,
    pub timings: Vec<TimingRecord>,
    pub failures: Vec<FailureRecord>,
    /// Whether a run is at work in the folder, so that the tables hold only the cells that are done.
    pub is_under_way: bool,
    /// By cell; empty for runs older than `images.csv`.
    pub images: BTreeMap<String, CellImages>,
    /// Name and text of each CSV file, as it stands.
    pub csv: Vec<(&'static str, String)>,
}

/// The tables of a run that a report embeds.
const CSV_FILES: [&str; 3] = ["errors.csv", "errors_by_n_dot_v.csv", "timings.csv"];

impl RunFolder {
    /// Reads everything but the images themselves. Tables that were emptied or cut off are refused: their answers would be wrong, and would
    /// replace right ones.
    pub fn read(dir: &Path) -> Result<Self, RunFolderError> {
        // Asked first: what a run that ends meanwhile leaves is whole.
        let is_under_way = Store::at(dir).is_under_way();
        let provenance = provenance(dir)?;
        let table = |name: &str| {
            let path = dir.join(name);
            path.exists().then(|| Table::read(&path)).transpose()
        };
        let errors = table("errors.csv")?.ok_or_else(|| match is_under_way {
            true => RunFolderError::NoTableYet { dir: dir.to_owned() },
            false => unfinished(dir, &provenance),
        })?;
        let bins = table("errors_by_n_dot_v.csv")?;
        check_errors(dir, &provenance, &errors, bins.as_ref(), is_under_way)?;
        let csv = CSV_FILES.iter().filter_map(|&name| text(&dir.join(name)).transpose().map(|t| Ok((name, t?))));
        let experiment = text(&dir.join(EXPERIMENT_FILE))?.unwrap_or_default();
        Ok(Self {
            config: config(&experiment, &provenance),
            provenance,
            experiment,
            bins,
            environments: table("environments.csv")?,
            slips: table(slips::FILE_NAME)?,
            timings: timings(dir)?,
            failures: records(&dir.join("failed"))?,
            images: table("images.csv")?.map_or_else(|| Ok(BTreeMap::new()), |table| images(&table))?,
            csv: csv.collect::<Result<_, RunFolderError>>()?,
            errors,
            is_under_way,
            dir: dir.to_owned(),
        })
    }

    /// What to tell of a run that is under way: how many of its cells the tables hold.
    pub fn under_way_note(&self) -> Option<String> {
        let planned = self.provenance["cell_count"].as_u64().filter(|_| self.is_under_way)?;
        Some(format!("{}: under way: {} of {planned} cells", self.dir.display(), self.errors.rows.len()))
    }

    /// A text of the provenance by JSON pointer; empty when it is not there.
    pub fn text(&self, pointer: &str) -> String {
        match self.provenance.pointer(pointer) {
            Some(serde_json::Value::String(text)) => text.clone(),
            Some(serde_json::Value::Null) | None => String::new(),
            Some(value) => value.to_string(),
        }
    }

    /// Cells of `errors.csv` without scores.
    pub fn failed_count(&self) -> usize {
        let verdict = self.errors.columns.iter().position(|name| name == "verdict");
        self.errors.rows.iter().filter(|row| verdict.is_some_and(|column| row[column] == "failed")).count()
    }

    /// Every device that did work, with its driver, each once.
    pub fn devices(&self) -> Vec<String> {
        let mut devices: Vec<String> = Vec::new();
        for session in 0..self.provenance["sessions"].as_array().map_or(0, Vec::len) {
            let text = |name: &str| self.text(&format!("/sessions/{session}/device/{name}"));
            let device = format!("{} ({})", text("name"), text("driver"));
            if !devices.contains(&device) {
                devices.push(device);
            }
        }
        devices
    }

    /// The last invocation that did work, as a JSON pointer prefix.
    pub fn last_session(&self) -> String {
        let count = self.provenance["sessions"].as_array().map_or(0, Vec::len);
        format!("/sessions/{}", count.saturating_sub(1))
    }

    /// Whether any of its times, or the run itself, comes from a driver that computes on the CPU.
    pub fn is_cpu_timed(&self) -> bool {
        self.timings.iter().any(|record| record.device_type == "cpu")
    }
}

fn config(experiment: &str, provenance: &serde_json::Value) -> Option<Config> {
    let overrides = provenance["overrides"].as_array().into_iter().flatten();
    let overrides: Vec<String> = overrides.filter_map(|text| Some(text.as_str()?.to_owned())).collect();
    let path = Path::new(EXPERIMENT_FILE);
    let mut faults = Faults::new(path, experiment);
    let config = Config::parse(path, experiment, &overrides, &mut faults);
    faults.is_empty().then_some(config)
}

/// A run that left no table, with the command that makes one.
fn unfinished(dir: &Path, provenance: &serde_json::Value) -> RunFolderError {
    match last_command(provenance) {
        Some(command) => RunFolderError::Unfinished { dir: dir.to_owned(), command },
        None => RunFolderError::NotARun { dir: dir.to_owned(), file: "errors.csv" },
    }
}

/// What the user typed last to work on the run.
fn last_command(provenance: &serde_json::Value) -> Option<String> {
    let words = provenance["sessions"].as_array()?.last()?["command_line"].as_array()?;
    let words: Vec<&str> = words.iter().filter_map(serde_json::Value::as_str).collect();
    Some(words.join(" ")).filter(|command| !command.is_empty())
}

/// `provenance.json` of a run, published or not.
pub(super) fn provenance(dir: &Path) -> Result<serde_json::Value, RunFolderError> {
    if dir.is_file() {
        return Err(RunFolderError::NotAFolder { dir: dir.to_owned() });
    }
    provenance::read(dir)?.ok_or_else(|| RunFolderError::NotARun { dir: dir.to_owned(), file: PROVENANCE_FILE })
}

/// A sentence when cells of the run in `dir` were not tried yet: it was stopped or killed. Nothing for the files of a published run, nor
/// for a run that is under way ([`RunFolder::under_way_note`]).
pub fn unfinished_note(dir: &Path) -> Option<String> {
    let provenance = provenance::read(dir).ok()??;
    let planned = provenance["cell_count"].as_u64()?;
    let count = |folder: &str| std::fs::read_dir(dir.join(folder)).map(|entries| entries.count() as u64);
    let (done, tried) = (count("cells").ok()?, count("cells").ok()? + count("failed").unwrap_or(0));
    let command = last_command(&provenance)?;
    (tried < planned && !Store::at(dir).is_under_way()).then(|| {
        let dir = dir.display();
        format!("{dir}: {done} of {planned} cells are done; to go on run the same command again: {command}")
    })
}

/// A sentence when the frozen experiment file is not the one that the provenance names, by its hash.
pub fn experiment_note(dir: &Path) -> Option<String> {
    let provenance = provenance::read(dir).ok()??;
    let named = provenance["experiment_hash"].as_str()?;
    let path = dir.join(EXPERIMENT_FILE);
    let what = match text(&path) {
        Ok(Some(text)) if provenance::experiment_hash(&text) == named => return None,
        Ok(None) => "is missing",
        _ => "is not the experiment that was run: it was changed or damaged since",
    };
    Some(format!("{}: {what}; the same `splitsum run` again writes it anew", path.display()))
}

/// A sentence when timing records of the run are damaged or others' under their names: they do not count.
pub fn timings_note(dir: &Path) -> Option<String> {
    let store = Store::at(dir);
    let ids = store.ids(TIMINGS_FOLDER);
    let unusable: Vec<&String> = ids.iter().filter(|id| !store.has_timing(id)).collect();
    let first = unusable.first()?;
    Some(format!(
        "{}: {} of {} timing records are damaged or another's and do not count, the first {first}.json; the same `splitsum run` again \
         times them anew",
        dir.join(TIMINGS_FOLDER).display(),
        unusable.len(),
        ids.len()
    ))
}

/// Whatever is odd about the run in `dir` that does not keep it from being read.
pub fn notes(dir: &Path) -> impl Iterator<Item = String> {
    [unfinished_note(dir), experiment_note(dir), timings_note(dir)].into_iter().flatten()
}

fn images(table: &Table) -> Result<BTreeMap<String, CellImages>, RunFolderError> {
    let [cell, radiance, reference] = [table.column("cell")?, table.column("radiance")?, table.column("reference")?];
    // Joined to the folder's path, and linked from a page: nothing but a name may get that far.
    let is_name =
        |text: &str| !text.contains(['/', '\\', ':']) && ![".", ".."].contains(&text) && printable(text) == text;
    let file = |text: &String| match is_name(text) {
        true => Ok(text.clone()),
        false => Err(RunFolderError::Damaged {
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
    provenance: &serde_json::Value,
    errors: &Table,
    bins: Option<&Table>,
    is_under_way: bool,
) -> Result<(), RunFolderError> {
    let damaged = |what: String| Err(RunFolderError::Damaged { path: errors.path().to_owned(), what });
    if let Some(table) = [Some(errors), bins].into_iter().flatten().find(|table| table.columns.is_empty()) {
        return Err(RunFolderError::Damaged { path: table.path().to_owned(), what: "the file is empty".to_owned() });
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
    let records: BTreeSet<String> = ["cells", "failed"].iter().flat_map(|name| record_names(&dir.join(name))).collect();
    // Records that cannot be read are none, but are only looked at where there seem to be too many.
    let store = Store::at(dir);
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
        Some(id) => Err(RunFolderError::Damaged {
            path: bins.path().to_owned(),
            what: format!("no row of cell {id}, which {} has", errors.path().display()),
        }),
        None => Ok(()),
    }
}

/// Names of the records in a folder; none where it does not exist.
fn record_names(dir: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(dir).into_iter().flatten().flatten();
    entries.filter_map(|entry| Some(entry.file_name().to_string_lossy().strip_suffix(".json")?.to_owned())).collect()
}

/// Largest file of a run that is read, bytes.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// The text of a file, or `None` when it does not exist.
fn text(path: &Path) -> Result<Option<String>, RunFolderError> {
    match read_regular(path, MAX_FILE_BYTES).and_then(|bytes| String::from_utf8(bytes).map_err(std::io::Error::other)) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(RunFolderError::Io { path: path.to_owned(), error }),
    }
}

fn json<T: DeserializeOwned>(path: &Path) -> Result<Option<T>, RunFolderError> {
    let parse = |text: String| {
        serde_json::from_str(&text).map_err(|error| RunFolderError::Json { path: path.to_owned(), error })
    };
    text(path)?.map(parse).transpose()
}

/// The timing records of a run, by file name. One that is damaged or another's, under a name of its own, is none, as for the run itself.
fn timings(dir: &Path) -> Result<Vec<TimingRecord>, RunFolderError> {
    let store = Store::at(dir);
    let read = |id: &String| store.timing(id).map_err(RunFolderError::from).transpose();
    store.ids(TIMINGS_FOLDER).iter().filter_map(read).collect()
}

/// Every JSON record of a folder, by file name.
fn records<T: DeserializeOwned>(dir: &Path) -> Result<Vec<T>, RunFolderError> {
    let mut paths: Vec<PathBuf> = match std::fs::read_dir(dir) {
        Ok(entries) => entries.flatten().map(|entry| entry.path()).collect(),
        Err(_) => Vec::new(),
    };
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "json"));
    paths.sort();
    paths.iter().filter_map(|path| json(path).transpose()).collect()
}
