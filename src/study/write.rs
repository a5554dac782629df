//! `answers/` in the folder of a run, and its summary.

use super::figure::svg::{WIDTHS, svg};
use super::figure::vega::vega;
use super::finished::Finished;
use super::questions::Answer;
use super::summary;
use super::table::Table;
use crate::files::{RECORD_BYTES_MAX, holds, read_text};
use crate::pixels::{PixelsError, Staged};
use crate::runner::store::ANSWERS_FOLDER;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The summary, beside the tables of the run.
pub const SUMMARY_FILE: &str = "summary.md";
/// The answers in words, for programs.
pub const ANSWER_FILE: &str = "answer.json";

/// Why answers cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    #[error(transparent)]
    File(#[from] PixelsError),
    #[error("{}: {error}", path.display())]
    Io { path: PathBuf, error: std::io::Error },
    #[error("{}: {error}; expected a file that `splitsum answers` wrote", path.display())]
    Json { path: PathBuf, error: serde_json::Error },
}

/// One answer in words.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct ToldAnswer {
    /// Key of the question.
    pub question: String,
    pub asks: String,
    pub sentence: String,
    /// The digest, or the table where there is none, as Markdown.
    pub digest: String,
}

/// The content of `answer.json`.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct AnswerRecord {
    pub name: String,
    pub question: String,
    /// The leading one first.
    pub answers: Vec<ToldAnswer>,
    pub cells: usize,
    pub failed: usize,
    /// Names of the devices, each with its driver.
    pub devices: Vec<String>,
    /// Of the last invocation.
    pub date_utc: String,
    /// Of the last invocation; empty where it is not known.
    pub commit: String,
    pub is_cpu_timed: bool,
    /// Files of the folder.
    pub files: Vec<String>,
}

impl AnswerRecord {
    /// The answers of a run, published or not.
    pub fn read(dir: &Path) -> Result<Self, WriteError> {
        let path = dir.join(ANSWERS_FOLDER).join(ANSWER_FILE);
        let text = read_text(&path, RECORD_BYTES_MAX).map_err(|error| WriteError::Io { path: path.clone(), error })?;
        serde_json::from_str(&text).map_err(|error| WriteError::Json { path, error })
    }

    /// The sentence of the leading answer.
    pub fn headline(&self) -> &str {
        self.answers.first().map_or("No cell that answers is done yet.", |answer| answer.sentence.as_str())
    }
}

/// The answers of one run, ready to be written.
#[derive(Debug)]
pub struct Written {
    dir: PathBuf,
    /// The text of `summary.md`.
    pub summary: String,
    pub record: AnswerRecord,
    /// Name and content of every file of `answers/`.
    pub files: Vec<(String, String)>,
}

/// Rows of a table that stand in for a digest.
const ROWS_TOLD_MAX: usize = 40;

/// What people are shown of an answer: its digest, else the first rows of its table.
pub fn told(answer: &Answer) -> Table {
    let finding = &answer.finding;
    let mut table = finding.digest.clone().unwrap_or_else(|| finding.table.clone());
    table.rows.truncate(ROWS_TOLD_MAX);
    table
}

impl Written {
    /// Lays out the files of the answers of a run.
    pub fn new(run: &Finished, answers: &[Answer]) -> Result<Self, WriteError> {
        let mut files: Vec<(String, String)> = Vec::new();
        for Answer { question, finding } in answers {
            files.push((format!("{}.csv", question.name), finding.table.csv()));
            if let Some(figure) = &finding.figure {
                files.push((format!("{}.svg", question.name), svg(figure, WIDTHS[0])));
                files.push((format!("{}.vl.json", question.name), format!("{:#}\n", vega(figure))));
            }
        }
        let told_answer = |answer: &Answer| ToldAnswer {
            question: answer.question.name.to_owned(),
            asks: answer.question.asks.to_owned(),
            sentence: answer.finding.sentence.clone(),
            digest: told(answer).markdown(),
        };
        let session = run.last_session();
        let record = AnswerRecord {
            name: run.text("/name"),
            question: run.text("/question"),
            answers: answers.iter().map(told_answer).collect(),
            cells: run.cells.len() - run.failed_count(),
            failed: run.failed_count(),
            devices: run.devices(),
            date_utc: run.text(&format!("{session}/date_utc")),
            commit: run.text(&format!("{session}/commit/hash")),
            is_cpu_timed: run.is_cpu_timed(),
            files: files.iter().map(|(name, _)| name.clone()).collect(),
        };
        let json = |error| WriteError::Json { path: run.dir.join(ANSWERS_FOLDER).join(ANSWER_FILE), error };
        files.push((ANSWER_FILE.to_owned(), serde_json::to_string_pretty(&record).map_err(json)? + "\n"));
        let summary = summary::markdown(run, answers, &record);
        Ok(Self { dir: run.dir.clone(), summary, record, files })
    }

    /// Writes `answers/` and the summary: all of them or, where one cannot be written, none. A file of an answer that is no longer given
    /// is removed.
    pub fn write(&self) -> Result<(), WriteError> {
        let folder = self.dir.join(ANSWERS_FOLDER);
        let io = |error| WriteError::Io { path: folder.clone(), error };
        std::fs::create_dir_all(&folder).map_err(io)?;
        let answers = self.files.iter().map(|(name, text)| (folder.join(name), text));
        // The summary is the last to change: it speaks of the others.
        let due = answers.chain([(self.dir.join(SUMMARY_FILE), &self.summary)]);
        let is_new = |(path, text): &(PathBuf, &String)| !holds(path, text.as_bytes());
        // Faults for want of space or rights come before the first old file is replaced.
        let staged = due.filter(is_new).map(|(path, text)| {
            if path.is_dir() {
                let error = std::io::ErrorKind::IsADirectory.into();
                return Err(WriteError::Io { path, error });
            }
            Ok(Staged::new(&path, text.as_bytes())?)
        });
        let staged: Vec<Staged> = staged.collect::<Result<_, _>>()?;
        staged.into_iter().try_for_each(Staged::put)?;
        for entry in std::fs::read_dir(&folder).map_err(io)?.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let is_ours = [".csv", ".svg", ".vl.json"].iter().any(|end| name.ends_with(end));
            if is_ours && self.files.iter().all(|(known, _)| *known != name) {
                std::fs::remove_file(entry.path()).map_err(io)?;
            }
        }
        Ok(())
    }
}
