//! `answers/` in the folder of a run, and its summary.

use super::plot::{PlotError, figures};
use super::run_folder::{RunFolder, RunFolderError};
use super::study::Study;
use super::words::{Answer, answer};
use super::{Answers, tables};
use crate::files::{RECORD_BYTES_MAX, holds, read_text};
use crate::pixels::{PixelsError, Staged};
use crate::study::summary;
use crate::table::csv;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The folder of the answers below that of the run.
pub use crate::runner::store::ANSWERS_FOLDER as FOLDER;
/// The summary, beside the tables of the run.
pub const SUMMARY_FILE: &str = "summary.md";
/// The answer in words, for programs.
pub const ANSWER_FILE: &str = "answer.json";

/// Why a run has no answers.
#[derive(Debug, thiserror::Error)]
pub enum AnswersError {
    #[error(transparent)]
    Run(#[from] RunFolderError),
    #[error(transparent)]
    File(#[from] PixelsError),
    #[error(transparent)]
    Plot(#[from] PlotError),
    #[error("{}: {error}", path.display())]
    Io { path: PathBuf, error: std::io::Error },
    #[error("{}: {error}; expected a file that `splitsum answers` wrote", path.display())]
    Json { path: PathBuf, error: serde_json::Error },
}

/// What `answer.json` holds.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct AnswerRecord {
    pub name: String,
    pub question: String,
    #[serde(flatten)]
    pub answer: Answer,
    pub cells: usize,
    pub failed: usize,
    /// Names of the devices, each with its driver.
    pub devices: Vec<String>,
    /// Of the last invocation.
    pub date_utc: String,
    /// Of the last invocation; empty when it is not known.
    pub commit: String,
    pub is_cpu_timed: bool,
    /// Files of the folder.
    pub files: Vec<String>,
}

impl AnswerRecord {
    /// The answer of a run, published or not.
    pub fn read(dir: &Path) -> Result<Self, AnswersError> {
        let path = dir.join(FOLDER).join(ANSWER_FILE);
        let text =
            read_text(&path, RECORD_BYTES_MAX).map_err(|error| AnswersError::Io { path: path.clone(), error })?;
        serde_json::from_str(&text).map_err(|error| AnswersError::Json { path, error })
    }
}

/// The answers of one run, ready to be written.
#[derive(Debug)]
pub struct Answered {
    dir: PathBuf,
    /// The text of `summary.md`.
    pub summary: String,
    pub record: AnswerRecord,
    /// What to tell of a run that is under way ([`RunFolder::under_way_note`]).
    pub under_way: Option<String>,
    /// Name and content of every file of `answers/`.
    pub files: Vec<(String, String)>,
}

impl Answered {
    /// Computes the answers from the files of a run.
    pub fn of_run(dir: &Path) -> Result<Self, AnswersError> {
        let runs = [RunFolder::read(dir)?];
        let [run] = &runs;
        let study = Study::new(&runs, &[run.text("/name")]).distinct();
        let answers = Answers::new(&study, &runs);
        let mut files: Vec<(String, String)> = tables::of_run(&study, &answers)
            .into_iter()
            .map(|table| {
                let bytes = csv::to_text(&table.columns, table.rows.iter().map(Vec::as_slice));
                (format!("{}.csv", table.name), String::from_utf8_lossy(&bytes).into_owned())
            })
            .collect();
        files.extend(
            figures::pictures(&study, &answers)?
                .into_iter()
                .map(|picture| (format!("{}.svg", picture.name), picture.svg)),
        );
        let session = run.last_session();
        let failed = run.failed_count();
        let record = AnswerRecord {
            name: run.text("/name"),
            question: run.text("/question"),
            answer: answer(&study, &answers),
            cells: run.errors.rows.len() - failed,
            failed,
            devices: run.devices(),
            date_utc: run.text(&format!("{session}/date_utc")),
            commit: run.text(&format!("{session}/commit/hash")),
            is_cpu_timed: run.is_cpu_timed(),
            files: files.iter().map(|(name, _)| name.clone()).collect(),
        };
        let json = serde_json::to_string_pretty(&record)
            .map_err(|error| AnswersError::Json { path: dir.join(FOLDER).join(ANSWER_FILE), error })?;
        files.push((ANSWER_FILE.to_owned(), json + "\n"));
        let summary = summary::markdown(run, &study, &answers, &record);
        Ok(Self { dir: dir.to_owned(), summary, record, under_way: run.under_way_note(), files })
    }

    /// Whether the folder holds this summary already.
    pub fn is_summary_written(&self) -> bool {
        holds(&self.dir.join(SUMMARY_FILE), self.summary.as_bytes())
    }

    /// Writes `answers/` and the summary: all of them or, where one cannot be written, none. A picture or table of earlier answers that
    /// these do not have is removed.
    pub fn write(&self) -> Result<(), AnswersError> {
        let folder = self.dir.join(FOLDER);
        let io = |error| AnswersError::Io { path: folder.clone(), error };
        std::fs::create_dir_all(&folder).map_err(io)?;
        let answers = self.files.iter().map(|(name, text)| (folder.join(name), text));
        // The summary is the last to change: it speaks of the others.
        let due = answers.chain([(self.dir.join(SUMMARY_FILE), &self.summary)]);
        let is_new = |(path, text): &(PathBuf, &String)| !holds(path, text.as_bytes());
        // What can fail for want of space or rights is done beside the old files, before the first of them is replaced.
        let staged = due.filter(is_new).map(|(path, text)| {
            if path.is_dir() {
                let error = std::io::ErrorKind::IsADirectory.into();
                return Err(AnswersError::Io { path, error });
            }
            Ok(Staged::new(&path, text.as_bytes())?)
        });
        let staged: Vec<Staged> = staged.collect::<Result<_, _>>()?;
        staged.into_iter().try_for_each(Staged::put)?;
        for entry in std::fs::read_dir(&folder).map_err(io)?.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let is_ours = [".csv", ".svg"].iter().any(|end| name.ends_with(end));
            if is_ours && self.files.iter().all(|(known, _)| *known != name) {
                std::fs::remove_file(entry.path()).map_err(io)?;
            }
        }
        Ok(())
    }
}
