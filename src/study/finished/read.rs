//! Reads a finished run from its folder, published or not.

use super::{
    Bin, BinRange, Bins, CellImages, Finished, FinishedCell, Light, MetricValues, RecoveredRow,
    StepRow, point_of,
};
use crate::base::csv::{Row, TableError, TableRows};
use crate::base::files::read_regular;
use crate::base::names::{Listed, printable};
use crate::experiment::axis::Points;
use crate::experiment::config::Config;
use crate::experiment::fault::Faults;
use crate::experiment::id::Id;
use crate::experiment::inputs::load_methods;
use crate::instrument::metrics::Weight;
use crate::run::columns::{FAILED, UNSCORED};
use crate::run::frozen::EXPERIMENT_FILE;
use crate::run::provenance::{self, PROVENANCE_FILE, Provenance, ProvenanceError};
use crate::run::recovery::RECOVERY_FILE;
use crate::run::store::{
    CELLS_FOLDER, Exact, FAILED_FOLDER, ReferenceStop, StopReason, Store, StoreError,
    TIMINGS_FOLDER,
};
use crate::run::tables::HEADLINE;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Debug, thiserror::Error)]
pub enum FinishedError {
    #[error("{}: is a file; expected the folder of a run of `splitsum run`", dir.display())]
    NotAFolder { dir: PathBuf },
    #[error("{}: has no {file}; expected the folder of a run of `splitsum run`", dir.display())]
    NotARun { dir: PathBuf, file: &'static str },
    #[error("{}: the run was stopped before its first table; to continue, run: {command}", dir.display())]
    Unfinished { dir: PathBuf, command: String },
    #[error("{}: a run is using the folder; wait until it ends, or stop it: it can be resumed", dir.display())]
    UnderWay { dir: PathBuf },
    #[error(transparent)]
    Provenance(#[from] ProvenanceError),
    #[error("{}: {error}", path.display())]
    Io {
        path: PathBuf,
        error: std::io::Error,
    },
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error("{}: {what}; repeat `splitsum run` to regenerate the table from its records", path.display())]
    Damaged { path: PathBuf, what: String },
}

impl Finished {
    /// Reads everything but the images. Empty or truncated tables are refused: their answers would
    /// be wrong.
    pub fn read(dir: &Path) -> Result<Self, FinishedError> {
        let provenance = provenance(dir)?;
        if Store::read_only(dir).is_under_way() {
            return Err(FinishedError::UnderWay {
                dir: dir.to_owned(),
            });
        }
        let table = |name: &str| {
            let path = dir.join(name);
            path.exists().then(|| TableRows::open(&path)).transpose()
        };
        let mut errors = table("errors.csv")?.ok_or_else(|| unfinished(dir, &provenance))?;
        let mut images = table("images.csv")?.map_or_else(|| Ok(HashMap::new()), images)?;
        let mut cells = cells(&mut errors, &mut images)?;
        check_errors(dir, &provenance, &errors, &cells)?;
        let index_by_id: HashMap<Arc<str>, usize> = cells
            .iter()
            .enumerate()
            .map(|(index, cell)| (cell.id.clone(), index))
            .collect();
        if let Some(table) = table("errors_by_n_dot_v.csv")? {
            bins(table, &mut cells, &index_by_id)?;
        }
        if let Some(mut table) = table("steps.csv")? {
            table.each(|row| {
                let index = row.text("cell").and_then(|cell| index_by_id.get(cell));
                if let Some((index, step)) = index.zip(step(&row)) {
                    Arc::make_mut(&mut cells[*index].steps).push(step);
                }
                Ok(())
            })?;
        }
        let experiment = text(&dir.join(EXPERIMENT_FILE))?.unwrap_or_default();
        let config = config(dir, &experiment, &provenance);
        let weights = config
            .as_ref()
            .map_or_else(|| vec![Weight::Picture, Weight::Uniform], Config::weights);
        Ok(Self {
            config,
            weights,
            weight: Weight::Uniform,
            cells,
            lights: table("environments.csv")?.map_or_else(|| Ok(Vec::new()), lights)?,
            recovered: table(RECOVERY_FILE)?.map_or_else(|| Ok(Vec::new()), recovered)?,
            timings: of_store(dir, TIMINGS_FOLDER, Store::timing)?,
            failures: of_store(dir, FAILED_FOLDER, Store::failure)?,
            provenance,
            experiment,
            dir: dir.to_owned(),
        })
    }
}

fn metrics(row: &Row, suffix: &str) -> MetricValues {
    MetricValues::from_fn(|name| row.number(&format!("{name}{suffix}")))
}

/// The cells of `errors.csv`, without the data of other tables.
fn cells(
    errors: &mut TableRows,
    images: &mut HashMap<String, CellImages>,
) -> Result<Vec<FinishedCell>, FinishedError> {
    check_head(errors)?;
    ["cell", "verdict", HEADLINE]
        .iter()
        .try_for_each(|name| errors.needs(name))?;
    let mut cells = Vec::new();
    let mut points = Points::default();
    errors.each(|row| {
        row.checked_number(HEADLINE)?;
        let id = row.text("cell").unwrap_or_default();
        let is_failed = row.text("verdict") == Some(FAILED);
        let is_scored = !is_failed && row.text("verdict") != Some(UNSCORED);
        let point = point_of(|name| Some(row.text(name)?.to_owned()));
        cells.push(FinishedCell {
            point: points.shared(&point),
            is_failed,
            scores: is_scored.then(|| metrics(&row, "")),
            noise_floors: metrics(&row, "_noise_floor"),
            steadiness: row
                .number("lag_bias")
                .zip(row.number("flicker"))
                .map(Into::into),
            reference: stop(&row),
            bins: Bins::default(),
            steps: Arc::default(),
            images: images.remove(id).map(Arc::new),
            id: id.into(),
        });
        Ok(())
    })?;
    Ok(cells)
}

/// Adds the rows of `errors_by_n_dot_v.csv` to their cells. Every cell with a score has some.
fn bins(
    mut table: TableRows,
    cells: &mut [FinishedCell],
    index_by_id: &HashMap<Arc<str>, usize>,
) -> Result<(), FinishedError> {
    check_head(&table)?;
    ["cell", HEADLINE]
        .iter()
        .try_for_each(|name| table.needs(name))?;
    let mut is_binned = vec![false; cells.len()];
    let mut open = OpenCell::default();
    table.each(|row| {
        row.checked_number(HEADLINE)?;
        let Some(&index) = row.text("cell").and_then(|cell| index_by_id.get(cell)) else {
            return Ok(());
        };
        is_binned[index] = true;
        if index != open.index {
            open.close(cells);
            open.index = index;
        }
        open.bins.extend(bin(&row));
        Ok(())
    })?;
    open.close(cells);
    let is_scored = |cell: &FinishedCell| {
        cell.scores
            .as_ref()
            .and_then(|scores| scores.get(HEADLINE))
            .is_some_and(f64::is_finite)
    };
    let mut bare = cells
        .iter()
        .zip(&is_binned)
        .filter(|(cell, is_binned)| !**is_binned && is_scored(cell));
    match bare.next() {
        Some((cell, _)) => Err(damaged(
            &table,
            format!("no row of cell {}, which errors.csv beside it has", cell.id),
        )),
        None => Ok(()),
    }
}

/// The cell whose rows are being read; they usually follow each other.
#[derive(Default)]
struct OpenCell {
    index: usize,
    /// Not yet in the cell.
    bins: Vec<Bin>,
    /// Of the cell before it.
    former: Bins,
}

impl OpenCell {
    /// Adds the bins to their cell.
    fn close(&mut self, cells: &mut [FinishedCell]) {
        if self.bins.is_empty() {
            return;
        }
        let bins = &mut cells[self.index].bins;
        *bins = bins.iter().chain(self.bins.drain(..)).collect();
        bins.share_layout(&self.former);
        self.former = bins.clone();
    }
}

fn bin(row: &Row) -> Option<Bin> {
    Some(Bin {
        range: BinRange {
            lo: row.number("n_dot_v_from")?,
            hi: row.number("n_dot_v_to")?,
            pixel_count: row.number("pixel_count")? as u64,
        },
        reference_mean: row.number("reference_mean"),
        scores: metrics(row, ""),
        noise_floors: metrics(row, "_noise_floor"),
    })
}

fn step(row: &Row) -> Option<StepRow> {
    Some(StepRow {
        n_dot_v: [row.number("n_dot_v_from")?, row.number("n_dot_v_to")?],
        step: row.text("step")?.to_owned(),
        share: row.number("share")?,
        share_error: row.number("share_error")?,
        rung_error: row.number("rung_error")?,
        first_in: row.number("first_in")?,
        last_out: row.number("last_out")?,
        shapley: row.number("shapley")?,
        step_error: row.number("step_error")?,
        noise: row.number("noise")?,
    })
}

fn recovered(mut table: TableRows) -> Result<Vec<RecoveredRow>, FinishedError> {
    let mut rows = Vec::new();
    table.each(|row| {
        rows.extend(recovered_row(&row));
        Ok(())
    })?;
    Ok(rows)
}

fn recovered_row(row: &Row) -> Option<RecoveredRow> {
    Some(RecoveredRow {
        truth: row.text("cell")?.to_owned(),
        candidate: row.text("candidate")?.to_owned(),
        loss: row.text("loss")?.to_owned(),
        n_dot_v: [row.number("n_dot_v_from")?, row.number("n_dot_v_to")?],
        true_roughness: row.number("true_roughness")?,
        true_f0: row.number("true_f0")?,
        roughness: row.number("roughness")?,
        f0: row.number("f0")?,
        is_at_limit: row.number("is_at_limit")? > 0.0,
    })
}

fn stop(row: &Row) -> Option<ReferenceStop> {
    Some(ReferenceStop {
        samples: row.number("reference_samples")? as u64,
        relative_error: Exact(row.number("reference_relative_error")?),
        stopped_by: *StopReason::by_name(row.text("reference_stopped_by")?)?,
    })
}

fn lights(mut table: TableRows) -> Result<Vec<Light>, FinishedError> {
    let mut lights = Vec::new();
    table.each(|row| {
        let light = |environment: &str| {
            Some(Light {
                environment: environment.to_owned(),
                mean: row.number("mean_luminance")?,
                peak: row.number("peak_luminance")?,
            })
        };
        lights.extend(row.text("environment").and_then(light));
        Ok(())
    })?;
    Ok(lights)
}

fn damaged(table: &TableRows, what: String) -> FinishedError {
    FinishedError::Damaged {
        path: table.path().to_owned(),
        what,
    }
}

fn check_head(table: &TableRows) -> Result<(), FinishedError> {
    if table.columns().is_empty() {
        Err(damaged(table, "the file is empty".to_owned()))
    } else {
        Ok(())
    }
}

/// The experiment; `None` if this program does not understand it. Methods in files are loaded if
/// the files still exist, since their parameters decide which questions can be answered.
fn config(dir: &Path, experiment: &str, provenance: &Provenance) -> Option<Config> {
    let path = Path::new(EXPERIMENT_FILE);
    let mut faults = Faults::new(path, experiment);
    let mut config = Config::parse(path, experiment, &provenance.overrides, &mut faults);
    let folder = |from_run: &Option<String>| from_run.as_ref().map(|folder| dir.join(folder));
    config.file_dir = folder(&provenance.experiment_folder);
    config.set_dir = folder(&provenance.set_folder).unwrap_or_default();
    let is_understood = faults.is_empty();
    load_methods(&config, &mut faults);
    is_understood.then_some(config)
}

/// A folder without tables: of a run if a command worked on it.
fn unfinished(dir: &Path, provenance: &Provenance) -> FinishedError {
    let dir = dir.to_owned();
    let last = provenance.last_session();
    let command = last.map_or_else(String::new, |session| session.command_line.join(" "));
    if command.is_empty() {
        FinishedError::NotARun {
            dir,
            file: "errors.csv",
        }
    } else {
        FinishedError::Unfinished { dir, command }
    }
}

pub fn provenance(dir: &Path) -> Result<Provenance, FinishedError> {
    if dir.is_file() {
        return Err(FinishedError::NotAFolder {
            dir: dir.to_owned(),
        });
    }
    provenance::read(dir)?.ok_or_else(|| FinishedError::NotARun {
        dir: dir.to_owned(),
        file: PROVENANCE_FILE,
    })
}

fn images(mut table: TableRows) -> Result<HashMap<String, CellImages>, FinishedError> {
    ["cell", "radiance", "reference"]
        .iter()
        .try_for_each(|name| table.needs(name))?;
    // Paths and links are made of it: only plain names are safe.
    let is_name = |text: &str| {
        !text.contains(['/', '\\', ':']) && ![".", ".."].contains(&text) && printable(text) == text
    };
    let mut found = HashMap::new();
    let mut stranger = None;
    table.each(|row| {
        let [cell, radiance] = ["cell", "radiance"].map(|name| row.text(name).unwrap_or_default());
        let reference = row.text("reference").filter(|name| !name.is_empty());
        let mut names = std::iter::once(radiance).chain(reference);
        if let Some(name) = names.find(|name| !is_name(name)) {
            stranger = Some(name.to_owned());
        }
        found.insert(
            cell.to_owned(),
            CellImages {
                radiance: radiance.to_owned(),
                reference: reference.map(str::to_owned),
            },
        );
        Ok(())
    })?;
    match stranger {
        Some(text) => Err(damaged(
            &table,
            format!("{text:?} is not the name of an image"),
        )),
        None => Ok(found),
    }
}

/// Checks that `errors.csv` has each cell once, and every cell with a record.
fn check_errors(
    dir: &Path,
    provenance: &Provenance,
    errors: &TableRows,
    cells: &[FinishedCell],
) -> Result<(), FinishedError> {
    let damaged = |what: String| Err(damaged(errors, what));
    let ids: HashSet<&str> = cells.iter().map(|cell| &*cell.id).collect();
    if ids.len() < cells.len() {
        return damaged(format!("{} rows of {} cells", cells.len(), ids.len()));
    }
    // Unreadable records do not count, but are read only if there seem to be too many.
    let store = Store::read_only(dir);
    let records: BTreeSet<Id> = [CELLS_FOLDER, FAILED_FOLDER]
        .into_iter()
        .flat_map(|folder| store.ids(folder))
        .collect();
    let is_record = |id: &&Id| {
        matches!(store.cell(**id), Ok(Some(_))) || matches!(store.failure(**id), Ok(Some(_)))
    };
    let rows = cells.len();
    let records = if rows < records.len() {
        records.iter().filter(is_record).count()
    } else {
        records.len()
    };
    if rows < records {
        return damaged(format!(
            "{rows} rows, but the folder has records of {records} cells: the table is truncated"
        ));
    }
    // A published folder has no records; a run stopped before its first cell has no session.
    let has_worked = !provenance.sessions.is_empty();
    if rows == 0
        && records == 0
        && has_worked
        && !dir.join(CELLS_FOLDER).is_dir()
        && provenance.cell_count != 0
    {
        return damaged("no rows".to_owned());
    }
    Ok(())
}

const MAX_FILE_BYTES: u64 = 1 << 30;

/// The text of a file; `None` if it does not exist.
fn text(path: &Path) -> Result<Option<String>, FinishedError> {
    match read_regular(path, MAX_FILE_BYTES)
        .and_then(|bytes| String::from_utf8(bytes).map_err(std::io::Error::other))
    {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(FinishedError::Io {
            path: path.to_owned(),
            error,
        }),
    }
}

/// The usable records of a folder, by file name.
fn of_store<T>(
    dir: &Path,
    folder: &str,
    read: fn(&Store, Id) -> Result<Option<T>, StoreError>,
) -> Result<Vec<T>, FinishedError> {
    let store = Store::read_only(dir);
    store
        .ids(folder)
        .into_iter()
        .filter_map(|id| read(&store, id).map_err(FinishedError::from).transpose())
        .collect()
}
