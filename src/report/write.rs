//! Writes `answers/` and `summary.md` in the folder of a run.

use super::record::{ANSWER_FILE, AnswerRecord, AnswerSentence, WriteError, digest_file};
use super::summary;
use crate::base::files::holds;
use crate::base::pixels::Staged;
use crate::draw::figure::svg::{FILE_WIDTH, svg};
use crate::run::store::ANSWERS_FOLDER;
use crate::study::finished::Finished;
use crate::study::questions::Answer;
use std::path::{Path, PathBuf};

pub const SUMMARY_FILE: &str = "summary.md";

/// A file in `answers/`.
#[derive(Debug)]
pub struct AnswerFile {
    pub name: String,
    pub text: String,
}

/// The answers of a run, ready to be written.
#[derive(Debug)]
pub struct Written {
    dir: PathBuf,
    pub summary: String,
    pub record: AnswerRecord,
    pub files: Vec<AnswerFile>,
}

/// Tables, digests and figures of answers.
fn answer_files(answers: &[Answer]) -> Vec<AnswerFile> {
    let mut files = Vec::new();
    for Answer { question, finding } in answers {
        files.push(AnswerFile {
            name: format!("{}.csv", question.name),
            text: finding.table.csv(),
        });
        if let Some(digest) = &finding.digest {
            files.push(AnswerFile {
                name: digest_file(question),
                text: digest.csv(),
            });
        }
        if let Some(figure) = &finding.figure {
            files.push(AnswerFile {
                name: format!("{}.svg", question.name),
                text: svg(figure, FILE_WIDTH),
            });
        }
    }
    files
}

impl Written {
    pub fn new(run: &Finished, answers: &[Answer]) -> Result<Self, WriteError> {
        let mut files = answer_files(answers);
        let session = run.provenance.last_session().cloned().unwrap_or_default();
        let record = AnswerRecord {
            name: run.provenance.name.clone(),
            question: run.provenance.question.clone(),
            answers: answers.iter().map(AnswerSentence::new).collect(),
            cells: run.cells.len() - run.failed_count(),
            failed: run.failed_count(),
            devices: run.devices(),
            has_changes: session.has_changes(),
            date_utc: session.date_utc,
            commit: session
                .commit
                .map_or_else(String::new, |commit| commit.hash),
            is_cpu_timed: run.is_cpu_timed(),
            is_unscored: !run.is_scored(),
            files: files.iter().map(|file| file.name.clone()).collect(),
        };
        let json = serde_json::to_string_pretty(&record).map_err(|error| WriteError::Json {
            path: run.dir.join(ANSWERS_FOLDER).join(ANSWER_FILE),
            error,
        })?;
        files.push(AnswerFile {
            name: ANSWER_FILE.to_owned(),
            text: json + "\n",
        });
        Ok(Self {
            dir: run.dir.clone(),
            summary: summary::markdown(run, answers, &record),
            record,
            files,
        })
    }

    /// Writes all files, or none if one cannot be written, and removes files of former answers.
    /// Returns whether anything changed.
    pub fn write(&self) -> Result<bool, WriteError> {
        let folder = self.dir.join(ANSWERS_FOLDER);
        let io = |error| WriteError::Io {
            path: folder.clone(),
            error,
        };
        std::fs::create_dir_all(&folder).map_err(io)?;
        // Errors such as a full disk come before the first file is replaced.
        let mut staged: Vec<Staged> = Vec::new();
        for file in &self.files {
            staged.extend(staged_if_new(folder.join(&file.name), &file.text)?);
        }
        // The summary comes last: it refers to the others.
        staged.extend(staged_if_new(self.dir.join(SUMMARY_FILE), &self.summary)?);
        let is_new = !staged.is_empty();
        for file in staged {
            file.put()?;
        }
        self.remove_former(&folder).map_err(io)?;
        Ok(is_new)
    }

    /// Removes the tables and figures of former answers.
    fn remove_former(&self, folder: &Path) -> std::io::Result<()> {
        for entry in std::fs::read_dir(folder)?.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let is_ours = [".csv", ".svg"].iter().any(|end| name.ends_with(end));
            if is_ours && self.files.iter().all(|file| file.name != name) {
                std::fs::remove_file(entry.path())?;
            }
        }
        Ok(())
    }
}

/// Prepares a file whose content changed; `None` for the same content.
fn staged_if_new(path: PathBuf, text: &str) -> Result<Option<Staged>, WriteError> {
    if holds(&path, text.as_bytes()) {
        return Ok(None);
    }
    if path.is_dir() {
        let error = std::io::ErrorKind::IsADirectory.into();
        return Err(WriteError::Io { path, error });
    }
    Ok(Some(Staged::new(&path, text.as_bytes())?))
}
