//! The figures beside the report: for each a CSV of what is drawn and a Vega-Lite specification that draws it, for people who
//! want to restyle it or put it into a paper. The tables are those of `study::answers`.

use crate::runner::timing::TimingRecord;
use crate::study::answers::run_folder::RunFolder;
use crate::study::answers::tables::of_figures;
use crate::study::report::joined::Alone;
use crate::study::report::specs;
use crate::table::csv::{TableError, TableWriter};
use std::path::{Path, PathBuf};

/// Why figures could not be written.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    #[error(transparent)]
    Table(#[from] TableError),
    #[error("{}: {error}", path.display())]
    Io { path: PathBuf, error: std::io::Error },
}

/// Writes `NAME.csv` and `NAME.vl.json` for every figure that the runs have data for. Returns the names, which hold the folder of the run where
/// there are several: no figure joins runs.
pub fn write(folder: &Path, each: &[Alone], runs: &[RunFolder]) -> Result<Vec<String>, FigureError> {
    let mut names = Vec::new();
    for (i, (alone, run)) in each.iter().zip(runs).enumerate() {
        let own = if runs.len() > 1 { format!("run-{}", i + 1) } else { String::new() };
        let written = write_run(&folder.join(&own), alone, &run.timings)?;
        names.extend(written.into_iter().map(|name| if own.is_empty() { name } else { format!("{own}/{name}") }));
    }
    Ok(names)
}

fn write_run(folder: &Path, alone: &Alone, timings: &[TimingRecord]) -> Result<Vec<String>, FigureError> {
    let io = |error| FigureError::Io { path: folder.to_owned(), error };
    std::fs::create_dir_all(folder).map_err(io)?;
    let mut names = Vec::new();
    for table in &of_figures(&alone.study, &alone.answers, timings) {
        let Some(spec) = specs::spec(table, &alone.study, &alone.answers) else { continue };
        let columns: Vec<&str> = table.columns.iter().map(String::as_str).collect();
        let mut writer = TableWriter::create(&folder.join(format!("{}.csv", table.name)), &columns)?;
        table.rows.iter().try_for_each(|row| writer.append(row))?;
        let path = folder.join(format!("{}.vl.json", table.name));
        std::fs::write(&path, format!("{spec:#}\n")).map_err(|error| FigureError::Io { path, error })?;
        names.push(table.name.to_owned());
    }
    Ok(names)
}
